#include "fluid/viscosity/viscous_stage.hpp"

#include <cstddef>
#include <cstring>

// What ranks send one another between the gradient of the velocity and the force of the stress.

namespace strake::fluid {

using std::size_t;

/// Gives the ghosts in the first ring G, k, Pr and the number of neighbours of their owners. The stress
/// follows. Those in the second ring have none.
template <int dim>
void ViscousStage<dim>::update_gradient(const ViscousFlow<dim>& flow, Eigen::VectorXd& k) {
  struct Sent {
    double g[dim * dim], k, production;
    std::int64_t neighbours;
  };
  if (!flow.ranks.several()) return;
  const bool advances = kind_ == Turbulence::k;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < flow.walls.first; ++i) {
    if (flow.ranks.owns(i)) continue;
    neighbours_[static_cast<size_t>(i)] = -1;
    if (kind_ == Turbulence::statics) k[i] = 0;
    viscosity_[static_cast<size_t>(i)] = model_.kinematic_viscosity;
    stress_[static_cast<size_t>(i)] = {};
  }
  flow.ranks.update(
      sizeof(Sent),
      [&](std::int32_t i, std::byte* to) {
        const auto at = static_cast<size_t>(i);
        Sent sent{.g = {}, .k = k[i], .production = production_[i], .neighbours = neighbours_[at]};
        for (int a = 0; a < dim; ++a)
          for (int b = 0; b < dim; ++b) sent.g[dim * a + b] = stress_[at].g(a, b);
        std::memcpy(to, &sent, sizeof sent);
      },
      [&](std::int32_t i, const std::byte* from) {
        Sent sent;
        std::memcpy(&sent, from, sizeof sent);
        Tensor<dim> g;
        for (int a = 0; a < dim; ++a)
          for (int b = 0; b < dim; ++b) g(a, b) = sent.g[dim * a + b];
        neighbours_[static_cast<size_t>(i)] = static_cast<std::int32_t>(sent.neighbours);
        production_[i] = sent.production;
        if (!advances) k[i] = sent.k;
        close(i, g, k[i], sent.production, flow);
      },
      Rings::first);
}

/// The same for sums one by one: ∇u and the number of neighbours.
template <int dim>
void ViscousStage<dim>::update_gradients(const ViscousFlow<dim>& flow, std::span<Tensor<dim>> gradient,
                                         std::span<std::int32_t> neighbours) {
  constexpr std::size_t size = sizeof(Tensor<dim>);
  flow.ranks.update(
      size + sizeof(std::int32_t),
      [&](std::int32_t i, std::byte* to) {
        std::memcpy(to, gradient[static_cast<size_t>(i)].data(), size);
        std::memcpy(to + size, &neighbours[static_cast<size_t>(i)], sizeof(std::int32_t));
      },
      [&](std::int32_t i, const std::byte* from) {
        std::memcpy(gradient[static_cast<size_t>(i)].data(), from, size);
        std::memcpy(&neighbours[static_cast<size_t>(i)], from + size, sizeof(std::int32_t));
      },
      Rings::first);
}

#define STRAKE_INSTANTIATE(dim)                                                                      \
  template void ViscousStage<dim>::update_gradients(const ViscousFlow<dim>&, std::span<Tensor<dim>>, \
                                                    std::span<std::int32_t>);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE
template void ViscousStage<2>::update_gradient(const ViscousFlow<2>&, Eigen::VectorXd&);
template void ViscousStage<3>::update_gradient(const ViscousFlow<3>&, Eigen::VectorXd&);

}  // namespace strake::fluid
