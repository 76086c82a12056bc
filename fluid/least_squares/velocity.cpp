#include "fluid/least_squares/scheme.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

// Computes ∇u* of the water, and the filter of the velocity that ∇u* does not explain.

namespace strake::fluid {

namespace {

/// |a|², |b|², |c|², |d|².
template <int dim>
inline Double4 squares(VecD<dim> a, VecD<dim> b, VecD<dim> c, VecD<dim> d) {
  a *= a;
  b *= b;
  c *= c;
  d *= d;
  if constexpr (dim == 2) {
    const Double2 low = __builtin_shufflevector(a, b, 0, 2) + __builtin_shufflevector(a, b, 1, 3);
    const Double2 high = __builtin_shufflevector(c, d, 0, 2) + __builtin_shufflevector(c, d, 1, 3);
    return __builtin_shufflevector(low, high, 0, 1, 2, 3);
  } else {
    return Double4{a[0] + a[1] + a[2], b[0] + b[1] + b[2], c[0] + c[1] + c[2], d[0] + d[1] + d[2]};
  }
}

}  // namespace

// Computes ∇u = Σ w (u_j − u_i) ⊗ r/r² [Σ w r⊗r/r²]⁻¹, for films beside oblique faces that of (F86).
template <int dim>
template <bool seams>
void LeastSquaresScheme<dim>::find_velocity_gradient(const Boundary<dim>& boundary, const State<dim>& state,
                                                     const Neighbours& near) {
  const auto& periodic = boundary.tank().periodic();
  const double *const places = state.position.data(), *const velocities = state.velocity.data();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    const auto x = vec_at<dim>(places + dim * i), u = vec_at<dim>(velocities + dim * i);
    if (!ranks_.owns(i)) {  // ∇u comes from the owner
      velocity_.motion[static_cast<std::size_t>(i)] = {.place = x, .velocity = u, .gradient = {}};
      continue;
    }
    const bool is_wide = oblique_ && film_.share[i] > 0;  // ∇u comes from the wide pairs alone
    VecD<dim> sum[dim]{};
    [[maybe_unused]] Double4 all{};  // in the plane all products at once
    for (std::size_t e = 0, inner = is_wide ? 0 : water_pairs(columns, boundary.water()); e < inner; ++e) {
      const std::int64_t j = columns[e];
      const double inverse = inverses[e], w = (gradient_.radius * inverse - 1) * inverse * inverse;
      auto r = vec_at<dim>(places + dim * j) - x;
      if constexpr (seams) over_seams<dim>(periodic, r);
      const auto du = vec_at<dim>(velocities + dim * j) - u;
      if constexpr (dim == 2) {
        all += __builtin_shufflevector(du, du, 0, 1, 0, 1) * (w * __builtin_shufflevector(r, r, 0, 0, 1, 1));
      } else {
        r *= w;
        for (int b = 0; b < dim; ++b) sum[b] += du * r[b];
      }
    }
    if constexpr (dim == 2) {
      sum[0] = __builtin_shufflevector(all, all, 0, 1);
      sum[1] = __builtin_shufflevector(all, all, 2, 3);
    }
    const auto k = static_cast<std::size_t>(i);
    const Tensor<dim>& inverse = moments_.b_inverse[k];
    Motion& motion = velocity_.motion[k];
    motion.place = x;
    motion.velocity = u;
    for (int b = 0; b < dim; ++b) {
      motion.gradient[b] = sum[0] * inverse(0, b);
      for (int a = 1; a < dim; ++a) motion.gradient[b] += sum[a] * inverse(a, b);
    }
    if (is_wide) {
      const Tensor<dim> wide = film_.wide_gradient(state.velocity, i, [&](std::int64_t j) {
        return periodic.separation(state.position.col(i), state.position.col(j));
      });
      for (int b = 0; b < dim; ++b) motion.gradient[b] = vec_at<dim>(wide.col(b).data());
    }
    if (velocity_.age > 0) advance_gradient(motion, velocity_.age);
  }
}

// Computes ∇u(τ) = ∇u − τ ∇u·∇u (F53). This is the gradient at the particles after the time τ if u moved with
// them unchanged.
template <int dim>
void LeastSquaresScheme<dim>::advance_gradient(Motion& motion, double time) const {
  VecD<dim> turned[dim];
  for (int b = 0; b < dim; ++b) {
    turned[b] = motion.gradient[0] * motion.gradient[b][0];
    for (int a = 1; a < dim; ++a) turned[b] += motion.gradient[a] * motion.gradient[b][a];
  }
  for (int b = 0; b < dim; ++b) motion.gradient[b] -= time * turned[b];
}

// Adds Δu_i of the filter (F48) to the velocity:
//   Δu_i = Δt (2d/(n0 λ)) Σ_j β l0 |δ_ij| δ_ij w, δ_ij = u_j − u_i − ½ (∇u_i + ∇u_j) r_ij.
// It is antisymmetric, so momentum is exact. |δ| is bounded where the explicit step would overshoot, and it
// counts as at least filter_floor √(g l0): what is left of waves shorter than some spacings fades.
template <int dim>
template <bool seams>
void LeastSquaresScheme<dim>::find_filter(const Boundary<dim>& boundary, State<dim>& state,
                                          const Neighbours& near, double dt,
                                          const AcousticSubstepping& substepping) {
  const auto& periodic = boundary.tank().periodic();
  const double rate = 2.0 * dim / (gradient_.n0 * gradient_.lambda0) * p_.scheme.filter * p_.spacing;
  const double factor = rate * dt;
  const double bound = least_squares_constants().filter_bound / (rate * substepping.length() * gradient_.n0);
  const double least =
      std::min(bound, least_squares_constants().filter_floor * std::sqrt(p_.gravity.norm() * p_.spacing));
  const bool single = substepping.is_single();
  if (!single) velocity_.filtered.resize(dim, boundary.water());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    if (!ranks_.owns(i)) continue;
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    const Motion own = velocity_.motion[static_cast<std::size_t>(i)];
    const auto jump_of = [&](std::int32_t j) {
      const Motion& other = velocity_.motion[static_cast<std::size_t>(j)];
      auto r = other.place - own.place;
      if constexpr (seams) over_seams<dim>(periodic, r);
      auto jump = other.velocity - own.velocity;
      for (int b = 0; b < dim; ++b) jump -= (own.gradient[b] + other.gradient[b]) * (0.5 * r[b]);
      return jump;
    };
    VecD<dim> sum{};
    const std::size_t inner = water_pairs(columns, boundary.water());
    std::size_t e = 0;
    for (; e + 4 <= inner; e += 4) {  // four roots take as long as one
      const VecD<dim> a = jump_of(columns[e]), b = jump_of(columns[e + 1]), c = jump_of(columns[e + 2]),
                      d = jump_of(columns[e + 3]);
      const Double4 size = simd::root(squares<dim>(a, b, c, d)), most = bound - Double4{},
                    floor = least - Double4{};
      const Double4 inverse{inverses[e], inverses[e + 1], inverses[e + 2], inverses[e + 3]};
      const Double4 limited = size < most ? size : most;
      const Double4 weight = (gradient_.radius * inverse - 1.0) * (limited > floor ? limited : floor);
      sum += a * weight[0];
      sum += b * weight[1];
      sum += c * weight[2];
      sum += d * weight[3];
    }
    for (; e < inner; ++e) {
      const VecD<dim> jump = jump_of(columns[e]);
      const double size = std::sqrt(squares<dim>(jump, jump, jump, jump)[0]);
      sum += jump * ((gradient_.radius * inverses[e] - 1) * std::clamp(size, least, bound));
    }
    for (int d = 0; d < dim; ++d) state.velocity(d, i) += factor * sum[d];
    if (!single)
      for (int d = 0; d < dim; ++d) velocity_.filtered(d, i) = rate * sum[d];
  }
}

template <int dim>
void LeastSquaresScheme<dim>::fit_velocity(const Boundary<dim>& boundary, const State<dim>& state,
                                           const Neighbours& near) {
  velocity_.motion = velocity_.memory.template of<Motion>(static_cast<std::size_t>(boundary.water()));
  if (boundary.tank().periodic().any())
    find_velocity_gradient<true>(boundary, state, near);
  else
    find_velocity_gradient<false>(boundary, state, near);
  constexpr std::size_t each = dim * dim * sizeof(double);
  const auto read = [this](std::int32_t i, std::byte* to) {
    for (const VecD<dim>& column : velocity_.motion[static_cast<std::size_t>(i)].gradient) {
      std::memcpy(to, &column, dim * sizeof(double));
      to += dim * sizeof(double);
    }
  };
  const auto write = [this](std::int32_t i, const std::byte* from) {
    for (VecD<dim>& column : velocity_.motion[static_cast<std::size_t>(i)].gradient) {
      column = VecD<dim>{};
      std::memcpy(&column, from, dim * sizeof(double));
      from += dim * sizeof(double);
    }
  };
  // The mean velocity over a body's face reads the second ring, all else the first one.
  if (boundary.first_of_bodies() < state.position.cols())
    ranks_.update(each, read, write);
  else
    ranks_.update(each, read, write, Rings::first);
}

template <int dim>
void LeastSquaresScheme<dim>::filter(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& near,
                                     double dt, const AcousticSubstepping& substepping) {
  const bool seams = boundary.tank().periodic().any();
  const double since = substepping.age() - velocity_.age;
  velocity_.age = substepping.age();
  if (!substepping.begins()) {
    // The change of ∇u* by stresses and filter within the group is left out; it shows in the residual.
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < boundary.water(); ++i) {
      advance_gradient(velocity_.motion[static_cast<std::size_t>(i)], since);
      if (p_.scheme.filter > 0 && ranks_.owns(i)) state.velocity.col(i) += dt * velocity_.filtered.col(i);
    }
    ranks_.update(state.velocity);
    return;
  }
  if (!substepping.is_single()) equation_.pressure_at_start = state.pressure.head(boundary.water());
  fit_velocity(boundary, state, near);
  if (p_.scheme.filter <= 0) return;
  if (seams)
    find_filter<true>(boundary, state, near, dt, substepping);
  else
    find_filter<false>(boundary, state, near, dt, substepping);
  ranks_.update(state.velocity);
}

#define STRAKE_INSTANTIATE(dim)                                                                       \
  template void LeastSquaresScheme<dim>::fit_velocity(const Boundary<dim>&, const State<dim>&,        \
                                                      const Neighbours&);                             \
  template void LeastSquaresScheme<dim>::filter(const Boundary<dim>&, State<dim>&, const Neighbours&, \
                                                double, const AcousticSubstepping&);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
