#pragma once

#include "fluid/case/read_parameters.hpp"
#include "fluid/participant.hpp"
#include "proto/case/case_file.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace strake::fluid {

inline constexpr double speed = 2.0;    // [m/s] of the plate, downward
inline constexpr double window = 2e-5;  // [s]

inline std::string small_tank(const std::string& probe_at) {
  return R"(
end_time = 0.01
[fluid]
spacing = 0.01
tank = [[-0.15, -0.1], [0.15, 0.1]]
water = [[-0.15, -0.1], [0.15, 0.0]]
[fluid.scheme]
time_step = 1e-5
[coupling.surface]
window = 2e-5
[[output.probe]]
name = "p"
of = "fluid"
at = )" + probe_at +
         "\n";
}

struct Case {
  CommonKeys common;
  Parameters parameters;
  explicit Case(const std::vector<std::string>& sets = {}, const std::string& probe_at = "[0.0, 0.002]") {
    CaseFile file = CaseFile::parse(small_tank(probe_at), "case.toml", sets);
    common = read_common(file);
    parameters = read(file, common);
  }
};

/// BodySurface2d of a plate 0.1 × 0.02 m whose lower face is 2 mm above the water, counter-clockwise.
inline InterfaceMesh plate() {
  constexpr int along = 10, across = 2;
  InterfaceMesh mesh{.name = "structure", .dimension = 2, .position = {}, .faces = {}, .mass = {}};
  const int n = 2 * (along + across);
  mesh.position = Points::Zero(3, n);
  for (int k = 0; k < n; ++k) {
    double x = 0, y = 0;
    if (k < along)
      x = k;
    else if (k < along + across)
      x = along, y = k - along;
    else if (k < 2 * along + across)
      x = 2 * along + across - k, y = across;
    else
      y = n - k;
    mesh.position.col(k) << -0.05 + 0.01 * x, 0.002 + 0.01 * y, 0;
  }
  mesh.faces.resize(2, n);
  for (int k = 0; k < n; ++k) mesh.faces.col(k) << k, (k + 1) % n;
  return mesh;
}

inline Field moving(const std::string& quantity, const Eigen::Vector3d& value) {
  return {quantity, quantity == "velocity" ? "m/s" : "m", false, value.replicate(1, plate().position.cols())};
}

inline Setup entering() {
  Setup setup;
  setup.interface = "surface";
  setup.partner_mesh = plate();
  setup.partner_initial = {moving("displacement", {0, 0, 0}), moving("velocity", {0, -speed, 0})};
  return setup;
}

inline Window nth(int k, double dt = window) {
  return {k * dt, dt};
}
inline Input at_speed(const Window& w, double v = speed) {
  return {{{w.t + w.dt, {moving("displacement", {0, -v * (w.t + w.dt), 0})}}}};
}

/// Everything that is no wall clock.
inline std::map<std::string, double> figures(const Advanced& advanced) {
  auto monitor = advanced.monitor;
  std::erase_if(monitor, [](const auto& item) {
    return item.first.starts_with("seconds.") || item.first.starts_with("memory.") ||
           item.first == "count.steps";
  });
  return monitor;
}

inline void expect_equal_bits(const Advanced& a, const Advanced& b, int k) {
  ASSERT_EQ(a.output.size(), b.output.size());
  for (std::size_t f = 0; f < a.output.size(); ++f) EXPECT_TRUE(a.output[f].value == b.output[f].value) << k;
  EXPECT_EQ(figures(a), figures(b)) << k;
}

inline constexpr int contact_window = 50;  // the gap of 2 mm is closed after 1 ms

// Steps so short that those of a window share their places.
inline const std::vector<std::string> five_steps{"fluid.scheme.time_step=4e-6"};

}  // namespace strake::fluid
