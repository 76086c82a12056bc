#include "structure/fem/model.hpp"

#include "structure/fem/mesh.hpp"
#include "structure/surface.hpp"

namespace strake::structure::fem {
namespace {

template <int dim>
deck::Weights weights(const Discretisation<dim>& discretisation, const Points& at) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index i = 0; i < at.cols(); ++i)
    for (const auto& [node, weight] : discretisation.shape_values(at.col(i)))
      if (std::abs(weight) > 1e-12)
        entries.emplace_back(static_cast<int>(i), node, weight);  // else round-off of 0
  deck::Weights matrix(at.cols(), discretisation.mesh().n_nodes());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

template <int dim>
deck::Model model_of(const Parameters& p, const std::vector<ProbeKeys>& probes) {
  const Solid solid = elastic_solid(p);
  const Discretisation<dim> discretisation(solid, p.fem.degree, p.fem.refinement);
  const Mesh<dim>& mesh = discretisation.mesh();

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
    if (probe.of != "structure") continue;
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
  m.own_load = Eigen::VectorXd::Zero(mesh.n_unknowns());
  if (p.load.kind == LoadKind::traction) {
    const Eigen::VectorXd area = discretisation.face_sizes(facets_named(solid, p.load.face));
    for (int i = 0; i < mesh.n_nodes(); ++i)
      m.own_load.segment<dim>(dim * i) = area(i) * p.load.value.head<dim>();
  } else if (p.load.kind == LoadKind::point) {
    for (const auto& [node, weight] : discretisation.shape_values(p.load.at))
      m.own_load.segment<dim>(dim * node) += weight * p.load.value.head<dim>();
  }
  return deck::with_edge_nodes(std::move(m));
}

}  // namespace

deck::Model model(const Parameters& p, const std::vector<ProbeKeys>& probes) {
  return p.dimension == 3 ? model_of<3>(p, probes) : model_of<2>(p, probes);
}

}  // namespace strake::structure::fem
