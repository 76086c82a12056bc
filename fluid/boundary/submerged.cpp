#include "fluid/boundary/submerged.hpp"

#include "fluid/boundary/boundary.hpp"
#include "fluid/boundary/fill.hpp"

#include <vector>

namespace strake::fluid {

namespace {

/// Water nearer to a face than this would be pushed off it at once [l0]; on a lattice it stands at 0.5.
constexpr double least_distance = 0.25;

template <int dim>
void take_out(State<dim>& state, const std::vector<Eigen::Index>& kept) {
  State<dim> rest = state;
  const auto n = static_cast<Eigen::Index>(kept.size());
  rest.position = state.position(Eigen::all, kept).eval();
  rest.velocity = state.velocity(Eigen::all, kept).eval();
  rest.pressure = state.pressure(kept).eval();
  rest.sps_k = state.sps_k(kept).eval();
  rest.residual_divergence = state.residual_divergence(kept).eval();
  rest.residual_approach = state.residual_approach(Eigen::all, kept).eval();
  rest.kind.clear();
  rest.surface.clear();
  rest.aired.clear();
  rest.id.clear();
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(kept[static_cast<std::size_t>(k)]);
    rest.kind.push_back(state.kind[i]);
    rest.surface.push_back(state.surface[i]);
    rest.aired.push_back(state.aired[i]);
    rest.id.push_back(k);
  }
  state = std::move(rest);
}

}  // namespace

template <int dim>
State<dim> fill_around(const Parameters& p, const InterfaceMesh& body) {
  State<dim> state = fill<dim>(p);
  if (!p.submerged || body.position.cols() == 0 || p.interface == "volume") return state;
  BodySurface<dim> surface;
  if constexpr (dim == 2)
    surface = Outline(body, p.spacing);
  else
    surface = Hull(body, p.spacing, p.spacing);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < state.position.cols(); ++i) {
    const Vector<dim> x = state.position.col(i);
    if (state.kind[static_cast<std::size_t>(i)] == Kind::fluid &&
        (surface.inside(x) || surface.nearest(x).distance < least_distance * p.spacing))
      continue;
    kept.push_back(i);
  }
  take_out<dim>(state, kept);
  return state;
}

template State<2> fill_around<2>(const Parameters&, const InterfaceMesh&);
template State<3> fill_around<3>(const Parameters&, const InterfaceMesh&);

}  // namespace strake::fluid
