#include "coupler/attachments/fmu/model_description.hpp"

#include "coupler/precice/config/xml_elements.hpp"
#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace strake {
namespace {

constexpr std::uintmax_t largest_description = std::uintmax_t{16} << 20;  // [bytes]
const std::string file_name = "modelDescription.xml";

template <class Number>
Number number_of(const XmlElement& element, const std::string& attribute, Number otherwise) {
  const auto found = element.attributes.find(attribute);
  if (found == element.attributes.end()) return otherwise;
  const auto value = number_from<Number>(found->second);
  if (!value) element.refuse(fmt::format("{} = \"{}\" is no number", attribute, found->second), "");
  return *value;
}

/// Reads the elements of one description in their order.
class Reader {
 public:
  void take(const XmlElement& element) {
    if (element.depth == 0) return take_root(element);
    if (element.name == "CoSimulation" && element.depth == 1) return take_co_simulation(element);
    if (element.name == "Unit" && element.parent == "UnitDefinitions") unit_ = element.text("name");
    if (element.name == "BaseUnit" && element.parent == "Unit") take_base_unit(element);
    if (element.parent == "TypeDefinitions" && element.attributes.contains("unit"))
      unit_of_type_[element.text("name")] = element.text("unit");
    if (element.parent == "ModelVariables" && element.depth == 2) return take_variable(element);
    if (element.depth != 3 || model_.variables.empty()) return;
    if (element.name == "Dimension") model_.variables.back().is_array = true;
    if (element.name == "Alias") {
      model_.variables.push_back(model_.variables.back());
      model_.variables.back().name = element.text("name");
    }
  }

  ModelDescription finished(const std::string& file) {
    if (!has_co_simulation_)
      throw Error(ExitCode::case_file, file, "is no FMU for co-simulation",
                  "export it for co-simulation: Strake has no integrator for model exchange");
    return std::move(model_);
  }

 private:
  void take_root(const XmlElement& root) {
    if (root.name != "fmiModelDescription")
      root.refuse("is no description of an FMU, expected <fmiModelDescription>", "");
    const std::string version = root.text("fmiVersion");
    if (version != "3.0" && !version.starts_with("3.0."))
      root.refuse(fmt::format("is FMI {}, expected 3.0", version), "export it as FMI 3.0 for co-simulation");
    model_.model = root.text_or("modelName", "");
    model_.instantiation_token = root.text("instantiationToken");
  }

  void take_co_simulation(const XmlElement& element) {
    has_co_simulation_ = true;
    model_.model_identifier = element.text("modelIdentifier");
    const auto inside = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
    if (model_.model_identifier.empty() ||
        !std::all_of(model_.model_identifier.begin(), model_.model_identifier.end(), inside))
      element.refuse(fmt::format("modelIdentifier = \"{}\" is no identifier of C", model_.model_identifier),
                     "");
    if (element.flag("needsExecutionTool"))
      element.refuse("needs the program that exported it (needsExecutionTool)",
                     "export it with its solver inside");
    model_.can_get_and_set_state = element.flag("canGetAndSetFMUState");
    model_.can_serialize_state = model_.can_get_and_set_state && element.flag("canSerializeFMUState");
    model_.variable_step = element.flag("canHandleVariableCommunicationStepSize");
    model_.fixed_internal_step = number_of(element, "fixedInternalStepSize", 0.0);
    if (!(model_.fixed_internal_step >= 0) || std::isinf(model_.fixed_internal_step))
      element.refuse(fmt::format("fixedInternalStepSize = {}", model_.fixed_internal_step),
                     "seconds, greater than 0");
  }

  void take_base_unit(const XmlElement& element) {
    BaseUnit& base = model_.units[unit_];
    base.factor = number_of(element, "factor", 1.0);
    base.offset = number_of(element, "offset", 0.0);
    for (const char* name : {"kg", "m", "s", "A", "K", "mol", "cd", "rad"})
      if (const int exponent = number_of(element, name, 0); exponent != 0) base.exponent[name] = exponent;
  }

  void take_variable(const XmlElement& element) {
    FmuVariable variable;
    variable.name = element.text("name");
    variable.type = element.name;
    element.text("valueReference");  // must be there
    variable.reference = number_of(element, "valueReference", fmi3ValueReference{0});
    variable.causality = element.text_or("causality", "local");
    const auto type = unit_of_type_.find(element.text_or("declaredType", ""));
    variable.unit = element.text_or("unit", type == unit_of_type_.end() ? "" : type->second);
    variable.start = element.text_or("start", "");
    variable.is_clocked = element.attributes.contains("clocks");
    model_.variables.push_back(std::move(variable));
  }

  ModelDescription model_;
  std::string unit_;                                 // whose <BaseUnit> follows
  std::map<std::string, std::string> unit_of_type_;  // TypeDefinitions stand before ModelVariables
  bool has_co_simulation_ = false;
};

}  // namespace

const FmuVariable* ModelDescription::find(const std::string& name) const {
  const auto found = std::find_if(variables.begin(), variables.end(),
                                  [&](const FmuVariable& variable) { return variable.name == name; });
  return found == variables.end() ? nullptr : &*found;
}

std::vector<std::string> ModelDescription::names_with(const std::string& causality) const {
  std::vector<std::string> names;
  for (const FmuVariable& variable : variables)
    if (variable.causality == causality) names.push_back(variable.name);
  return names;
}

ModelDescription read_model_description(const FmuPackage& package) {
  const std::filesystem::path file = package.folder() / file_name;
  const std::string shown = package.file().string();
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored))
    throw Error(ExitCode::case_file, shown, "holds no " + file_name + ", so it is no FMU",
                "the .fmu, or the folder that it was unpacked into");
  require_file(file, largest_description, shown + "/" + file_name);
  Reader reader;
  try {
    read_xml(file, [&](const XmlElement& element) { reader.take(element); });
  } catch (const Error& error) {  // with the place that the user knows
    std::string where = error.where();
    const std::string unpacked = package.folder().string();
    if (where.starts_with(unpacked)) where.replace(0, unpacked.size(), shown);
    throw Error(error.code(), where, error.problem(), error.fix());
  }
  return reader.finished(shown);
}

}  // namespace strake
