#pragma once

#include "structure/fem/solver.hpp"

#include <cmath>
#include <string>
#include <vector>

/// Bodies on which finite elements lock where nothing cures them.
namespace strake::structure::fem {

struct Kind {
  int degree;
  StrainField strain;
};
inline constexpr Kind q1_plain{1, StrainField::compatible}, q1_cured{1, StrainField::enhanced},
    q2_plain{2, StrainField::compatible}, q2_cured{2, StrainField::enhanced};

/// Cook's tapered panel (Cook 1974): corners (0, 0), (48, 44), (48, 60), (0, 44), clamped on the left. A
/// shear force of `force` per depth is spread over the right; n × n cells.
inline Parameters cooks_panel(int n, const Material& material, Kind kind, double force = 1) {
  Parameters p;
  p.shape.kind = ShapeKind::solid;
  Solid& solid = p.solid;
  solid.node = Points::Zero(3, (n + 1) * (n + 1));
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double s = static_cast<double>(i) / n, t = static_cast<double>(j) / n;
      solid.node.col(j * (n + 1) + i) << 48 * s, 44 * s + t * (44 - 28 * s), 0;
    }
  solid.cell.resize(4, n * n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      solid.cell.col(j * n + i) << a, a + 1, a + n + 1, a + n + 2;
      solid.part_of.push_back(0);
    }
  solid.parts = {{"panel", material, false}};
  find_facets(solid);
  solid.supported = {{"left", Support::clamped, facets_named(solid, "left")}};
  p.shape.corner = outer_polygons(solid).front();
  p.surface_spacing = 8;
  p.load = {.kind = LoadKind::traction, .value = {0, force / 16, 0}, .face = "right", .at = {}, .ramp = 0};
  p.fem.degree = kind.degree;
  p.fem.strain = kind.strain;
  return p;
}

/// Rise of the middle of its right side.
inline double cooks_rise(int n, const Material& material, Kind kind, double force = 1) {
  FemSolver<2> solver(cooks_panel(n, material, kind, force));
  solver.solve_static();
  return solver.displacement_at({48, 52, 0}).y();
}

/// Mid deflection [m] of the clamped strip under 1e5 Pa, or of the cantilever's tip (cases/VALIDATION.md,
/// "Strips: deflection and frequencies").
inline double strip_deflection(Kind kind, int refinement, bool cantilever) {
  Parameters p;
  p.plate = {.length = 0.4,
             .thickness = 0.02,
             .bottom = {0, 0, 0},
             .left = Support::clamped,
             .right = cantilever ? Support::free : Support::clamped};
  p.material.model = MaterialModel::linear;
  p.load = {.kind = LoadKind::traction, .value = {0, -1e5, 0}, .face = "top", .at = {}, .ramp = 0};
  p.fem.degree = kind.degree;
  p.fem.strain = kind.strain;
  p.fem.refinement = refinement;
  FemSolver<2> solver(p);
  solver.solve_static();
  return -solver.displacement_at({cantilever ? 0.2 : 0.0, 0.01, 0}).y();
}

/// A bar of three dimensions, `length` × 1 × 1, clamped at x = 0 and sheared down at its end. It has n cells
/// through it, distorted inside so that no two are alike. Deflection of the end's middle over that of
/// Timoshenko's beam F L³/(3EI) + 6 F L/(5 G A).
inline double bar_over_beam(double length, int n, const Material& material, Kind kind, double distortion = 0,
                            double mean_strain = 1e-4) {
  const int along = static_cast<int>(length) * n;
  Parameters p;
  p.dimension = 3;
  p.shape.kind = ShapeKind::solid;
  Solid& solid = p.solid;
  solid.dimension = 3;
  const int row = along + 1, layer = row * (n + 1);
  solid.node = Points::Zero(3, layer * (n + 1));
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= along; ++i) {
        const bool inside = i > 0 && i < along && j > 0 && j < n && k > 0 && k < n;
        const double shift = inside ? distortion * ((i + 2 * j + 3 * k) % 3 - 1) / n : 0;
        solid.node.col(k * layer + j * row + i) << length * i / along + shift,
            static_cast<double>(j) / n - shift, static_cast<double>(k) / n + 0.5 * shift;
      }
  solid.cell.resize(8, along * n * n);
  Eigen::Index c = 0;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < along; ++i) {
        const int a = k * layer + j * row + i;
        solid.cell.col(c++) << a, a + 1, a + row, a + row + 1, a + layer, a + layer + 1, a + layer + row,
            a + layer + row + 1;
        solid.part_of.push_back(0);
      }
  solid.parts = {{"bar", material, false}};
  find_facets(solid);
  solid.supported = {{"root", Support::clamped, facets_named(solid, "left")}};
  const double I = 1.0 / 12, G = material.young / (2 * (1 + material.poisson));
  const double per_force = length * length * length / (3 * material.young * I) + 1.2 * length / G;
  const double force = mean_strain * length / per_force;
  p.load = {.kind = LoadKind::traction, .value = {0, -force, 0}, .face = "right", .at = {}, .ramp = 0};
  p.surface_spacing = 1;
  p.fem.degree = kind.degree;
  p.fem.strain = kind.strain;
  FemSolver<3> solver(p);
  solver.solve_static();
  return -solver.displacement_at({length, 0.5, 0.5}).y() / (force * per_force);
}

}  // namespace strake::structure::fem
