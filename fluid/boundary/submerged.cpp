#include "fluid/boundary/submerged.hpp"

#include "fluid/boundary/boundary.hpp"
#include "fluid/boundary/fill.hpp"
#include "fluid/particles/columns.hpp"

#include <numeric>
#include <vector>

namespace strake::fluid {

namespace {

/// Smallest distance of water to a face at the start [l0]. Nearer water would be pushed off the face at once.
/// On a lattice the first layer has the distance 0.5.
constexpr double least_distance = 0.25;

}  // namespace

template <int dim>
State<dim> fill_around(const Parameters& p, const InterfaceMesh& body) {
  State<dim> state = fill<dim>(p);
  if (!p.submerged || body.position.cols() == 0 || p.interface == "volume") return state;
  BodySurface<dim> surface;
  if constexpr (dim == 2)
    surface = BodySurface2d(body, p.spacing);
  else
    surface = BodySurface3d(body, p.spacing, p.spacing);
  std::vector<std::int32_t> kept;
  for (Eigen::Index i = 0; i < state.position.cols(); ++i) {
    const Vector<dim> x = state.position.col(i);
    if (state.kind[static_cast<std::size_t>(i)] == Kind::fluid &&
        (surface.inside(x) || surface.nearest(x).distance < least_distance * p.spacing))
      continue;
    kept.push_back(static_cast<std::int32_t>(i));
  }
  select_particles<dim>(state, kept);
  std::iota(state.id.begin(), state.id.end(), 0);
  return state;
}

template State<2> fill_around<2>(const Parameters&, const InterfaceMesh&);
template State<3> fill_around<3>(const Parameters&, const InterfaceMesh&);

}  // namespace strake::fluid
