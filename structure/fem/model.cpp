#include "proto/error.hpp"
#include "structure/body/surface.hpp"
#include "structure/fem/element/assembly.hpp"
#include "structure/fem/fem.hpp"
#include "structure/fem/mesh/point_interpolation.hpp"
#include "structure/fem/mesh/refinement.hpp"

#include <algorithm>

namespace strake::structure::fem {
namespace {

template <int dim>
deck::Weights weights(const Discretisation<dim>& discretisation, const Points& at) {
  constexpr double round_off = 1e-12;  // of a weight that is 0
  return PointInterpolation<dim>(discretisation, at).weights().pruned(1.0, round_off);
}

/// Refuses motions that a deck cannot describe. A deck describes the body in the frame of supports at a
/// constant velocity, at rest at the start.
void require_plain_motion(const Parameters& p) {
  const auto refuse = [](const std::string& key, const std::string& what) {
    throw Error(ExitCode::case_file, "structure." + key, "a deck cannot say " + what,
                "compare with structure.solver = \"particle\", or leave structure." + key + " out");
  };
  if (p.motion) refuse("motion", "that its supports move by a table");
  if (p.free.translates() && has_supports(elastic_solid(p))) refuse("free", "that its supports are free");
  const bool parts = std::any_of(p.initial.of_part.begin(), p.initial.of_part.end(),
                                 [](const Eigen::Vector3d& v) { return !v.isZero(); });
  if (!p.initial.value.isZero() || p.initial.profile || parts)
    refuse("initial_velocity", "that the body moves against its supports at the start");
}

template <int dim>
deck::Model model_of(const Parameters& p, const std::vector<ProbeKeys>& probes) {
  require_plain_motion(p);
  const Solid solid = elastic_solid(p);
  const Discretisation<dim> discretisation(solid, p.fem.degree, p.fem.refinement, size_along(p.fem, solid));
  const Mesh<dim>& mesh = discretisation.mesh();
  require_free(mesh);
  if (p.analysis == Analysis::statics) require_constrained(mesh);

  deck::Model m;
  m.dimension = dim;
  m.degree = mesh.degree;
  m.node = Points::Zero(3, mesh.n_nodes());
  m.node.topRows<dim>() = mesh.node;
  m.cell = mesh.cell;
  m.part = mesh.part;
  m.parts = solid.parts;
  m.fixed = mesh.fixed;

  m.interface_position = surface(p).position;
  m.interface = weights(discretisation, m.interface_position);
  m.probe_at.resize(3, 0);
  for (const ProbeKeys& probe : probes) {
    // Other programs print displacements.
    if (probe.of != "structure" || probe.quantity == "stress" || probe.quantity == "von_mises") continue;
    m.probe.push_back(probe.name);
    m.probe_at.conservativeResize(3, m.probe_at.cols() + 1);
    m.probe_at.rightCols<1>() = probe.at;
  }
  m.probe_weights = weights(discretisation, m.probe_at);

  m.analysis = p.analysis;
  m.support_velocity = p.velocity;
  m.gravity = p.gravity;
  m.gravity_ramp = p.gravity_ramp;
  m.damping = p.damping;
  m.own_load_ramp = p.load.ramp;
  m.own_load = discretisation.case_force(p.load);
  const Eigen::VectorXd mass =
      Assembly<dim>(mesh, solid.parts).mass() * Eigen::VectorXd::Ones(mesh.n_unknowns());
  m.node_mass = mass(Eigen::seqN(0, mesh.n_nodes(), dim));
  return deck::with_edge_nodes(std::move(m));
}

}  // namespace

deck::Model model(const Parameters& p, const std::vector<ProbeKeys>& probes) {
  return p.dimension == 3 ? model_of<3>(p, probes) : model_of<2>(p, probes);
}

}  // namespace strake::structure::fem
