#pragma once

#include "coupler/attachments/fmu/fmi3_functions.hpp"
#include "coupler/attachments/fmu/fmu_package.hpp"

#include <map>
#include <string>
#include <vector>

namespace strake {

/// What a unit is in base units: value in them = factor value + offset.
struct BaseUnit {
  std::map<std::string, int> exponent;  // "kg", "m", "s", …, without zeros
  double factor = 1, offset = 0;
  bool operator==(const BaseUnit&) const = default;
};

struct FmuVariable {
  std::string name;
  std::string type;  // "Float64", "Int32", …
  fmi3ValueReference reference = 0;
  std::string causality = "local";  // "input", "output", "parameter", …
  std::string unit;                 // as declared, by itself or by its type; may be empty
  std::string start;                // as declared; may be empty
  bool is_array = false;
  bool is_clocked = false;  // has a value at ticks of a clock alone
};

/// What modelDescription.xml says, as far as a co-simulation without events needs it.
struct ModelDescription {
  std::string model;  // its name
  std::string instantiation_token, model_identifier;
  bool can_get_and_set_state = false, can_serialize_state = false;
  bool variable_step = false;      // canHandleVariableCommunicationStepSize
  double fixed_internal_step = 0;  // [s] 0: none is declared
  std::map<std::string, BaseUnit> units;
  std::vector<FmuVariable> variables;

  const FmuVariable* find(const std::string& name) const;  // nullptr: there is none
  std::vector<std::string> names_with(const std::string& causality) const;
};

/// Error(case_file) with line and column for what is no description, and for FMUs of FMI 1 and 2, without
/// co-simulation, or which need another program to run.
ModelDescription read_model_description(const FmuPackage&);

}  // namespace strake
