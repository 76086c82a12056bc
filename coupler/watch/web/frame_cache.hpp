#pragma once

#include "coupler/participant/interface_record.hpp"
#include "proto/interface.hpp"

#include <cstdint>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace strake::watch {

/// The output frames of a run under way. Each file is opened once for its time, and the last ones that were
/// read are kept. A structure that writes no frames, such as a user's program, has its wet interface at the
/// times of the fluid's frames.
class FrameCache {
 public:
  explicit FrameCache(std::filesystem::path run_folder) : folder_(std::move(run_folder) / "frames") {}

  struct Entry {
    int number = 0;   // of the file: 42 of fluid-000042.h5
    double time = 0;  // [s]
  };
  struct Series {
    std::vector<Entry> entries;    // ascending
    std::uint32_t generation = 0;  // grows when a frame that was listed is gone (a resumed run)
  };
  /// Lists what is new. Cheap while nothing is.
  void update();
  /// side: "fluid" | "structure"; of several bodies the latter is all of them, in one frame.
  const Series& series(const std::string& side) const;
  /// Throws Error(case_file) where there is no such frame, or it is damaged.
  std::shared_ptr<const Frame> read(const std::string& side, int number);
  /// Where each of several bodies begins in the frame that was read last; empty for one structure.
  const std::vector<MeshPart>& parts() const { return parts_; }

 private:
  using Key = std::pair<std::string, int>;
  struct Kept {
    Key key;
    std::int64_t written = 0;  // [ns]
    std::size_t bytes = 0;
    std::shared_ptr<const Frame> frame;
    std::vector<MeshPart> parts;
  };
  std::filesystem::path path_of(const Key&) const;
  std::vector<std::string> names_of(const std::string& side) const;  // of the series that make it up
  bool has_interface_alone() const;  // no frames of a structure, but a record of its interface
  std::shared_ptr<const Frame> read_interface(int number);
  std::filesystem::path folder_;
  std::int64_t updated_ = -1;  // [ns] when the folder was last changed, as of the last look
  std::map<std::string, Series> series_;
  std::map<std::string, std::int64_t> damaged_;  // file name → [ns] when it was written
  std::list<Kept> kept_;                         // the latest first
  std::vector<MeshPart> parts_;
  std::shared_ptr<const InterfaceRecord> interface_;  // as far as it was read
};

}  // namespace strake::watch
