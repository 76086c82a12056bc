#include "coupler/import/import_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace strake {
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
