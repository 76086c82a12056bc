#include "fluid/replay/replay.hpp"

#include "proto/error.hpp"
#include "proto/files/result_file.hpp"

#include <fmt/format.h>

#include <utility>

namespace strake::fluid {

Replay::Replay(InterfaceRecord record, std::filesystem::path source, const Setup& setup)
    : record_(std::move(record)), source_(std::move(source)) {
  const Points &here = setup.partner_mesh.position, &there = record_.mesh.position;
  const bool same_count = here.cols() == there.cols();
  if (!same_count || (here - there).cwiseAbs().maxCoeff() > 1e-9 * there.cwiseAbs().maxCoeff())
    throw Error(ExitCode::case_file, source_.string(),
                same_count ? "was recorded on interface points at other places"
                           : fmt::format("was recorded on {} interface points, the structure has {}",
                                         there.cols(), here.cols()),
                "the same shape, structure.surface_spacing and coupling.interface as in the recorded run");
  record_.mesh = setup.partner_mesh;
  record_.mesh.name = "fluid";
  description_.lines = {fmt::format("replay of {}   {} interface points   {} windows to {:.6g} s",
                                    source_.string(), there.cols(), record_.windows.size(), record_.end())};
}

void Replay::start(const Window& window, const Input&) {
  if (window.t + window.dt > record_.end() * (1 + 1e-9))
    throw Error(ExitCode::case_file, source_.string(),
                fmt::format("is over: the record ends at {:.6g} s, the window at {:.6g} s", record_.end(),
                            window.t + window.dt),
                fmt::format("end_time = {:.6g}", record_.end()));
  window_ = window;
  ++steps_;
}

Advanced Replay::finish() {
  Advanced result;
  result.output = {{"force", "N", true, record_.mean_force(window_.t, window_.dt)}};
  result.monitor["count.steps"] = steps_;
  return result;
}

void Replay::checkpoint(const std::filesystem::path& folder) {
  Archive archive;
  archive.integer["replay.steps"] = {committed_steps_};
  write_archive(folder / "fluid.h5", archive);
}

void Replay::resume(const std::filesystem::path& folder) {
  const Archive archive = read_archive(folder / "fluid.h5");
  if (!archive.integer.contains("replay.steps"))
    throw Error(ExitCode::case_file, (folder / "fluid.h5").string(),
                "is not a checkpoint of a replayed fluid");
  steps_ = committed_steps_ = static_cast<int>(archive.integer.at("replay.steps").at(0));
}

}  // namespace strake::fluid
