#include "coupler/new_case/case_size.hpp"

#include "coupler/new_case/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake {
namespace {

constexpr double wall_rows = 4;  // of particles in walls and floor, as fluid.scheme has them by default
// Particles of a case in space, at most: some two minutes of two cores up to the time that is written.
constexpr double most_particles = 100'000;

}  // namespace

// Volumes over l0^d. The tank's walls and floor are boxes less what they enclose; above it is open.
double particles_of(const NewScene& s) {
  const double l0 = s.spacing, thick = 2 * wall_rows;
  const double nx = (s.right - s.left) / l0, ny = (s.top - s.bottom) / l0;
  const double wet = (s.water_right - s.left) / l0 * (s.surface - s.bottom) / l0;
  if (s.dimension == 2) return wet + (nx + thick) * (ny + wall_rows) - nx * ny;
  const double nz = (s.front - s.back) / l0;
  return wet * nz + (nx + thick) * (ny + wall_rows) * (nz + thick) - nx * ny * nz;
}

double spacing_in_space(const NewScene& scene) {
  NewScene s = scene;
  double coarse = std::max({s.right - s.left, s.front - s.back, s.top - s.bottom}), fine = 1e-4 * coarse;
  constexpr int halvings = 60;
  for (int k = 0; k < halvings; ++k) {
    s.spacing = 0.5 * (fine + coarse);
    (particles_of(s) > most_particles ? fine : coarse) = s.spacing;
  }
  return two_digits(coarse);
}

// The number of steps grows as the spacing shrinks, so half of it costs two times the particles' part.
std::string cost_of_half(const NewScene& s) {
  NewScene half = s;
  half.spacing = 0.5 * s.spacing;
  const double more = particles_of(half) / particles_of(s);
  return fmt::format("{:.2g} times the particles, {:.2g} times the time", more, 2 * more);
}

}  // namespace strake
