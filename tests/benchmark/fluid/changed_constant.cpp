// One tuned number of the least-squares scheme is multiplied before main() begins. Compiled with
// fluid/main.cpp into the program strake-fluid-constants, which tests/benchmark/constants.py runs in the
// place of strake-fluid. STRAKE_CONSTANT="NAME FACTOR" says which; without it nothing changes. Exit 2: no
// such number.
#include "fluid/least_squares/constants.hpp"

#include <cstdlib>
#include <iostream>
#include <map>
#include <sstream>
#include <string>

namespace {

using strake::fluid::LeastSquaresConstants;

const std::map<std::string, double LeastSquaresConstants::*> numbers{
    {"first_row", &LeastSquaresConstants::first_row},
    {"least_ratio", &LeastSquaresConstants::least_ratio},
    {"even_2d", &LeastSquaresConstants::even_2d},
    {"even_3d", &LeastSquaresConstants::even_3d},
    {"singular", &LeastSquaresConstants::singular},
    {"smallest", &LeastSquaresConstants::smallest},
    {"surface_begins", &LeastSquaresConstants::surface_begins},
    {"surface_counts", &LeastSquaresConstants::surface_counts},
    {"least_depth", &LeastSquaresConstants::least_depth},
    {"largest_depth", &LeastSquaresConstants::largest_depth},
    {"edge", &LeastSquaresConstants::edge},
    {"shown_depth", &LeastSquaresConstants::shown_depth},
    {"inner_depth", &LeastSquaresConstants::inner_depth},
    {"gap", &LeastSquaresConstants::gap},
    {"face_reach", &LeastSquaresConstants::face_reach},
    {"own_height", &LeastSquaresConstants::own_height},
    {"own_side", &LeastSquaresConstants::own_side},
    {"own_fades", &LeastSquaresConstants::own_fades},
    {"at_end", &LeastSquaresConstants::at_end},
    {"at_keel", &LeastSquaresConstants::at_keel},
    {"past_end", &LeastSquaresConstants::past_end},
    {"stopped", &LeastSquaresConstants::stopped},
    {"under_face", &LeastSquaresConstants::under_face},
    {"goes_on", &LeastSquaresConstants::goes_on},
    {"one_sided", &LeastSquaresConstants::one_sided},
    {"steepest", &LeastSquaresConstants::steepest},
    {"stopped_height", &LeastSquaresConstants::stopped_height},
    {"least_stopping", &LeastSquaresConstants::least_stopping},
    {"body_counts", &LeastSquaresConstants::body_counts},
    {"alike", &LeastSquaresConstants::alike},
    {"one_plane", &LeastSquaresConstants::one_plane},
    {"no_tension_to", &LeastSquaresConstants::no_tension_to},
    {"no_tension_beside", &LeastSquaresConstants::no_tension_beside},
    {"tension_from", &LeastSquaresConstants::tension_from},
    {"largest_tension", &LeastSquaresConstants::largest_tension},
    {"lack", &LeastSquaresConstants::lack},
    {"film_begins", &LeastSquaresConstants::film_begins},
    {"film_counts", &LeastSquaresConstants::film_counts},
    {"memory_rate", &LeastSquaresConstants::memory_rate},
    {"filter_bound", &LeastSquaresConstants::filter_bound},
    {"filter_floor", &LeastSquaresConstants::filter_floor},
    {"longest_shift", &LeastSquaresConstants::longest_shift},
    {"soft_stiffness", &LeastSquaresConstants::soft_stiffness},
};
static_assert(sizeof(LeastSquaresConstants) == 43 * sizeof(double), "a number is missing in the list above");

const bool changed = [] {
  const char* asked = std::getenv("STRAKE_CONSTANT");
  if (asked == nullptr) return false;
  std::istringstream words{asked};
  std::string name;
  double factor = 0;
  const auto known = words >> name >> factor ? numbers.find(name) : numbers.end();
  if (known == numbers.end()) {
    std::cerr << "STRAKE_CONSTANT=\"" << asked
              << "\": expected a name of fluid/least_squares/constants.hpp and a factor\n";
    std::exit(2);
  }
  strake::fluid::least_squares_constants().*known->second *= factor;
  return true;
}();

}  // namespace
