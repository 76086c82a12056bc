#pragma once

#include "coupler/watch/run_status.hpp"
#include "coupler/watch/web/frame_cache.hpp"

#include <chrono>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <string_view>

namespace strake::watch {

/// Answers the page's requests on a run, all from the run's files. Several threads may call it.
///   ""            the page; "page.js" and "page.css": its script and style
///   api/run       what the run is: title, sides, probes, palette
///   api/news      state, clocks, processes, stages, sizes of everything that grows
///   api/table     name=history|iterations|timing, from=ROW: columns from that row on (ArrayMessage, f64)
///   api/frames    side=fluid|structure, from=PLACE: numbers and times
///   api/frame     side, number, field: ArrayMessage of field_view.hpp
///   api/point     side, number, and index or id, which a particle keeps: every value of one point
///   api/log       name=coupler|fluid|structure, from=BYTE (-1: the last part)
class HttpApi {
 public:
  explicit HttpApi(const std::filesystem::path& run_folder);

  struct Answer {
    int status = 200;
    std::string type, body;
  };
  using Query = std::map<std::string, std::string>;
  /// Never throws: what is wrong with a question is a status and a sentence.
  Answer answer(const std::string& path, const Query&);

 private:
  Answer run();
  Answer news();
  Answer table(const Query&);
  Answer frames(const Query&);
  Answer frame(const Query&);
  Answer point(const Query&);
  Answer log(const Query&);
  void update();

  std::mutex run_mutex_, frames_mutex_;  // in this order where both are held
  WatchedRun run_;
  FrameCache frames_;
  std::chrono::steady_clock::time_point updated_{};
};

/// A file of the page, as it is built into the program.
struct PageFile {
  std::string_view name, type, bytes;
};
std::span<const PageFile> page_files();

}  // namespace strake::watch
