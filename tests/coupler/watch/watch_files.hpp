#pragma once

#include "coupler/run/run_folder.hpp"
#include "coupler/transport/system_calls.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

namespace strake::watch {

inline void put(const std::filesystem::path& path, const std::string& text, bool behind = false) {
  std::ofstream(path, std::ios::binary | (behind ? std::ios::app : std::ios::trunc)) << text;
}

/// The files of a run as `strake run` leaves them, as far as watching reads them.
class RunFiles {
 public:
  RunFiles() {
    std::filesystem::create_directory(path());
    std::filesystem::create_directory(path() / "frames");
    put(path() / "case.toml",
        "title = \"a plate\"  # case\nend_time = 0.01  # s, case\n\n[fluid]\ndimension = 2  # default\n"
        "spacing = 0.1  # m, case\n\n[structure]\nvelocity = [0, -2, 0]  # m/s, case\n\n"
        "[[output.probe]]\nname = \"mid\"  # case\n");
    record("null", "null");
  }
  std::filesystem::path path() const { return folder_.path() / "plate"; }
  const std::filesystem::path& runs() const { return folder_.path(); }

  void record(const std::string& ended, const std::string& code, const std::string& more = {},
              const std::string& host = host_name()) const {
    put(path() / "run.json", fmt::format("{{\"strake\": \"0.1.0\", \"host\": \"{}\", \"started\": "
                                         "\"2025-11-21T02:00:00Z\", \"ended\": {}, "
                                         "\"exit_code\": {}{}}}\n",
                                         host, ended, code, more));
  }
  /// n windows of 1 ms: mid.y is a sine.
  void windows(int n) const {
    put(path() / "history.csv",
        "window [1],time [s],iterations [1],residual [m],force.x [N/m],force.y [N/m],work_gap [1],mid.x "
        "[m],mid.y [m]\n");
    put(path() / "timing.csv", "window [1],time [s],wall [s],fluid.pressure [s],structure.step [s]\n");
    for (int k = 1; k <= n; ++k) more_windows(k);
  }
  void more_windows(int k) const {
    put(path() / "history.csv",
        fmt::format("{},{},2,1e-09,0,{},1e-16,0,{}\n", k, 1e-3 * k, 100.0 * k, 1e-3 * std::sin(0.5 * k)),
        true);
    put(path() / "timing.csv", fmt::format("{},{},0.5,{},{}\n", k, 1e-3 * k, 0.3 * k, 0.1 * k), true);
  }
  /// As if nothing had been written for so long.
  void age(double seconds) const {
    const auto then = std::filesystem::file_time_type::clock::now() -
                      std::chrono::duration_cast<std::filesystem::file_time_type::duration>(
                          std::chrono::duration<double>(seconds));
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path()))
      std::filesystem::last_write_time(entry.path(), then);
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace strake::watch
