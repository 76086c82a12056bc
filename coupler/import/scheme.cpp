#include "coupler/import/import_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace strake {
namespace {

constexpr double smallest_time = 1e-12, longest_time = 1e12;  // [s] no case is outside
constexpr int most_iterations = 1000;                         // of coupling.surface.converged

void import_kind(const XmlElement& element, ImportedScheme& scheme) {
  const std::string type(element.type());
  if (type != "serial-explicit" && type != "serial-implicit" && type != "parallel-explicit" &&
      type != "parallel-implicit")
    element.refuse("is no scheme of Strake", "serial or parallel, -explicit or -implicit");
  scheme.parallel = {type.starts_with("parallel"), place_of(element)};
  scheme.implicit = {type.ends_with("implicit"), place_of(element)};
}

void import_window(const XmlTree& tree, ImportedScheme& scheme) {
  const XmlTree* window = tree.first("time-window-size");
  if (!window) tree.element.refuse("has no time-window-size", "<time-window-size value=\"…\" />");
  const XmlElement& element = window->element;
  const std::string method = element.text_or("method", "fixed");
  if (method != "fixed")
    element.refuse(
        fmt::format("method = \"{}\": windows that a participant chooses are not in Strake", method),
        "a fixed window; a solver may make it shorter for a while");
  scheme.window = {number_of(element, "value", smallest_time, longest_time), place_of(element)};
}

/// The earlier of both ends that a configuration may have.
void import_end(const XmlTree& tree, ImportedScheme& scheme) {
  scheme.end_time.value = std::numeric_limits<double>::infinity();
  const auto take = [&](double end, const XmlElement& element) {
    if (end < scheme.end_time.value) scheme.end_time = {end, place_of(element)};
  };
  if (const XmlTree* time = tree.first("max-time"))
    take(number_of(time->element, "value", smallest_time, longest_time), time->element);
  if (const XmlTree* windows = tree.first("max-time-windows"))
    take(integer_of(windows->element, "value", 1, std::numeric_limits<int>::max()) * scheme.window.value,
         windows->element);
  if (scheme.end_time.from.empty())
    tree.element.refuse("has no end", "<max-time value=\"…\" />, or <max-time-windows value=\"…\" />");
}

void import_iterations(const XmlTree& tree, ImportedScheme& scheme) {
  const auto value = [&](const char* kind, int otherwise, const char* why) -> Stated<int> {
    const XmlTree* given = tree.first(kind);
    if (!given) return {otherwise, why};
    return {integer_of(given->element, "value", 1, most_iterations), place_of(given->element)};
  };
  if (!scheme.implicit.value) {
    scheme.min_iterations = scheme.max_iterations = {1, "explicit, " + scheme.implicit.from};
    return;
  }
  scheme.min_iterations = value("min-iterations", 1, "not given");
  scheme.max_iterations = value("max-iterations", most_iterations, "not given: the largest that there is");
  if (scheme.min_iterations.value > scheme.max_iterations.value)
    tree.first("min-iterations")
        ->element.refuse("is more than max-iterations", "min-iterations at most as large");
}

}  // namespace

void import_scheme(const Configuration& from, ImportedRun& run) {
  const XmlTree& tree = from.scheme();
  import_kind(tree.element, run.scheme);
  import_window(tree, run.scheme);
  import_end(tree, run.scheme);
  import_iterations(tree, run.scheme);
}

}  // namespace strake
