#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/simulation/simulation.hpp"

#include <array>
#include <limits>

namespace strake::fluid {

/// A rectangle as a closed outline, counter-clockwise from its lower left corner.
inline InterfaceMesh rectangle(double left, double low, double width, double height, double spacing) {
  const int along = std::max(1, static_cast<int>(std::lround(width / spacing)));
  const int up = std::max(1, static_cast<int>(std::lround(height / spacing)));
  InterfaceMesh mesh;
  mesh.name = "structure";
  mesh.dimension = 2;
  const int n = 2 * (along + up);
  mesh.position = Points::Zero(3, n);
  mesh.faces.resize(2, n);
  int at = 0;
  const auto edge = [&](Eigen::Vector2d from, Eigen::Vector2d to, int parts) {
    for (int k = 0; k < parts; ++k, ++at)
      mesh.position.col(at).head<2>() = from + static_cast<double>(k) / parts * (to - from);
  };
  const Eigen::Vector2d a(left, low), b(left + width, low), c(left + width, low + height),
      d(left, low + height);
  edge(a, b, along);
  edge(b, c, up);
  edge(c, d, along);
  edge(d, a, up);
  for (int k = 0; k < n; ++k) mesh.faces.col(k) << k, (k + 1) % n;
  return mesh;
}

/// Still water of width × depth, its surface at y = 0, in a tank with `above` of free wall.
inline Parameters tank_case(double width, double depth, double spacing, double above = 0.1) {
  Parameters p;
  p.spacing = spacing;
  p.tank.min = {-0.5 * width, -depth, 0};
  p.tank.max = {0.5 * width, above, 0};
  p.water.min = p.tank.min;
  p.water.max = {0.5 * width, 0, 0};
  p.threads = 1;
  return p;
}

/// The rigid plate of the paper, 0.4 × 0.02 m, over its tank of 2.0 × 0.5 m of water. gap: from face to
/// surface [m].
struct PlateEntry {
  static constexpr double half_width = 0.2, density = 1000;
  double speed = 6.26, gap = 0;
  Simulation<2> simulation;
  InterfaceMotion motion;
  double time = 0;

  PlateEntry(const Parameters& p, double speed_, double gap_)
      : speed(speed_),
        gap(gap_),
        simulation(p, plate(gap_, p.spacing), down(plate(gap_, p.spacing), speed_)) {
    const auto m = simulation.interface().position.cols();
    motion.displacement = motion.acceleration = Points::Zero(3, m);
    motion.velocity = Points::Zero(3, m);
    motion.velocity.row(1).setConstant(-speed);
  }
  static Parameters parameters(double spacing = 0.01) { return tank_case(2.0, 0.5, spacing, 0.5); }
  static InterfaceMesh plate(double gap, double spacing) { return rectangle(-0.2, gap, 0.4, 0.02, spacing); }
  static Points down(const InterfaceMesh& mesh, double speed) {
    Points velocity = Points::Zero(3, mesh.position.cols());
    velocity.row(1).setConstant(-speed);
    return velocity;
  }
  StepReport step(double dt, double rest = 0) {
    time += dt;
    motion.displacement.row(1).setConstant(-speed * time);
    return simulation.step(dt, motion, rest);
  }
  double centre_pressure() const { return simulation.sensor_pressure({0, gap, 0}, 2 * 0.01); }
};

}  // namespace strake::fluid
