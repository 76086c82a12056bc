#pragma once

#include "structure/particle/solver.hpp"

#include <algorithm>

namespace strake::structure {

/// What a crack through `pulled_bar` has to cross [m].
inline double ligament(int layers) {
  return 0.02 * (layers - 4) / layers;
}

/// A bar 20 mm long and high (E 2 GPa, ρ 1000) between two blocks. They are a hundred times as heavy and
/// stiff, and draw it apart at a speed that hardly changes. Two layers in its middle are notched by two
/// particles on either side. In space all of it is 20 mm deep.
inline Parameters pulled_bar(FailureCriterion criterion, int layers = 8, double poisson = 0.3,
                             int dimension = 2) {
  Parameters p;
  p.dimension = dimension;
  p.kind = "particle";
  p.shape.kind = ShapeKind::solid;
  p.material.young = 2e9;
  p.material.density = 1000;
  p.material.poisson = poisson;
  Material heavy = p.material;
  heavy.young *= 100;
  heavy.density *= 100;
  const double depth = dimension == 3 ? 0.02 : 0;
  const auto box = [depth](const char* name, double x0, double x1, double y0, double y1,
                           const Material& material) {
    SolidBox b;
    b.name = name;
    b.min << x0, y0, 0;
    b.max << x1, y1, depth;
    b.material = material;
    return b;
  };
  const double d = 0.02 / layers;
  p.solid = solid_of_boxes(
      dimension,
      {box("left", -0.02, 0, -0.01, 0.03, heavy), box("near", 0, 0.01 - d, 0, 0.02, p.material),
       box("notch", 0.01 - d, 0.01 + d, 2 * d, 0.02 - 2 * d, p.material),
       box("far", 0.01 + d, 0.02, 0, 0.02, p.material), box("right", 0.02, 0.04, -0.01, 0.03, heavy)});
  if (dimension == 2) p.shape.corner = outer_polygons(p.solid).front();
  p.particle.spacing = d;
  p.surface_spacing = 0.005;
  p.failure.criterion = criterion;
  p.failure.fracture_energy = 100;
  p.failure.strength = 2e6;
  if (criterion == FailureCriterion::bond_strain) {
    p.particle.model = ParticleModel::pair;
    p.particle.rotation = Rotation::dynamic;
    p.failure.strength = 0;
    p.particle.safety = 0.2;  // a snapping bond leaves the shortest waves, whose energy leapfrog gives poorly
  }
  return p;
}

/// The blocks fly apart, each with this speed [m/s], and the bar stretches evenly between them.
template <int dim>
void pull_apart(ParticleSolver<dim>& solver, double speed) {
  Vectors<dim> v = Vectors<dim>::Zero(dim, solver.lattice().size());
  for (Eigen::Index i = 0; i < v.cols(); ++i)
    v(0, i) = speed * std::clamp(100 * solver.lattice().position(0, i) - 1, -1.0, 1.0);
  solver.set_velocity(v);
}

}  // namespace strake::structure
