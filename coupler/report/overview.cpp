// What was run and how: the runs themselves, their settings, and their commands.
#include "coupler/participant/launch.hpp"
#include "coupler/plot/html.hpp"
#include "coupler/report/sections.hpp"
#include "coupler/report/sketch.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <set>

namespace strake::report {
namespace {

/// "2026-11-21T22:31:54Z" → "2026-11-21 22:31".
std::string minute(const std::string& utc) {
  return utc.size() < 16 ? utc : utc.substr(0, 10) + " " + utc.substr(11, 5);
}

std::string state_badge(const Recorded& run) {
  return badge(run.exit_code == 0 ? "good" : run.finished() || !run.exit_code ? "open" : "bad", run.state());
}

std::string solvers(const Recorded& run) {
  std::string text;
  for (const auto& [side, solver] : run.solver)
    text += (text.empty() ? "" : "<br>") + ("<span class=\"n\">" + escape(side + " " + solver) + "</span>");
  return text.empty() ? "–" : text;
}

/// The threads of a process, with the ranks of sides that have several: "2 (fluid: 2 ranks × 1)".
std::string threads_cell(const Origin& origin) {
  const std::string shown = quantity(origin.threads, "1");
  if (origin.ranks.empty()) return number_cell(origin.threads, shown);
  return number_cell(origin.threads, fmt::format("{} ({})", shown, joined(origin.ranks)));
}

/// The word after an option in a command line of the case's first lines.
std::string option_in(const std::string& line, const std::string& option) {
  const std::size_t at = line.find(option + " ");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + option.size() + 1;
  return line.substr(begin, line.find(' ', begin) - begin);
}

/// Whether a note of the case's first lines is about this run. One that begins with the tag of a `run` line
/// is about that variant. What the case expects stands beside the numbers where references judge them.
bool is_of_this_run(const Recorded& run, const std::string& word, const std::string& text) {
  if (word == "expect" && !run.compare.empty()) return false;
  const std::string first = text.substr(0, text.find_first_of(" ,:("));
  for (const auto& [other, line] : run.notes)
    if (other == "run" && !first.empty() && option_in(line, "--tag") == first)
      return run.folder.filename().string().ends_with("-" + first);
  return true;
}

}  // namespace

std::string what_was_run(const std::vector<Recorded>& runs) {
  HtmlTable table("The runs of this report");
  table.head({"run", "state", "solvers", "simulated", "windows", "iterations of a window", "wall time",
              "threads", "host", "started (UTC)", "Strake", "compiler"});
  std::string problems;
  for (const Recorded& run : runs) {
    table.row({escape(run.name), state_badge(run), solvers(run), quantity_cell(run.end_time, "s"),
               quantity_cell(run.windows, "1"), quantity_cell(run.mean_iterations, "1"),
               number_cell(run.wall_seconds, duration(run.wall_seconds)), threads_cell(run.origin),
               escape(run.origin.host), "<span class=\"n\">" + escape(minute(run.origin.started)) + "</span>",
               escape(run.origin.version + (run.origin.commit.empty() ? "" : " (" + run.origin.commit + ")")),
               escape(run.origin.compiler)});
    for (const std::string& problem : run.problems)
      problems += "<li>" + escape(run.name + ": " + problem) + "</li>\n";
    if (!run.origin.error.empty())
      problems += "<li>" + escape(run.name + " ended with: " + run.origin.error) + "</li>\n";
  }
  std::string body;
  if (!problems.empty())
    body +=
        "<div class=\"warning\" role=\"note\"><p>Not all of this is whole; what is there is "
        "shown.</p><ul>\n" +
        problems + "</ul></div>\n";
  std::set<std::string> said;
  for (const Recorded& run : runs) {
    std::string notes;
    for (const auto& [word, text] : run.notes)
      if (word != "run" && is_of_this_run(run, word, text) && said.insert(word + text).second)
        notes += "<dt>" + escape(word) + "</dt><dd>" + escape(text) + "</dd>\n";
    if (!notes.empty()) body += "<dl>\n" + notes + "</dl>\n";
  }
  return section("runs", "What was run", body + table.html());
}

/// Says how much the air under the body took part, where it was computed.
std::string air_item(const Recorded& run) {
  const auto left = run.history.find("air.left"), pressure = run.history.find("air.largest_pressure"),
             time = run.history.find("time");
  if (!left || !pressure || !time || run.history.rows() == 0) return {};
  const std::vector<double>&amount = run.history.value[*left], &p = run.history.value[*pressure];
  std::size_t peak = 0;
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p[k] > p[peak] || std::isnan(p[peak])) peak = k;
  // [Pa]; a case that is not whole: the default of the key
  const double open_air = number_from<double>(run.setting("fluid.air.pressure")).value_or(101325);
  const char* const verdict = p[peak] < 0.1 * open_air ? "the air flowed out and hardly mattered"
                              : p[peak] < open_air     ? "the air was compressed a little"
                                                       : "the air was compressed and shaped the peak";
  return "<li>Air in " + escape(run.name) + ": its pressure was largest, " + quantity(p[peak], "Pa") +
         ", at " + quantity(run.history.value[*time][peak], "s") + ". Then " + quantity(amount[peak], "m") +
         " of the " + quantity(amount.front(), "m") +
         " at the start were left under the body, as thickness at the open air's pressure: " + verdict +
         ".</li>\n";
}

std::string limits(const std::vector<Recorded>& runs) {
  std::set<std::string> spacings;
  bool water = false, bare = false;
  for (const Recorded& run : runs) {
    const bool has = run.solver.contains("fluid");
    water = water || has;
    bare = bare || (has && run.setting("fluid.air.layer") != "true");
    if (has && !run.setting("fluid.spacing").empty()) spacings.insert(run.setting("fluid.spacing"));
  }
  if (!water) return {};
  std::string items = bare ? "<li>The water has no air over it: cushions under flat faces, pockets that "
                             "waves shut in and spray in "
                             "air are not computed. fluid.air.layer = true computes the cushion under a flat "
                             "body.</li>\n"
                           : "<li>Air is computed under the body alone, and for its impact: pockets that "
                             "waves shut in and spray in air "
                             "are not.</li>\n";
  for (const Recorded& run : runs) items += air_item(run);
  if (spacings.size() == 1)
    items += "<li>All runs have one spacing, " + escape(*spacings.begin()) +
             " m: how far their numbers depend on it is not shown here. Halve fluid.spacing and report both "
             "runs.</li>\n";
  return section("limits", "Limits", "<ul>\n" + items + "</ul>\n");
}

std::string drawing_of_case(const std::vector<Recorded>& runs) {
  for (const Recorded& run : runs) {
    if (run.settings.empty()) continue;
    std::optional<picture::Scene> start;
    try {
      start = picture::read_scene(picture::find_frames(run.folder), {.time = 0});
    } catch (const std::exception&) {  // a run that wrote no frame still has its tank and water
    }
    const std::string drawn = sketch(run, start ? &*start : nullptr);
    if (!drawn.empty()) return section("sketch", "The case", drawn);
  }
  return {};
}

/// "structures[1].plate.length" → "structures.left.plate.length", as --set takes it.
std::string named(const std::string& key, const std::vector<Recorded>& runs) {
  for (const std::string list : {"structures", "attachments"}) {
    if (!key.starts_with(list + "[")) continue;
    const std::string element = key.substr(0, key.find(']') + 1);
    for (const Recorded& run : runs)
      if (const std::string name = run.setting(element + ".name"); !name.empty())
        return list + "." + name + key.substr(element.size());
  }
  return key;
}

std::string settings(const std::vector<Recorded>& runs) {
  std::vector<const Setting*> keys;
  std::set<std::string> listed;
  for (const Recorded& run : runs)
    for (const Setting& setting : run.settings)
      if (!setting.key.starts_with("compare") && listed.insert(setting.key).second) keys.push_back(&setting);
  HtmlTable differing("Settings in which the runs differ"), given("Settings of the case"),
      defaults("Defaults that nothing changed");
  differing.head(head_of(runs, {"key", "unit"}));
  given.head({"key", "value", "unit", "from"});
  defaults.head({"key", "value", "unit"});
  for (const Setting* key : keys) {
    std::set<std::string> values;
    std::string origin = "default";
    std::vector<std::string> cells = {"<code>" + escape(named(key->key, runs)) + "</code>",
                                      escape(key->unit)};
    for (const Recorded& run : runs) {
      const auto found = std::find_if(run.settings.begin(), run.settings.end(),
                                      [&](const Setting& s) { return s.key == key->key; });
      if (run.settings.empty()) {
        cells.emplace_back("–");
        continue;
      }
      const bool has = found != run.settings.end();
      values.insert(has ? found->value : "");
      cells.push_back(has ? escape(found->value) + (found->origin == "default"
                                                        ? ""
                                                        : " <small>(" + escape(found->origin) + ")</small>")
                          : "not given");
      if (has && found->origin != "default") origin = found->origin;
    }
    if (values.size() > 1)
      differing.row(cells);
    else if (origin != "default")
      given.row({cells[0], escape(key->value), escape(key->unit), escape(origin)});
    else
      defaults.row({cells[0], escape(key->value), escape(key->unit)});
  }
  if (keys.empty()) return {};
  std::string body = differing.empty() ? "" : differing.html();
  if (!given.empty()) body += given.html();
  if (!defaults.empty())
    body += "<details><summary>Defaults that nothing changed</summary>\n" + defaults.html() + "</details>\n";
  return section("settings", "Settings", body);
}

std::string how_to_run_again(const std::vector<Recorded>& runs) {
  std::string body =
      "<p>The commands as they were given; a run's own <code>case.toml</code> is a case too and "
      "holds every key.</p>\n";
  for (const Recorded& run : runs) {
    std::string line;
    for (const std::string& word : run.origin.command) line += (line.empty() ? "" : " ") + shell_word(word);
    if (line.empty()) line = "strake run " + shell_word((run.folder / "case.toml").string());
    body += fmt::format(
        "<h3>{0}</h3>\n<pre tabindex=\"0\" aria-label=\"command of {0}\"><code>{1}</code></pre>\n",
        escape(run.name), escape(line));
  }
  std::set<std::string> more;
  for (const Recorded& run : runs)
    for (const auto& [word, text] : run.notes)
      if (word == "run") more.insert(text);
  if (!more.empty()) {
    body +=
        "<h3>What else the case suggests</h3>\n<pre tabindex=\"0\" aria-label=\"further commands\"><code>";
    for (const std::string& line : more) body += escape(line) + "\n";
    body += "</code></pre>\n";
  }
  return section("again", "How to run it again", body);
}

}  // namespace strake::report
