#include "coupler/case/side_programs.hpp"

#include "coupler/case/case_view.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/precice/config/precice_config.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace strake {

std::filesystem::path program_of(const AttachmentKeys& attachment, const CaseView& view) {
  return find_program(attachment.is_users() ? attachment.solver : "strake-attachment-" + attachment.solver,
                      view.folder);
}

void check_attached_programs(const CaseView& view, const std::vector<std::string>& by_hand) {
  for (const AttachmentKeys& one : view.attachments) {
    if (!one.is_program() || std::find(by_hand.begin(), by_hand.end(), one.name) != by_hand.end()) continue;
    std::error_code ignored;
    if (one.is_users() && !std::filesystem::is_regular_file(one.solver, ignored))
      throw Error(ExitCode::case_file, view.path.string() + ": attachments." + one.name + ".solver",
                  "there is no file " + one.solver, "the path of a program");
    program_of(one, view);
  }
}

Json record_attachments(const CaseView& view, Json& programs) {
  Json lines = Json::object();
  for (const AttachmentKeys& one : view.attachments)
    if (one.is_program())
      programs[one.name] = {{"solver", one.solver},
                            {"program", one.is_users() ? one.solver : program_of(one, view).string()}};
    else
      lines[one.name] = {{"solver", one.solver}};
  return lines;
}

bool starts_by_hand(const std::vector<std::string>& by_hand, const SideView& side) {
  return std::any_of(by_hand.begin(), by_hand.end(), [&](const std::string& name) {
    return name == side.side || (side.is_body && name == "structure");
  });
}

void check_by_hand(const std::vector<std::string>& by_hand, const CaseView& view) {
  const std::vector<const SideView*> sides = view.sides();
  for (const std::string& name : by_hand) {
    const auto is_meant = [&](const SideView* side) { return starts_by_hand({name}, *side); };
    const auto is_program = [&](const AttachmentKeys& one) { return one.name == name && one.is_program(); };
    if (std::any_of(sides.begin(), sides.end(), is_meant) ||
        std::any_of(view.attachments.begin(), view.attachments.end(), is_program))
      continue;
    throw Error(ExitCode::command_line, "--attach", "the case has no " + name,
                "--attach names sides and attachments that a program computes");
  }
}

std::string other_window_line(const std::string& side, double configured, double window) {
  if (!(configured > 0) || std::abs(configured - window) <= 1e-9 * window) return "";
  return fmt::format(
      "{}: its preCICE configuration has time-window-size = {:.9g} s, and the windows of this run are {:.9g} "
      "s "
      "long (coupling.surface.window), which hold; make the two equal",
      side, configured, window);
}

std::vector<std::string> other_window_lines(const CaseView& view) {
  std::vector<std::string> lines;
  const auto look = [&](const std::string& side, const ForeignKeys& keys) {
    if (keys.precice_config.empty()) return;
    for (const PreciceConfig::Scheme& scheme : PreciceConfig::read(keys.precice_config).schemes)
      if (const std::string line = other_window_line(side, scheme.window, view.common.window); !line.empty())
        return lines.push_back(line);
  };
  for (const SideView* side : view.sides()) look(side->side, view.common.program_of(side->side));
  return lines;
}

void check_precice_names(const std::string& side, const ForeignKeys& keys) {
  if (keys.precice_config.empty()) return;
  const PreciceConfig config = PreciceConfig::read(keys.precice_config);
  std::vector<std::string> known;
  for (const PreciceConfig::Data& data : config.data) known.push_back(data.name);
  for (const std::string& rule : keys.precice_names) {
    const std::string name = rule.substr(0, rule.find('='));
    if (config.find_data(name)) continue;
    const std::string nearest = did_you_mean(name, known);
    throw Error(ExitCode::case_file, fmt::format("{}.precice: \"{}\"", side, rule),
                fmt::format("{} is no data of {}", name, config.file.string()),
                nearest.empty() ? fmt::format("it has {}", joined(known))
                                : fmt::format("did you mean \"{}\"?", nearest));
  }
}

std::vector<std::string> discretisations(const CaseView& view, const SideView& body) {
  const std::string table = body.is_body ? "structures." + body.side + "." : "structure.";
  if (body.solver == "rigid")
    for (const char* form : {"wedge", "cylinder", "sphere", "outline", "offsets"})
      for (const auto& [key, value] : view.value) {
        const std::string name = table + form;
        if (key == name || key.starts_with(name + ".") || key.starts_with(name + "[")) return {"rigid"};
      }
  return {"fem", "particle", "rigid"};
}

}  // namespace strake
