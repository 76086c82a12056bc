#pragma once

#include <map>
#include <string>

namespace strake {

/// What a name of preCICE's data stands for at Strake's coupler.
struct Quantity {
  std::string name;           // "force"; for other names the name itself
  std::string unit;           // "N"; "1" where Strake does not know the quantity
  int components = 0;         // 3 or 1; 0: as the configuration file says
  bool conservative = false;  // its sum over the points is kept
};

/// From the names of a configuration file to Strake's quantities (proto/WIRE.md, "Quantities and units").
class QuantityNames {
 public:
  /// rules: "Force=force;Displacement=displacement"; may be empty. Error(command_line) for a rule without
  /// "=".
  explicit QuantityNames(const std::string& rules);

  /// The quantity of a rule; without one, that of Strake with this name in lower case. Any other name is
  /// passed on as it is. `conservative` holds for those.
  Quantity of(const std::string& name, bool conservative) const;

 private:
  std::map<std::string, std::string> rules_;
};

}  // namespace strake
