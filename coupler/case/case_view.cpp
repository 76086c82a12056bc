#include "coupler/case/case_view.hpp"

#include "coupler/case/find_case.hpp"
#include "coupler/case/rank_threads.hpp"
#include "coupler/case/side_programs.hpp"
#include "coupler/compare/compare_block.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/participant/participant_main.hpp"
#include "coupler/participant/stop_request.hpp"
#include "proto/case/case_file.hpp"
#include "proto/case/key_info.hpp"
#include "proto/case/size_limit.hpp"
#include "proto/error.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <sstream>

namespace strake {

namespace {

std::string without_sides(const std::string& toml_text) {
  std::istringstream lines(toml_text);
  std::string line, kept;
  bool keep = true;
  while (std::getline(lines, line)) {
    if (line.starts_with('[')) {
      const std::string name = line.substr(line.find_first_not_of('['));
      const std::string top = name.substr(0, name.find_first_of(".] \t"));
      keep = top != "fluid" && top != "structure" && top != "structures";
    }
    if (keep) kept += line + "\n";
  }
  return kept;
}

}  // namespace

std::string ask(const std::filesystem::path& program, std::vector<std::string> arguments,
                const std::filesystem::path& case_file, const std::vector<std::string>& sets,
                const StopRequest* stop, const std::string& body) {
  const std::string mode = arguments.front();
  arguments.insert(arguments.end(), {"--case", case_file.string()});
  if (!body.empty()) arguments.insert(arguments.end(), {"--body", body});
  for (const std::string& set : sets) {
    arguments.push_back("--set");
    arguments.push_back(set);
  }
  const Captured answer = capture(program, arguments, std::chrono::seconds(120), stop);
  if (answer.exit_code == 0) return answer.out;
  const std::string words = answer.err.empty() ? answer.out : answer.err;
  switch (answer.exit_code) {
    case static_cast<int>(ExitCode::case_file):
    case static_cast<int>(ExitCode::command_line):
    case static_cast<int>(ExitCode::solver_fault):
    case static_cast<int>(ExitCode::cannot_write):
    case static_cast<int>(ExitCode::our_bug):
      throw Error(static_cast<ExitCode>(answer.exit_code), "", words);
    default:
      throw Error(ExitCode::participant_lost, program.string(),
                  fmt::format("{} ended with exit code {}\n{}", mode, answer.exit_code, words),
                  fmt::format("run it by hand: {} {} --case {}", program.string(), mode, case_file.string()));
  }
}

namespace {

/// What `read_case` was called with.
struct Asking {
  const std::vector<std::string>& sets;
  const StopRequest* stop;
  const std::vector<std::string>& by_hand;
  bool properties;
};

/// file: of a body, the case as that body's program reads it.
SideView look_at(const std::string& name, const std::string& solver, CaseFile file, const Asking& asking) {
  SideView side{.side = name,
                .solver = solver,
                .program = {},
                .lines = {},
                .echo = {},
                .properties = {},
                .is_body = !file.body().empty()};
  const std::string table = name == "fluid" ? "fluid" : "structure";
  if (solver == "precice")
    throw file.root()
        .table(table)
        .table("precice", "")
        .error("command", "a program and its arguments: only a preCICE run does without",
               "command = [\"ccx_preCICE\", \"-i\", \"flap\"]");
  const bool users = side.is_users(), elsewhere = starts_by_hand(asking.by_hand, side);
  std::error_code ignored;
  if (users && !elsewhere && !std::filesystem::is_regular_file(solver, ignored)) {
    if (file.has(table + ".precice.command"))
      throw file.root()
          .table(table)
          .table("precice", "")
          .error("command", "a program that is there, or a name on PATH", "there is no file " + solver);
    throw file.root().table(table).error("solver", "the path of a program", "there is no file " + solver);
  }
  if (users && elsewhere)
    side.program = solver;
  else
    side.program = find_program(program_name(table, solver), file.folder());
  if (users) return side;  // only the program itself can check its own table
  std::vector<std::string> modes = {"--check", "--values"};
  if (asking.properties && table == "structure") modes.emplace_back("--table");
  std::istringstream answer(ask(side.program, modes, file.path(), asking.sets, asking.stop, file.body()));
  for (std::string line; std::getline(answer, line) && line + "\n" != values_line;) {
    if (line + "\n" == table_line)
      side.properties.emplace();
    else if (side.properties)
      *side.properties += line + "\n";
    else if (!line.empty())
      side.lines.push_back(line);
  }
  side.echo.assign(std::istreambuf_iterator<char>(answer), {});
  return side;
}

/// Refuses keys of an absent side that none of Strake's programs for that side knows. A known one may stand
/// there for another choice of solver.
void check_absent_side(CaseFile& file, const std::string& side) {
  const CaseTable table = file.root().table(side);
  std::vector<std::string> given = table.keys(), known;
  std::erase(given, "solver");
  if (given.empty()) return;
  const std::vector<std::string> programs =
      side == "fluid" ? std::vector<std::string>{"strake-fluid", "strake-fluid-replay"}
                      : std::vector<std::string>{"strake-structure-rigid"};
  for (const std::string& program : programs) {
    const Captured answer = capture(find_program(program, file.folder()), {"--keys"});
    if (answer.exit_code != 0) return;  // it cannot say
    for (const KeyInfo& key : keys_from_json(answer.out))
      if (key.path.starts_with(side + "."))
        known.push_back(key.path.substr(side.size() + 1,
                                        key.path.find_first_of(".[", side.size() + 1) - side.size() - 1));
  }
  for (const std::string& key : given) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string near = did_you_mean(key, known);
    throw table.error(key, fmt::format("a key of [{}], also where its solver is \"none\"", side),
                      near.empty() ? fmt::format("strake explain {} lists the keys", side)
                                   : fmt::format("did you mean {}?", near));
  }
}

/// Refuses more windows than a disk or an integer can take. Each window has a line of the history and a
/// number.
void check_windows(CaseFile& file, const CommonKeys& common) {
  constexpr double most = 2e9;
  const double windows = common.end_time / common.window;
  if (windows <= most) return;
  throw file.root().error(
      "end_time",
      fmt::format("at most {:g} windows of {:.6g} s, these would be {:.2g}", most, common.window, windows),
      fmt::format("end_time = {:.2g} or less, or a longer coupling.{}.window", most * common.window,
                  common.interface));
}

/// Checks that need several keys.
void check_across(CaseFile& file, const CommonKeys& common) {
  check_windows(file, common);
  if (common.fluid_solver == "none" && common.structure_solver == "none")
    throw file.root().table("fluid").error("solver", "a fluid, or a structure with structure.solver",
                                           "leave out one of the two \"none\"");
  if (common.interface == "volume" && !common.bodies.empty())
    throw file.root()
        .table("coupling")
        .error("interface", "\"surface\": volume coupling takes one body, in [structure]",
               "interface = \"surface\"");
  if (!common.bodies.empty() && common.fluid_solver == "none")
    throw file.root().table("fluid").error("solver", "a fluid: several bodies have only the water in common",
                                           "a case of its own for each body, with [structure]");
  if (common.fluid_solver == "none" || common.structure_solver == "none") return;
  if (common.interface == "volume" && common.structure_solver != "particle" &&
      common.structure_solver.find('/') == std::string::npos)
    throw file.root()
        .table("coupling")
        .error("interface", "\"surface\": volume coupling needs structure.solver = \"particle\"",
               "structure.solver = \"particle\", or interface = \"surface\"");
}

}  // namespace

std::vector<std::string> lines_with(const std::string& words, const SideView& side) {
  std::vector<std::string> found;
  for (const std::string& line : side.lines)
    if (line.starts_with(words)) found.push_back(line.substr(words.size()));
  return found;
}

bool is_large(const SideView& side) {
  return !lines_with(not_built_words, side).empty();
}

std::string program_name(const std::string& side, const std::string& solver) {
  if (solver.find('/') != std::string::npos) return solver;
  if (side == "fluid") return solver == "mps" ? "strake-fluid" : "strake-fluid-" + solver;
  return "strake-structure-" + solver;
}

std::vector<double> numbers_in(const std::string& value) {
  std::vector<double> numbers;
  for (const char* at = value.c_str(); *at != '\0';) {
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end != at) numbers.push_back(number);
    at = end == at ? at + 1 : end;
  }
  return numbers;
}

std::optional<std::string> ask_solver(const CaseView& view, const SideView& structure,
                                      const std::string& solver, const std::string& mode,
                                      const StopRequest* stop) {
  std::filesystem::path program;
  try {
    program = find_program(program_name("structure", solver), view.folder);
  } catch (const Error&) {
    return std::nullopt;  // an optional one that was not built
  }
  std::vector<std::string> sets = view.sets;
  const std::string body = structure.is_body ? structure.side : "";
  sets.push_back(fmt::format("{}.solver={}", body.empty() ? "structure" : "structures." + body, solver));
  return ask(program, {mode}, view.path, sets, stop, body);
}

CaseLookup lookup_in(std::map<std::string, std::string> values) {
  return [values = std::move(values)](const std::string& key) -> std::optional<std::string> {
    return values.contains(key) ? std::optional(values.at(key)) : std::nullopt;
  };
}

bool CaseView::moves_freely() const {
  return std::any_of(value.begin(), value.end(), [](const auto& key) {
    return key.first.starts_with("structure") && key.first.find(".free.") != std::string::npos &&
           key.second == "true";
  });
}

bool CaseView::any_deforms() const {
  return std::any_of(structures.begin(), structures.end(),
                     [](const SideView& side) { return side.deforms(); });
}

std::vector<const SideView*> CaseView::sides() const {
  std::vector<const SideView*> all;
  if (fluid) all.push_back(&*fluid);
  for (const SideView& structure : structures) all.push_back(&structure);
  return all;
}

std::vector<std::string> CaseView::bodies() const {
  std::vector<std::string> names;
  for (const SideView& structure : structures)
    if (structure.is_body) names.push_back(structure.side);
  return names;
}

std::optional<double> CaseView::number(const std::string& key) const {
  const std::string text = at_or(value, key);
  if (text.empty()) return std::nullopt;
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  return *end == '\0' ? std::optional<double>(number) : std::nullopt;
}

namespace {

/// Puts together what the three programs read: the text of case.toml, and each key's value.
void resolve(const CaseFile& file, CaseView& view) {
  const std::string own = file.echo();
  view.resolved = without_sides(own);
  view.value = flatten_toml(own, "case.toml");
  for (const SideView* side : view.sides()) {
    if (!side->echo.empty()) view.resolved += "\n" + side->echo;
    for (const auto& [key, text_value] : flatten_toml(side->echo, "case.toml")) view.value[key] = text_value;
  }
  // A side that is absent still has its word in case.toml, or the echo would read as the default.
  if (!view.fluid) view.resolved += "\n[fluid]\nsolver = \"none\"\n";
  if (view.structures.empty()) view.resolved += "\n[structure]\nsolver = \"none\"\n";
  for (const SideView* side : view.sides()) {
    if (!side->echo.empty()) continue;
    const CaseFile read = side->is_body ? file.of_body(side->side) : file;
    view.resolved +=
        "\n# read by a program of the user's: as given; files that it looks for itself are relative to " +
        file.folder().string() + "\n" +
        read.as_given(side->side == "fluid" ? "fluid" : "structure",
                      view.common.program_of(side->side).adapted
                          ? "precice"
                          : std::filesystem::absolute(side->program).string());
  }
}

/// The bodies of a case, or its one structure; none where its solver is "none".
std::vector<BodyKeys> structures_of(const CommonKeys& common) {
  if (!common.bodies.empty() || common.structure_solver == "none") return common.bodies;
  return {{.name = "structure", .solver = common.structure_solver, .program = common.structure_program}};
}

}  // namespace

CaseView read_case(const std::filesystem::path& case_file, const std::vector<std::string>& sets,
                   const StopRequest* stop, const std::vector<std::string>& by_hand, bool properties) {
  CaseFile file = load_no_study(case_file, sets);
  std::optional<CommonKeys> read;
  CouplingKeys coupling;
  std::vector<CompareBlock> blocks;
  std::vector<AttachmentKeys> attachments;
  std::vector<Error> refused;
  const auto collect = [&refused](const auto& look) {
    try {
      look();
    } catch (const Error& error) {
      if (error.code() != ExitCode::case_file) throw;
      refused.push_back(error);
    }
  };
  collect([&] {
    file.read_all([&] {
      read = read_common(file);
      coupling = read_coupling(file);
      blocks = read_compare_blocks(file);
      attachments = read_attachments(file, *read);
      for (const char* side : {"fluid", "structure"})
        file.root().table(side).accept_all();  // for its program
      file.refuse_unknown();
    });
    check_across(file, *read);
  });
  if (!read) throw refused.front();
  const CommonKeys common = *read;
  CaseView view{.path = file.path(),
                .folder = file.folder(),
                .hash = file.hash(),
                .common = common,
                .coupling = coupling,
                .blocks = blocks,
                .fluid = std::nullopt,
                .structures = {},
                .attachments = attachments,
                .sets = sets,
                .resolved = {},
                .value = {}};
  const Asking asking{sets, stop, by_hand, properties};
  const std::string& fluid = common.fluid_solver;
  if (fluid != "none") collect([&] { view.fluid = look_at("fluid", fluid, file, asking); });
  if (fluid == "none") collect([&] { check_absent_side(file, "fluid"); });
  if (common.structure_solver == "none") collect([&] { check_absent_side(file, "structure"); });
  for (const BodyKeys& one : structures_of(common)) {
    const CaseFile own = common.bodies.empty() ? file : file.of_body(one.name);
    collect([&] { view.structures.push_back(look_at(one.name, one.solver, own, asking)); });
    const std::string table = common.bodies.empty() ? one.name : "structures." + one.name;
    collect([&] { check_precice_names(table, one.program); });
  }
  collect([&] { check_precice_names("fluid", common.fluid_program); });
  collect([&] { check_attached_programs(view, by_hand); });
  if (!refused.empty()) throw all_of(refused);
  resolve(file, view);
  say_shares(view);
  return view;
}

}  // namespace strake
