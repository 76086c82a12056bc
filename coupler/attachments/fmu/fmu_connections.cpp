#include "coupler/attachments/fmu/fmu_connections.hpp"

#include "coupler/attachments/fmu/fmu_instance.hpp"
#include "proto/error.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace strake {
namespace {

/// An SI unit by name and by its exponents.
struct SiUnit {
  std::string name;
  BaseUnit base;
};

/// One entry of a list of the case, "left = right", and how to refuse it.
struct Connection {
  const FmuParameters& parameters;
  const ModelDescription& model;
  std::string list, text;  // "inputs"; the entry
  Eigen::Index n_points = 1;
  int dimension = 3;

  [[noreturn]] void refuse(const std::string& problem, const std::string& fix = {}) const {
    throw Error(ExitCode::case_file,
                fmt::format("attachments.{}.fmu.{}: \"{}\"", parameters.name, list, visible(text, "")),
                problem, fix);
  }

  /// Names of variables may hold '=' in quotes; quantities and numbers hold none.
  std::pair<std::string, std::string> sides(std::size_t equals, const std::string& example) const {
    if (equals == std::string::npos) refuse("has no =", example);
    const std::string left(trimmed(text.substr(0, equals))), right(trimmed(text.substr(equals + 1)));
    if (left.empty() || right.empty()) refuse("lacks a side", example);
    return {left, right};
  }

  const FmuVariable& variable(const std::string& name, const std::string& causality) const {
    const std::vector<std::string> known = model.names_with(causality);
    const FmuVariable* found = model.find(name);
    const std::string what = fmt::format("its variables of causality {}: {}", causality,
                                         known.empty() ? "none" : visible(listed(known), ""));
    if (found == nullptr) {
      const std::string near = did_you_mean(name, known);
      refuse(fmt::format("the FMU has no variable {}", visible(name, "")),
             near.empty() ? what : fmt::format("did you mean {}?", visible(near, "")));
    }
    if (found->causality != causality)
      refuse(
          fmt::format("{} has the causality {}, expected {}", visible(name, ""), found->causality, causality),
          found->causality == "structuralParameter" ? "structural parameters keep their values" : what);
    if (found->is_array) refuse(name + " is an array, expected a scalar", "export its elements one by one");
    if (found->is_clocked) refuse(name + " belongs to a clock, which needs event mode", what);
    return *found;
  }

  static std::string listed(const std::vector<std::string>& names) {
    constexpr std::size_t most = 20;
    if (names.size() <= most) return joined(names);
    return joined({names.begin(), names.begin() + most}) + ", …";
  }

  const FmuVariable& real_variable(const std::string& name, const std::string& causality,
                                   const std::vector<SiUnit>& allowed) const {
    const FmuVariable& found = variable(name, causality);
    if (found.type != "Float64")
      refuse(fmt::format("{} is of the type {}, expected Float64", name, found.type));
    if (found.unit.empty()) return found;
    const auto unit = model.units.find(found.unit);
    for (const SiUnit& one : allowed)
      if (unit == model.units.end() ? found.unit == one.name : unit->second == one.base) return found;
    refuse(
        fmt::format("{} has the unit {}, expected {}", name, visible(found.unit, ""), allowed.front().name),
        "Strake's quantities are in SI units");
  }

  /// "y" or "y.2".
  PointComponent component(const std::string& words) const {
    PointComponent at;
    at.axis = static_cast<Eigen::Index>(std::string("xyz").find(words.empty() ? ' ' : words[0]));
    const bool numbered = words.size() > 2 && words[1] == '.';
    if ((words.size() != 1 && !numbered) || at.axis < 0 || at.axis >= dimension)
      refuse(fmt::format("\"{}\" is no component", visible(words, "")),
             dimension == 2 ? "x or y; of the second point x.2" : "x, y or z; of the second point x.2");
    if (!numbered) return at;
    at.point = number_from<decltype(at.point)>(words.substr(2)).value_or(0);
    if (at.point < 1 || at.point > n_points)
      refuse(fmt::format("there is no point {}", visible(words.substr(2), "")),
             fmt::format("1 to {}, in the order of `at`", n_points));
    at.point -= 1;
    return at;
  }
};

FmuInput input_of(const Connection& entry) {
  const auto [name, what] = entry.sides(entry.text.rfind('='), "variable = displacement.y");
  const std::size_t dot = what.find('.');
  const std::string quantity = what.substr(0, dot);
  if (quantity != "displacement" && quantity != "velocity") {
    const std::string near = did_you_mean(quantity, {"displacement", "velocity"});
    entry.refuse(fmt::format("\"{}\" is no motion of a point", visible(quantity, "")),
                 near.empty() ? "displacement.y or velocity.y" : fmt::format("did you mean {}?", near));
  }
  FmuInput input;
  input.quantity = quantity == "velocity" ? PointMotion::velocity : PointMotion::displacement;
  input.at = entry.component(dot == std::string::npos ? "" : what.substr(dot + 1));
  const SiUnit metre{"m", {{{"m", 1}}}}, speed{"m/s", {{{"m", 1}, {"s", -1}}}};
  input.variable =
      entry.real_variable(name, "input", {input.quantity == PointMotion::velocity ? speed : metre}).reference;
  return input;
}

FmuOutput output_of(const Connection& entry) {
  const auto [what, name] = entry.sides(entry.text.find('='), "force.y = variable");
  if (!what.starts_with("force."))
    entry.refuse(fmt::format("\"{}\" is no force", visible(what, "")), "force.y = variable");
  FmuOutput output;
  output.name = name;
  output.at = entry.component(what.substr(6));
  std::vector<SiUnit> allowed = {{"N", {{{"kg", 1}, {"m", 1}, {"s", -2}}}}};
  if (entry.dimension == 2) allowed.push_back({"N/m", {{{"kg", 1}, {"s", -2}}}});
  output.variable = entry.real_variable(name, "output", allowed).reference;
  return output;
}

std::optional<double> number_in(const std::string& text, const std::string& type) {
  if (type == "Boolean" && (text == "true" || text == "false")) return text == "true" ? 1 : 0;
  const double value = number_from<double>(text).value_or(std::nan(""));
  if (!std::isfinite(value)) return {};
  const auto whole_in = [&](double low, double high) {
    return value == std::floor(value) && value >= low && value <= high;
  };
  constexpr double exact = 9007199254740992;  // 2^53: whole numbers that a double holds
  if (type == "Boolean" && !whole_in(0, 1)) return {};
  if (type == "Int32" &&
      !whole_in(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()))
    return {};
  if ((type == "Int64" || type == "Enumeration") && !whole_in(-exact, exact)) return {};
  if (type == "Float32" && std::abs(value) > std::numeric_limits<float>::max()) return {};
  return value;
}

FmuSetting setting_of(const Connection& entry) {
  const auto [name, number] = entry.sides(entry.text.rfind('='), "variable = 3.0");
  const FmuVariable& variable = entry.variable(name, "parameter");
  if (!takes_number(variable.type))
    entry.refuse(fmt::format("{} is of the type {}, expected a number or a Boolean", name, variable.type));
  const std::optional<double> value = number_in(number, variable.type);
  if (!value)
    entry.refuse(fmt::format("\"{}\" is no value of the type {}", visible(number, ""), variable.type),
                 variable.start.empty() ? "" : "its own is " + visible(variable.start, ""));
  return {variable, *value};
}

/// Refuses an entry that sets the same as one before it.
template <class Key>
void note(std::set<Key>& taken, const Key& key, const Connection& entry) {
  if (!taken.insert(key).second) entry.refuse("is given twice", "leave one of them out");
}

}  // namespace

FmuConnections connect(const FmuParameters& p, const ModelDescription& model, Eigen::Index n_points,
                       int dimension) {
  FmuConnections all;
  Connection entry{p, model, "inputs", {}, n_points, dimension};
  std::set<fmi3ValueReference> set_variables;
  for (const std::string& text : p.inputs) {
    entry.text = text;
    all.inputs.push_back(input_of(entry));
    note(set_variables, all.inputs.back().variable, entry);
  }
  entry.list = "outputs";
  std::set<std::pair<Eigen::Index, Eigen::Index>> forces;
  for (const std::string& text : p.outputs) {
    entry.text = text;
    all.outputs.push_back(output_of(entry));
    note(forces, {all.outputs.back().at.axis, all.outputs.back().at.point}, entry);
  }
  if (all.outputs.empty()) {
    entry.text.clear();
    entry.refuse("the FMU gives no force, so it has no effect", "outputs = [\"force.y = variable\"]");
  }
  entry.list = "parameters";
  for (const std::string& text : p.parameters) {
    entry.text = text;
    all.settings.push_back(setting_of(entry));
    note(set_variables, all.settings.back().variable.reference, entry);
  }
  return all;
}

}  // namespace strake
