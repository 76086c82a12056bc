#include "coupler/import/import_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace strake {
namespace {

constexpr double smallest = std::numeric_limits<double>::min();  // a factor is larger than 0
/// What preCICE 3.4 takes where the configuration is silent (its page on acceleration).
constexpr double aitken_relaxation = 0.5, quasi_newton_relaxation = 0.1;
constexpr int used_iterations = 100, windows_reused = 20;
constexpr double filter_without_element = 1e-2, filter_without_limit = 1e-16;
constexpr const char* not_given = "not given: as preCICE 3.4";

Stated<double> relaxation_of(const XmlTree& acceleration, const char* kind, double otherwise) {
  const XmlTree* given = acceleration.first(kind);
  if (!given) return {otherwise, not_given};
  return {number_of(given->element, "value", smallest, 1), place_of(given->element)};
}

Stated<int> count_of(const XmlTree& acceleration, const char* kind, int otherwise, int min, int max) {
  const XmlTree* given = acceleration.first(kind);
  if (!given) return {otherwise, not_given};
  return {integer_of(given->element, "value", min, max), place_of(given->element)};
}

void import_filter(const XmlTree& acceleration, ImportedRun& run) {
  ImportedAcceleration& ours = run.acceleration;
  const XmlTree* given = acceleration.first("filter");
  if (!given) {
    ours.filter = {filter_without_element, not_given};
    ours.filter_kind = {"QR2", "not given"};
    run.notes.push_back(
        fmt::format("{}: without a filter preCICE 3.4 uses QR3; the case has QR2 with its limit, {:g}",
                    place_of(acceleration.element), filter_without_element));
    return;
  }
  const XmlElement& element = given->element;
  const std::string type = element.text("type");
  if (type != "QR1" && type != "QR2")
    element.refuse(fmt::format("type = \"{}\" is not in Strake", type), "QR2 with the same limit, or QR1");
  ours.filter_kind = {type, place_of(element)};
  ours.filter = element.attributes.count("limit")
                    ? Stated<double>{number_of(element, "limit", 0, 1), place_of(element)}
                    : Stated<double>{filter_without_limit, not_given};
}

void import_quasi_newton(const XmlTree& acceleration, ImportedRun& run) {
  ImportedAcceleration& ours = run.acceleration;
  ours.initial_relaxation = relaxation_of(acceleration, "initial-relaxation", quasi_newton_relaxation);
  ours.max_columns = count_of(acceleration, "max-used-iterations", used_iterations, 1, 1000);
  ours.reused_windows = count_of(acceleration, "time-windows-reused", windows_reused, 0, 100);
  import_filter(acceleration, run);
  if (const XmlTree* weight = acceleration.first("preconditioner"))
    if (const std::string type = weight->element.text("type"); type != "residual-sum")
      run.notes.push_back(
          fmt::format("{}: the preconditioner {} is left out: Strake weighs by the sum of residuals",
                      place_of(weight->element), type));
  if (const XmlTree* first = acceleration.first("initial-relaxation"))
    if (first->element.flag("enforce"))
      run.notes.push_back(
          fmt::format("{}: enforce is left out: the relaxation is for the first iteration of a run, "
                      "or where no difference is left",
                      place_of(first->element)));
}

/// In a serial scheme only what the second participant sends can be accelerated, in preCICE as well.
void check_data(const XmlTree& acceleration, const ImportedRun& run) {
  if (run.scheme.parallel.value) return;
  const std::vector<std::string>& sends = run.structure.sends;
  for (const XmlTree* data : acceleration.all("data"))
    if (const std::string name = data->element.text("name");
        std::find(sends.begin(), sends.end(), name) == sends.end())
      data->element.refuse(
          fmt::format("{} does not go from {} to {}: a serial scheme accelerates nothing else", name,
                      run.structure.participant.value, run.fluid.participant.value),
          fmt::format("name=\"{}\"", sends.front()));
}

}  // namespace

void import_acceleration(const Configuration& from, ImportedRun& run) {
  const auto given = from.scheme().all("acceleration");
  if (given.empty() || !run.scheme.implicit.value) {
    run.acceleration.kind = {"constant", "no acceleration"};
    run.acceleration.initial_relaxation = {1.0, "no acceleration"};
    return;
  }
  if (given.size() > 1) given[1]->element.refuse("is a second acceleration", "one of them");
  const XmlTree& acceleration = *given.front();
  const XmlElement& element = acceleration.element;
  check_data(acceleration, run);
  const std::string_view type = element.type();
  run.acceleration.kind.from = place_of(element);
  std::string& kind = run.acceleration.kind.value;
  if (type == "constant") {
    kind = "constant";
    const XmlTree* factor = acceleration.first("relaxation");
    if (!factor) element.refuse("has no relaxation", "<relaxation value=\"0.5\" />");
    run.acceleration.initial_relaxation = relaxation_of(acceleration, "relaxation", 1);
  } else if (type == "aitken") {
    kind = "aitken";
    run.acceleration.initial_relaxation =
        relaxation_of(acceleration, "initial-relaxation", aitken_relaxation);
  } else if (type == "IQN-ILS" || type == "IQN-IMVJ") {
    kind = type == "IQN-ILS" ? "iqn-ils" : "iqn-imvj";
    import_quasi_newton(acceleration, run);
  } else {
    element.refuse("is no acceleration of Strake", "constant, aitken, IQN-ILS or IQN-IMVJ");
  }
}

}  // namespace strake
