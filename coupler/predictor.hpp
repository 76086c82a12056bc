#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "proto/interface.hpp"

namespace strake {

/// First guess of a window's end displacement and velocity, from what was committed.
enum class Predictor { constant, linear, quadratic };
/// "constant" | "linear" | "quadratic"; throws Error(case_file) otherwise.
Predictor predictor_kind(const std::string&);

/// Interface motion at the end of a committed window, on the structure's mesh.
struct Motion {
  double time = 0;               // [s]
  Eigen::MatrixXd displacement;  // 3×n [m]
  Eigen::MatrixXd velocity;      // 3×n [m/s]; empty: unknown
};

/// The last committed motions, oldest first, at most three.
using MotionHistory = std::vector<Motion>;
void remember(MotionHistory&, Motion);
/// Motion at `time`: the polynomial of the predictor's degree through the last motions; while there are too
/// few, the highest degree they allow; from one motion with a velocity, u + v (t − t_n).
Motion predict(Predictor, const MotionHistory&, double time);

}  // namespace strake
