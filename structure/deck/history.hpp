#pragma once

#include "proto/interface.hpp"
#include "structure/deck/model.hpp"

#include <Eigen/Core>

#include <vector>

namespace strake::structure::deck {

/// Forces on a model's unknowns over time, in the form that other programs read. They interpolate linearly
/// between the values, and evaluate a load at the end of each of their steps.
struct LoadHistory {
  std::vector<double> time;     // [s] from 0: ends of windows, n + 1
  std::vector<int> unknown;     // those that are loaded at all and free, ascending
  Eigen::MatrixXd value;        // unknowns × (n + 1) [N]
  std::vector<double> gravity;  // n + 1, factor of Model::gravity
  double largest = 0;           // [N] of all values
  double end() const { return time.back(); }
};

/// Consecutive windows of equal length of a run.
struct Stretch {
  std::size_t windows = 0;
  double dt = 0;   // [s] of each
  double end = 0;  // [s]
};
std::vector<Stretch> stretches(const LoadHistory&);

/// Converts the recorded mean forces f_w on the interface in each window. Our finite elements apply f_w at
/// mid-window. A program that evaluates loads at window ends t_k gets there the mean of the two windows that
/// meet,
///   g_k = (f_(k−1) dt_(k−1) + f_k dt_k) / (dt_(k−1) + dt_k),  g_0 = f_0,  g_n = f_(n−1),
/// whose trapezoidal sum Σ ½ (g_k + g_(k+1)) dt_k is the recorded impulse Σ f_k dt_k. A harmonic load is
/// weakened by cos²(ω dt/2). [structure.load] and gravity are added as they are at window ends.
LoadHistory nodal_history(const Model&, const std::vector<Window>&, const std::vector<Points>& force);

}  // namespace strake::structure::deck
