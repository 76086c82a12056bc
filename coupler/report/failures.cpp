// Where and when structures that may fail began to.
#include "coupler/plot/html.hpp"
#include "coupler/plot/ticks.hpp"
#include "coupler/report/sections.hpp"
#include "proto/lookup.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace strake::report {

std::string failures(const std::vector<Recorded>& runs) {
  using Name = std::pair<std::string, std::string>;  // body, event
  std::vector<Name> names;
  std::set<std::string> bodies;
  for (const Recorded& run : runs) {
    for (const FailureEvent& event : run.failure)
      if (const Name name(event.body, event.name); std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(name);
    for (const auto& [body, energy] : run.failure_energy) bodies.insert(body);
  }
  if (names.empty()) return {};
  const auto of = [](const std::string& body) { return body.empty() ? "" : body + ": "; };
  const std::map<std::string, std::string> words_of = {
      {"start", "strength reached"}, {"crack", "first bond or cell broken"}, {"parted", "in two pieces"}};
  HtmlTable table("When and where");
  table.head(head_of(runs, {"event"}));
  for (const auto& [body, name] : names) {
    std::vector<std::string> cells = {escape(of(body) + at_or(words_of, name, name))};
    for (const Recorded& run : runs) {
      std::string cell = "–";
      for (const FailureEvent& event : run.failure) {
        if (event.body != body || event.name != name || !event.time) continue;
        cell = quantity_cell(event.time, "s") + " <span class=\"n\">at x = " + quantity_cell(event.x, "m") +
               ", y = " + quantity_cell(event.y, "m") + "</span>";
        if (event.z.value_or(0) != 0)
          cell += " <span class=\"n\">z = " + quantity_cell(event.z, "m") + "</span>";
      }
      cells.push_back(cell);
    }
    table.row(cells);
  }
  for (const std::string& body : bodies) {
    std::vector<std::string> energy = {escape(of(body) + "energy released")};
    for (const Recorded& run : runs) {
      const auto found = run.failure_energy.find(body);
      energy.push_back(quantity_cell(
          found == run.failure_energy.end() ? std::nullopt : std::optional(found->second), "J"));
    }
    table.row(energy);
  }
  return section("failure", "Failure", "<p>Places are those of the unloaded structure.</p>\n" + table.html());
}

}  // namespace strake::report
