#pragma once

#include "coupler/attachments/fmu/model_description.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

/// What a user says of an attachment that an FMU computes.
struct FmuParameters {
  std::string name;            // of the attachment
  std::filesystem::path file;  // the .fmu, or the folder that it was unpacked into
  /// "variable = displacement.y", or "variable = velocity.x.2" of the second point; without a number: the
  /// first.
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;     // "force.y = variable", "force.y.2 = variable"
  std::vector<std::string> parameters;  // "variable = 3.0"
};

enum class PointMotion { displacement, velocity };

/// A component of a vector at one of the points.
struct PointComponent {
  Eigen::Index axis = 0, point = 0;
};
struct FmuInput {
  fmi3ValueReference variable = 0;
  PointMotion quantity = PointMotion::displacement;
  PointComponent at;
};
struct FmuOutput {
  fmi3ValueReference variable = 0;
  std::string name;   // of the variable
  PointComponent at;  // of the force there
};
struct FmuSetting {
  FmuVariable variable;
  double value = 0;
};

/// The variables of an FMU that are connected to the points, and its parameters.
struct FmuConnections {
  std::vector<FmuInput> inputs;
  std::vector<FmuOutput> outputs;
  std::vector<FmuSetting> settings;
};

/// Error(case_file) for an entry that cannot be read, names a variable that is not there, of another
/// causality or type, or with a unit that is not the SI unit of the quantity.
/// dimension: 2: x and y alone, and a force may be per metre of depth.
FmuConnections connect(const FmuParameters&, const ModelDescription&, Eigen::Index n_points, int dimension);

}  // namespace strake
