#pragma once

#include "proto/files/json_file.hpp"

#include <string>
#include <vector>

namespace strake {

/// How a check of a run turned out.
enum class Grade { good, poor, bad };
std::string name_of(Grade);

/// The bounds of a check, on its size.
struct CheckBounds {
  const char* key;    // in "checks" of summary.json
  const char* words;  // on the console
  double good, poor;  // good up to the first, poor up to the second, bad above
  bool per_particle;  // the value is a count, its bounds are shares of the water's particles
};

/// Grades each check that has bounds: {"momentum_gap": {"grade": "good", "good": 0.02, "poor": 0.1}, …}.
/// Checks that are null have none. particles: of the water.
Json grades_of(const Json& checks, double particles);

/// The last lines of a console on them, worst first: "bad     speed of the water 1.1 of its bound (to 1)".
std::vector<std::string> grade_lines(const Json& checks);

}  // namespace strake
