#include "coupler/commands/run_messages.hpp"

#include "coupler/summary/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace strake {

std::unique_ptr<Reporter> reporter_of(const RunOptions& options) {
  if (options.json) return json_reporter(stdout);
  if (options.quiet) return quiet_reporter(stdout, style_of(stdout));
  return table_reporter(stdout, style_of(stdout));
}

namespace {

/// The axis along which a body is less than half as long as along y; else y, the way of slamming.
char thin_axis_of(const InterfaceMesh& mesh) {
  if (mesh.position.cols() == 0) return 'y';
  const Eigen::Vector3d l = mesh.position.rowwise().maxCoeff() - mesh.position.rowwise().minCoeff();
  Eigen::Index thin = 1;
  for (Eigen::Index axis = 0; axis < mesh.dimension; ++axis)
    if (l[axis] < 0.5 * l[1] && l[axis] < l[thin]) thin = axis;
  return "xyz"[thin];
}

std::vector<std::string> names_of(const std::vector<Column>& columns) {
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(column.name);
  return names;
}

}  // namespace

MonitorNotes::MonitorNotes(const CaseView& view, double since, const std::vector<Column>& columns)
    : failure_(view.common.interface == "surface" && view.coupled(), since, view.bodies()),
      alarms_(since),
      precice_(view.common.window),
      empty_(names_of(columns)),
      several_(!view.bodies().empty()) {
  for (const SideView* side : view.sides())
    if (side->is_users()) users_.push_back(side->side);
}

void MonitorNotes::tell(const WindowReport& report, const RunMessages& messages) {
  for (const std::string& line : failure_.look(report.structure)) messages.note(line);
  for (const auto& [side, monitor] :
       {std::pair("fluid", &report.fluid), std::pair("structure", &report.structure)}) {
    for (const std::string& line : alarms_.look(*monitor)) messages.alarm(line);
    for (const std::string& line : precice_.look(side, *monitor)) messages.warn(line);
  }
  const double end = report.window.t + report.window.dt;
  for (const std::string& side : users_)
    for (const std::string& line : empty_.look(side, end, several_ && side != "fluid",
                                               side == "fluid" ? report.fluid : report.structure))
      messages.warn(line);
}

RunHeader header_of(const CaseView& view, Session& session, const RunPlan& plan,
                    const std::filesystem::path& folder, const std::vector<Column>& history, bool resumed) {
  RunHeader header{.title = view.common.title,
                   .folder = folder,
                   .blocks = session.understood(),
                   .warnings = session.warnings(),
                   .coupled = view.coupled(),
                   .mechanical = session.is_mechanical(),
                   .dimension = session.dimension(),
                   .columns = session.columns(),
                   .probes = view.common.probes,
                   .history = history,
                   .end_time = plan.end,
                   .windows = plan.n_windows(),
                   .from = plan.start};
  for (const CompareBlock& block : view.blocks)
    if (applies(block, lookup_in(view.value))) header.judged.push_back(block.probe);
  if (view.structures.size() == 1 && view.any_deforms() && session.structure() != nullptr)
    header.thin_axis = thin_axis_of(session.structure()->mesh());
  for (std::string& line : judged_lines(view, session.columns())) header.warnings.push_back(std::move(line));
  if (std::vector<std::string> lines = session.resolution(); !lines.empty())
    header.blocks.emplace_back("resolution", std::move(lines));
  if (resumed)
    header.blocks.push_back(
        {"resumed", {fmt::format("after window {} (t = {:.6g} s)", plan.start.windows, plan.start.time)}});
  return header;
}

Error with_resume_hint(const Error& error, const std::filesystem::path& checkpoint, const LoopState& saved,
                       const Summary& summary, const std::string& cannot_resume) {
  const long lost = summary.windows() - saved.windows;
  const std::string windows = fmt::format("{} finished window{}, {:.6g} s of simulated time", lost,
                                          lost == 1 ? "" : "s", summary.end_time() - saved.time);
  const std::string resume_hint =
      !cannot_resume.empty() ? fmt::format("nothing to go on from: {}\nlost: {}", cannot_resume, windows)
      : checkpoint.empty()
          ? fmt::format(
                "nothing to go on from: the first checkpoint was still to come (run.checkpoint)\n"
                "lost: {}",
                windows)
          : fmt::format("--resume goes on with window {} (t = {:.6g} s), from {}\ncomputed again: {}",
                        saved.windows + 1, saved.time, checkpoint.string(), windows);
  return Error(error.code(), error.where(), error.problem(),
               error.fix().empty() ? resume_hint : error.fix() + "\n" + resume_hint);
}

Json contact_times(const Summary& summary) {
  Json contact = Json::object();
  const std::string metric = ":contact";
  for (const auto& [name, time] : summary.probe_results())
    if (name.ends_with(metric)) contact[name.substr(0, name.size() - metric.size())] = time;
  return contact;
}

RunEnd end_of(ExitCode code, const Summary& summary, const std::filesystem::path& folder,
              const Profile* profile) {
  RunEnd end{.summary = &summary, .folder = folder, .fields = {}, .stopped = {}, .profile = profile};
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (entry.path().extension() == ".xdmf") end.fields.push_back(entry.path().filename().string());
  std::sort(end.fields.begin(), end.fields.end());
  std::stable_partition(end.fields.begin(), end.fields.end(),
                        [](const std::string& name) { return name == "fluid.xdmf"; });
  if (code == ExitCode::interrupted || code == ExitCode::terminated || code == ExitCode::hung_up)
    end.stopped = "interrupted";
  else if (code != ExitCode::done)
    end.stopped = "stopped";
  return end;
}

Error error_of(const std::exception& error, const std::string& where) {
  if (const auto* refused = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return {ExitCode::cannot_write, refused->path1().string(), refused->code().message(),
            "check the path, and what this user may do there"};
  return {ExitCode::our_bug, where, fmt::format("{}\nthis is a bug in Strake", error.what())};
}

}  // namespace strake
