#include "coupler/case/case_view.hpp"
#include "coupler/case/rank_threads.hpp"
#include "coupler/case/side_programs.hpp"
#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/participant/stop_request.hpp"
#include "coupler/run/run_folder.hpp"
#include "coupler/run/session.hpp"
#include "coupler/summary/pace.hpp"
#include "coupler/summary/start.hpp"
#include "proto/case/size_limit.hpp"
#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>

namespace strake {
namespace {

/// A body as each discretisation of ours has it; one that cannot take the case says why.
void print_properties(const CaseView& view, const SideView& body, const StopRequest& stop) {
  std::string rows;
  for (const std::string& solver : discretisations(view, body)) try {
      rows += solver == body.solver && body.properties  // its program has been asked with the case
                  ? *body.properties
                  : ask_solver(view, body, solver, "--properties", &stop).value_or("");
    } catch (const Error& error) {
      if (solver == "rigid" || body.solver == "rigid") continue;  // the other rows say it, or there are none
      // The line, and from below it what was expected there.
      const std::string words = error.problem(), expected = "^ expected ";
      std::string why = words.substr(0, words.find('\n'));
      if (const std::size_t at = words.find(expected); at != std::string::npos)
        why += ": " + words.substr(at + expected.size(), words.find('\n', at) - at - expected.size());
      rows += fmt::format("{:<10} not with this case: {}\n", solver, why);
    }
  if (!rows.empty())
    fmt::print("\n{}, by discretisation\n{:<10} {:>12}   {} {:>14}   {:<28} {}\n{}",
               body.is_body ? body.side : "the body", "solver", "mass [kg]", "centre [m]", "inertia [kg m2]",
               "f1, f2, f3 dry [Hz]", "stable step", visible(rows));
}

/// The title, how large each side is, how the run steps and what that costs, and what is not built.
void print_head(const CaseView& view, const CheckOptions& options) {
  std::vector<std::string> sizes, not_built;
  for (const SideView* side : view.sides()) {
    for (const std::string& text : lines_with(size_words, *side)) sizes.push_back(side->side + ": " + text);
    for (const std::string& text : lines_with(not_built_words, *side))
      not_built.push_back(side->side + ": " + text);
  }
  fmt::print("{}\n", visible(view.common.title.empty() ? options.case_file.string() : view.common.title));
  fmt::print("{}{}{}", block_text("size", sizes), block_text("steps", pace_lines(view)),
             block_text("not built", not_built));
}

/// Whether both sides are small enough for a check to set them up.
bool can_be_built(const CaseView& view) {
  for (const SideView* side : view.sides())
    if (is_large(*side)) return false;
  return true;
}

Error nothing_to_draw(const std::filesystem::path& path) {
  return {ExitCode::command_line, "--picture " + path.string(), "the case has no structure of ours to draw",
          "leave --picture out"};
}

/// One drawing per discretisation, one above the other.
void write_picture(const CaseView& view, const std::filesystem::path& path, const StopRequest& stop) {
  std::string drawings;
  double y = 0, width = 0;
  for (const SideView& body : view.structures) {
    double drawn = 0;  // of this body
    for (const std::string& solver : discretisations(view, body)) try {
        const std::string drawing = ask_solver(view, body, solver, "--picture", &stop).value_or("");
        if (drawing.empty() || (solver == "rigid" && drawn > 0 && body.solver != "rigid")) continue;
        const auto number = [&](const std::string& name) {
          const std::size_t at = drawing.find(name + "='");
          return at == std::string::npos ? 0.0 : std::strtod(drawing.c_str() + at + name.size() + 2, nullptr);
        };
        drawings += fmt::format("<g transform='translate(0 {:.0f})'>\n{}</g>\n", y, drawing);
        y += number("height");
        drawn += number("height");
        width = std::max(width, number("width"));
      } catch (const Error&) {  // the table says why
      }
  }
  if (drawings.empty()) throw nothing_to_draw(path);
  write_whole(path, fmt::format("<svg xmlns='http://www.w3.org/2000/svg' width='{0:.0f}' height='{1:.0f}' "
                                "viewBox='0 0 {0:.0f} {1:.0f}'>\n{2}</svg>\n",
                                width, y, drawings));
  fmt::print("\npicture    {}\n", path.string());
}

void print_warning(const std::string& text) {
  fmt::print("  warning    {}\n", visible(text));
}

/// What both sides say of the case when they are set up, as a run would do it.
void print_understood(const CaseView& view, const CheckOptions& options, const StopRequest& stop) {
  const TrialFolder folder;
  std::optional<Session> session;
  try {
    session.emplace(
        view, Session::Options{.run_folder = {},
                               .log_folder = folder.path(),
                               .patient = options.patient,
                               .say = [](const std::string& line) { put(stderr, visible(line) + "\n"); },
                               .stop = &stop});
  } catch (const Error&) {
    // A value in another unit is often why a body or the water does not fit.
    for (const std::string& warning : far_off_lines(view, 0)) print_warning(warning);
    throw;
  }
  print_head(view, options);
  for (const std::string& warning : session->warnings()) print_warning(warning);
  for (const std::string& warning : other_window_lines(view)) print_warning(warning);
  for (const std::string& warning : judged_lines(view, session->columns())) print_warning(warning);
  fmt::print("{}", block_text("resolution", session->resolution()));
  for (const auto& [name, lines] : session->understood()) fmt::print("{}", block_text(name, lines));
  fmt::print("{}", block_text("mapping", session->mapping_lines()));
}

}  // namespace

/// Checks everything that `run` would refuse, and sets up both solvers if that does not take long. No window
/// is advanced, no file is left.
ExitCode check(const CheckOptions& options, const StopRequest& stop) {
  if (!options.picture.empty() && options.picture.extension() != ".svg")
    throw Error(ExitCode::command_line, "--picture " + options.picture.string(), "check draws an .svg",
                "--picture " + std::filesystem::path(options.picture).replace_extension(".svg").string());
  const CaseView view = read_case(options.case_file, options.sets, &stop, {}, true);
  const bool built = can_be_built(view);
  if (built) {
    print_understood(view, options, stop);
  } else {
    print_head(view, options);
    for (const std::string& warning : crowd_lines(view)) print_warning(warning);
    for (const std::string& warning : far_off_lines(view, 0)) print_warning(warning);
    // Without the bodies' meshes neither their size nor what stands under the water is known.
    for (const std::string& warning : start_lines(view, {})) print_warning(warning);
  }

  const auto is_ours = [](const SideView& side) { return !side.is_users(); };
  for (const SideView& body : view.structures)
    if (built && is_ours(body) && body.solver != "replay") print_properties(view, body, stop);
  if (!options.picture.empty()) {
    if (!std::any_of(view.structures.begin(), view.structures.end(), is_ours))
      throw nothing_to_draw(options.picture);
    write_picture(view, options.picture, stop);
  }
  if (options.all) fmt::print("\nevery value and where it came from\n{}", visible(view.resolved));
  fmt::print("\n{}: nothing to refuse{}\n", options.case_file.string(), built ? "" : " before it is built");
  if (!options.all) fmt::print("  values  strake check {} --all\n", shell_word(options.case_file.string()));
  fmt::print("  next    strake run {}\n", shell_word(options.case_file.string()));
  return ExitCode::done;
}

}  // namespace strake
