#include "coupler/import/import_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

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

namespace {

constexpr double any_absolute = 1e300;
constexpr std::string_view ending = "-convergence-measure";

ImportedLimits limits_of(const XmlElement& element, std::string_view kind) {
  const auto number = [&](const char* attribute, double max) {
    return number_of(element, attribute, 0, max);
  };
  ImportedLimits limits;
  limits.from = place_of(element);
  if (kind == "absolute") limits.absolute = number("limit", any_absolute);
  if (kind == "relative") limits.relative = number("limit", 1);
  if (kind == "residual-relative") limits.residual_relative = number("limit", 1);
  if (kind == "absolute-or-relative") {
    limits.absolute = number("abs-limit", any_absolute);
    limits.relative = number("rel-limit", 1);
  }
  return limits;
}

/// The limits of the data of one participant: the same for all of them, as the case file has it.
class SideLimits {
 public:
  explicit SideLimits(const ImportedSide& side) : side_(side) {}

  bool sends(const std::string& data) const {
    return std::find(side_.sends.begin(), side_.sends.end(), data) != side_.sends.end();
  }

  void add(const XmlElement& element, const std::string& data, const ImportedLimits& limits) {
    if (const auto other = measured_.find(data); other != measured_.end())
      element.refuse(fmt::format("is a second measure of {} after {}: in preCICE both hold, in Strake the "
                                 "easier one is enough",
                                 data, other->second),
                     "the stricter one alone");
    if (!measured_.empty() && !(limits == limits_))
      element.refuse(fmt::format("has other limits than {}, and Strake has one limit for all data of {}",
                                 limits_.from, side_.participant.value),
                     "the same limits");
    if (measured_.empty()) limits_ = limits;
    measured_[data] = limits.from;
  }

  /// The limits, and what has to be said about them.
  ImportedLimits end(std::vector<std::string>& notes) const {
    if (measured_.empty())
      return {.relative = 0, .absolute = any_absolute, .residual_relative = 0, .from = {}};
    for (const std::string& data : side_.sends)
      if (!measured_.count(data))
        notes.push_back(fmt::format("{} has no measure: it has to settle as the other data of {}", data,
                                    side_.participant.value));
    if (limits_.absolute > 0)
      notes.push_back(
          fmt::format("{}: preCICE's absolute limit is of all points together, Strake's is the root "
                      "mean square of them: divide {:g} by the root of the number of points",
                      limits_.from, limits_.absolute));
    return limits_;
  }

 private:
  const ImportedSide& side_;
  std::map<std::string, std::string> measured_;  // data, and where its measure is
  ImportedLimits limits_;
};

/// Without any measure each window has the same number of iterations.
void fix_iterations(const XmlElement& scheme, ImportedRun& run) {
  Stated<int>&min = run.scheme.min_iterations, &max = run.scheme.max_iterations;
  if (min.value != max.value)
    scheme.refuse(
        "has no convergence measure",
        "<relative-convergence-measure data=\"…\" mesh=\"…\" limit=\"1e-4\" />, or min-iterations and "
        "max-iterations of the same value");
}

}  // namespace

void import_measures(const Configuration& from, ImportedRun& run) {
  const XmlTree& scheme = from.scheme();
  SideLimits of_fluid(run.fluid), of_structure(run.structure);
  for (const XmlTree& one : scheme.inner) {
    const XmlElement& element = one.element;
    std::string_view kind = element.kind();
    if (!kind.ends_with(ending)) continue;
    kind.remove_suffix(ending.size());
    const std::string data = element.text("data");
    SideLimits* side = of_fluid.sends(data) ? &of_fluid : of_structure.sends(data) ? &of_structure : nullptr;
    if (!side)
      element.refuse(fmt::format("measures {}, which is not exchanged", data), "the name of exchanged data");
    const ImportedLimits limits = limits_of(element, kind);
    if (limits.absolute > 0 && side == &of_structure && run.structure.sends.size() > 1)
      element.refuse(
          fmt::format("is an absolute limit, and {} sends {} data: Strake tests it for the first alone",
                      run.structure.participant.value, run.structure.sends.size()),
          "a relative measure");
    side->add(element, data, limits);
    if (element.flag("strict") && run.scheme.strict.from.empty())
      run.scheme.strict = {true, place_of(element)};
  }
  if (!run.scheme.implicit.value) return;
  run.scheme.of_fluid = of_fluid.end(run.notes);
  run.scheme.of_structure = of_structure.end(run.notes);
  if (run.scheme.of_fluid.from.empty() && run.scheme.of_structure.from.empty())
    fix_iterations(scheme.element, run);
}

}  // namespace strake
