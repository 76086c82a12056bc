#pragma once

#include "coupler/case/case_view.hpp"

#include <string>
#include <vector>

namespace strake {

/// A rigid body over a tank 2 m wide and 0.75 m deep. spacing [m]; end_time [s].
inline CaseView case_with(double spacing, double end_time) {
  CaseView view;
  view.fluid = SideView{.side = "fluid", .solver = "mps", .program = {}, .lines = {}, .echo = {}};
  view.structures.push_back(
      SideView{.side = "structure", .solver = "rigid", .program = {}, .lines = {}, .echo = {}});
  view.common.end_time = end_time;
  view.value = {{"fluid.spacing", std::to_string(spacing)}, {"fluid.water", "[[-1, -0.75, 0], [1, 0, 0]]"}};
  return view;
}

/// Whether one of the lines holds these words.
inline bool says(const std::vector<std::string>& lines, const std::string& words) {
  for (const std::string& line : lines)
    if (line.find(words) != std::string::npos) return true;
  return false;
}

}  // namespace strake
