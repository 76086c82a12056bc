#pragma once

#include <cmath>
#include <vector>

/// Flow through a straight elastic tube, one-dimensional. 100 cells over 10 m, unit density, wall stiffness
/// 1e4, radius 1/√π, steps of 0.01 s by the implicit Euler rule. Area a [m²], velocity u [m/s] and pressure p
/// [Pa] at the nodes.
namespace tube {

using Values = std::vector<double>;
constexpr int cells = 100, nodes = cells + 1;
constexpr double dx = 0.1, pi = 3.14159265358979323846;
/// c² = E/(2 r0)
inline double squared_speed() {
  return 1e4 * std::sqrt(pi) / 2;
}

/// a = (2c²)²/(p − 2c²)²
inline double area(double pressure) {
  const double limit = 2 * squared_speed();
  return limit * limit / ((pressure - limit) * (pressure - limit));
}

/// Points on the tube's axis: x, 0, 0 of each.
inline Values positions() {
  Values x(3 * nodes, 0.0);
  for (int i = 0; i < nodes; ++i) x[static_cast<std::size_t>(3 * i)] = i * dx;
  return x;
}

inline Values positions_backwards() {
  Values x = positions();
  for (int i = 0; i < nodes; ++i) x[static_cast<std::size_t>(3 * i)] = (nodes - 1 - i) * dx;
  return x;
}

}  // namespace tube
