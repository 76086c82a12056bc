#include "fluid/fitted_scheme.hpp"

#include "fluid/pair_loop.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace strake::fluid {

namespace {

/// Ratio of eigenvalues below which neighbours lie on a line (in a plane): that direction is left out; above
/// twice that it counts in full.
constexpr double least_ratio = 0.1;
/// Where |m| is this part of the second row's the surface begins to count, and where it counts in full.
constexpr double surface_begins = 0.5, surface_counts = 0.9;
/// Depth of the middle of the first row below the surface, and the bounds of what is taken for a depth [l0].
constexpr double first_depth = 0.5, least_depth = 0.4, largest_depth = 2.0;
/// Part of the first row's weights whose lack makes an edge: no flat surface, and no depth below first_depth.
constexpr double edge = 0.25;
/// A particle that lies less deep than this is shown as surface [l0].
constexpr double shown_depth = 1.0;

/// Places of a symmetric tensor's different entries.
template <int dim>
struct Symmetric {
  static constexpr int parts = dim * (dim + 1) / 2;
  static constexpr int row[] = {0, 1, 1, 2, 2, 2}, column[] = {0, 0, 1, 0, 1, 2};
};

template <int dim>
[[gnu::noinline]] void inverse_of_seen_directions(const Tensor<dim>& m, Tensor<dim>& inverse) {
  Eigen::SelfAdjointEigenSolver<Tensor<dim>> eigen;
  eigen.computeDirect(m);
  const double largest = eigen.eigenvalues()[dim - 1];
  Vector<dim> inverses;
  for (int a = 0; a < dim; ++a) {
    const double value = eigen.eigenvalues()[a];
    const double seen = std::clamp((value / largest - least_ratio) / least_ratio, 0.0, 1.0);
    inverses[a] = value > 0 ? seen / value : 0.0;
  }
  inverse.noalias() = eigen.eigenvectors() * inverses.asDiagonal() * eigen.eigenvectors().transpose();
}

/// The sums of the lanes, all at once: numbers written one by one and read as a vector would be waited for.
template <int dim>
inline Vector<dim> vector_of(const Lanes8 (&lanes)[dim]) {
  Vector<dim> out;
  if constexpr (dim == 2) {
    const Lanes2 both{sum(lanes[0]), sum(lanes[1])};
    std::memcpy(out.data(), &both, sizeof both);
  } else {
    for (int d = 0; d < dim; ++d) out[d] = sum(lanes[d]);
  }
  return out;
}

/// |a|², |b|², |c|², |d|².
template <int dim>
inline Lanes4 squares(Column<dim> a, Column<dim> b, Column<dim> c, Column<dim> d) {
  a *= a;
  b *= b;
  c *= c;
  d *= d;
  if constexpr (dim == 2) {
    const Lanes2 low = __builtin_shufflevector(a, b, 0, 2) + __builtin_shufflevector(a, b, 1, 3);
    const Lanes2 high = __builtin_shufflevector(c, d, 0, 2) + __builtin_shufflevector(c, d, 1, 3);
    return __builtin_shufflevector(low, high, 0, 1, 2, 3);
  } else {
    return Lanes4{a[0] + a[1] + a[2], b[0] + b[1] + b[2], c[0] + c[1] + c[2], d[0] + d[1] + d[2]};
  }
}

/// Written to its place number by number: a copy would wait for them.
template <int dim>
inline void inverse_where_seen(const Tensor<dim>& m, Tensor<dim>& inverse) {
  const double mean = m.trace() / dim, determinant = m.determinant();
  // det/mean^d that is reached only where λ_min/λ_max > 2 least_ratio for sure: nothing is left out.
  constexpr double even = dim == 2 ? 0.56 : 0.52;
  if (!(mean > 0)) {
    inverse.setZero();
  } else if (!(determinant > even * mean * mean * (dim == 3 ? mean : 1.0))) {
    inverse_of_seen_directions<dim>(m, inverse);
  } else if constexpr (dim == 2) {
    const double scale = 1 / determinant;
    inverse(0, 0) = scale * m(1, 1);
    inverse(1, 0) = -scale * m(1, 0);
    inverse(0, 1) = -scale * m(0, 1);
    inverse(1, 1) = scale * m(0, 0);
  } else {
    inverse = m.inverse();
  }
}

}  // namespace

template <int dim>
FittedScheme<dim>::FittedScheme(const Parameters& p, const Boundary<dim>& boundary, const State<dim>& state)
    : p_(p),
      gradient_(lattice_constants<dim>(p.scheme.radius_gradient, p.spacing)),
      laplacian_(lattice_constants<dim>(p.scheme.radius_laplacian, p.spacing)),
      lattice_(laplacian_, p.spacing),
      walls_(boundary, state, p.spacing),
      sound_(p.sound_depth, p.spacing) {
  const std::int64_t water = boundary.water();
  constexpr double gap = 0.01;  // that a packed lattice between slopes may leave
  full_ =
      boundary.first_of_bodies() == static_cast<std::int64_t>(state.kind.size()) &&
      static_cast<double>(water) * std::pow(p.spacing, dim) > (1 - gap) * boundary.tank().shape().volume();
  const auto count = static_cast<std::size_t>(water);
  water_.resize(count);
  all_.resize(count);
  motion_ = motions_.of<Motion>(count);
  std::fill(motion_.begin(), motion_.end(), Motion{});
  water_stop_.resize(count);
  for (Vectors<dim>* v : {&moment_, &inward_, &crowding_, &reaction_, &gradient_of_p_})
    v->setZero(dim, water);
  for (Eigen::VectorXd* v : {&stiffness_, &eased_, &soft_, &meant_, &yielding_, &diagonal_, &volume_,
                             &surface_factor_, &surface_pull_, &surface_share_})
    v->setZero(water);
  mean_approach_.setZero(dim, state.position.cols() - water);
  cover_.setZero(state.position.cols() - water);
}

template <int dim>
void FittedScheme<dim>::measure(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& far,
                                const Neighbours& near) {
  walls_.update(boundary, state, near);
  cover_rows(boundary, state, near);
  const std::int64_t water = boundary.water();
  const bool seams = boundary.tank().periodic().any(), shares = shares_entries(far);
  if (!shares) make_room(entry_, far.column().size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (shares)
      seams ? fit<true, true>(boundary, state, far, near, i)
            : fit<false, true>(boundary, state, far, near, i);
    else
      seams ? fit<true, false>(boundary, state, far, near, i)
            : fit<false, false>(boundary, state, far, near, i);
  }
}

template <int dim>
template <bool seams, bool shares>
void FittedScheme<dim>::fit(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& far,
                            const Neighbours& near, std::int64_t i) {
  const auto& periodic = boundary.tank().periodic();
  const std::int64_t water = boundary.water();
  const auto columns = far.row(i);
  const double reach = laplacian_.radius;
  const Vector<dim> x = state.position.col(i);
  const std::size_t inner = water_pairs(columns, water);
  const auto k = static_cast<std::size_t>(i);
  const std::int64_t first = far.start()[k];
  const float* const shared = far.entry().data() + first;
  float* const entries = shares ? nullptr : entry_.data() + first;
  water_stop_[k] = first + static_cast<std::int64_t>(inner);
  // w_L, W and w/r² of eight pairs at a time; the last is zero beyond the gradient's radius.
  Lanes8 diagonals{}, volumes{}, stiffnesses{}, opens[dim]{}, crowdings[dim]{};
  Lanes8 moments[Symmetric<dim>::parts]{};  // Σ w r⊗r/r²
  for (std::size_t e = 0; e < inner; e += lanes::width) {
    const auto [r, one] = eight_pairs<seams>(state, periodic, i, columns.first(inner), e);
    const int count = static_cast<int>(std::min<std::size_t>(lanes::width, inner - e));
    Lanes8 inverse;
    Floats8 single;
    if constexpr (shares) {
      single = -lanes::load(shared + e, count);
      inverse = (one + lanes::widened(single)) * far.scale();
    } else {
      inverse = Lanes8{};
      for (int p = 0; p < count; ++p) inverse[p] = far.inverse_of(first + static_cast<std::int64_t>(e) + p);
      single = lanes::narrowed(positive(reach * inverse - one));
      lanes::store(-single, entries + e, inner - e);
    }
    Lanes8 squares = r[0] * r[0];
#pragma GCC unroll 6
    for (int d = 1; d < dim; ++d) squares += r[d] * r[d];
    const Lanes8 w = lanes::widened(single), q = squares * inverse * (1 / reach);
    const Lanes8 s = positive(one - q);
    diagonals += w;
    volumes += s * s * s * s * (1 + 4 * q);
    const Lanes8 near_weight = positive(gradient_.radius * inverse - one) * inverse * inverse;
    // Of w r/r² along r: −d/dr (R/r − 1)/r = (2R/r − 1)/r².
    stiffnesses += positive(2 * gradient_.radius * inverse - one) * inverse * inverse;
    Lanes8 arm[dim];
#pragma GCC unroll 6
    for (int d = 0; d < dim; ++d) {
      opens[d] += w * r[d];
      arm[d] = near_weight * r[d];
      crowdings[d] += arm[d];
    }
#pragma GCC unroll 6
    for (int m = 0; m < Symmetric<dim>::parts; ++m)
      moments[m] += arm[Symmetric<dim>::row[m]] * r[Symmetric<dim>::column[m]];
  }
  double diagonal = sum(diagonals), volume = sum(volumes), stiffness = sum(stiffnesses);
  Tensor<dim> b, a = Tensor<dim>::Zero();
  Vector<dim> open = vector_of<dim>(opens), crowding = vector_of<dim>(crowdings);
#pragma GCC unroll 6
  for (int m = 0; m < Symmetric<dim>::parts; ++m) {
    const int row = Symmetric<dim>::row[m], column = Symmetric<dim>::column[m];
    b(row, column) = b(column, row) = sum(moments[m]);
  }
  const auto near_columns = near.row(i);
  const auto near_inverses = near.inverses(i);
  const std::size_t near_inner = water_pairs(near_columns, water);
  const auto near_weight = [&](std::size_t e) {
    return (gradient_.radius * near_inverses[e] - 1) * near_inverses[e] * near_inverses[e];
  };
  Vector<dim> walled = open;
  double weights = diagonal, filled = 1 + volume;
  for (std::size_t e = inner; e < columns.size(); ++e) {
    const std::int64_t j = columns[e];
    if (!walls_.wet(j)) continue;
    const Vector<dim> r = periodic.separation(x, state.position.col(j));
    const double inverse = far.inverse_of(first + static_cast<std::int64_t>(e));
    const double far_weight = reach * inverse - 1;
    weights += far_weight;
    const double part = volume_weight(1 / (inverse * reach));
    volume += part;
    filled += cover_[j - water] * part;
    open += far_weight * r;
    walled += far_weight * walls_.held(j, r);
  }
  bool beside_wall = false;
  for (std::size_t e = near_inner; e < near_columns.size(); ++e) {
    const std::int64_t j = near_columns[e];
    if (!walls_.wet(j)) continue;
    const Vector<dim> r = periodic.separation(x, state.position.col(j));
    crowding += near_weight(e) * r;
    stiffness += (2 * gradient_.radius * near_inverses[e] - 1) * near_inverses[e] * near_inverses[e];
    if (!over(boundary, state, i, j)) continue;
    const Vector<dim> held = walls_.held(j, r);
    a.noalias() += near_weight(e) * held * held.transpose();
    beside_wall = true;
  }
  inverse_where_seen<dim>(b, water_[k]);
  moment_.col(i) = walled;
  crowding_.col(i) = crowding;
  stiffness_[i] = stiffness * p_.spacing * p_.spacing / gradient_.n0;
  diagonal_[i] = diagonal;
  volume_[i] = volume;

  double factor = 0, depth = largest_depth * p_.spacing, share = 0, pull = 0;
  Vector<dim> inward = Vector<dim>::Zero();
  const double least_moment = surface_begins * lattice_.second_moment;
  if (!full_ && (open.squaredNorm() > least_moment * least_moment || weights < lattice_.first_weights)) {
    // Past the end of a face its rows are no water above the particle: an edge is as sharp as the lattice
    // allows.
    for (std::size_t e = inner; e < columns.size(); ++e) {
      const std::int64_t j = columns[e];
      if (j < boundary.first_of_bodies() || !walls_.wet(j) || over(boundary, state, i, j)) continue;
      const Vector<dim> r = periodic.separation(x, state.position.col(j));
      const double inverse = far.inverse_of(first + static_cast<std::int64_t>(e));
      const double far_weight = reach * inverse - 1;
      weights -= far_weight;
      filled -= cover_[j - water] * volume_weight(1 / (inverse * reach));
      open -= far_weight * r;
      walled -= far_weight * walls_.held(j, r);
    }
    const double m = open.norm();
    share =
        std::clamp((m - least_moment) / (surface_counts * lattice_.second_moment - least_moment), 0.0, 1.0);
    if (m > 0) inward = open / m;
    const double sharp = std::clamp((1 - weights / lattice_.first_weights) / edge, 0.0, 1.0);
    depth = std::clamp(lattice_.depth(filled / (1 + lattice_.volume)),
                       (least_depth + (first_depth - least_depth) * sharp) * p_.spacing,
                       largest_depth * p_.spacing);
    factor = share * std::max(0.0, walled.dot(inward)) / depth;
    // A film or a drop has surface on both sides, so that m says little: its missing weight does.
    const double missing = (lattice_.weights - weights) / (lattice_.weights - lattice_.first_weights);
    const double thin = missing * lattice_.first_moment / (first_depth * p_.spacing);
    if (weights < lattice_.first_weights && thin > factor) {
      factor = thin;
      share = 1;
    }
    Tensor<dim> all = a + b;
    const double lacking = share * std::max(0.0, gradient_.n0 / dim - inward.dot(all * inward));
    all.noalias() += lacking * inward * inward.transpose();
    pull = lacking / depth;
    inverse_where_seen<dim>(all, all_[k]);
  } else if (beside_wall) {
    inverse_where_seen<dim>(a + b, all_[k]);
  } else {
    for (int c = 0; c < dim * dim; ++c) all_[k].data()[c] = water_[k].data()[c];
  }
  inward_.col(i) = inward;
  surface_factor_[i] = factor;
  surface_share_[i] = share;
  surface_pull_[i] = pull;
  state.surface[k] = factor > 0 && share >= 1 && depth < shown_depth * p_.spacing ? 1 : 0;
}

// Σ w (u_j − u_i) ⊗ r/r² [Σ w r⊗r/r²]⁻¹
template <int dim>
template <bool seams>
void FittedScheme<dim>::find_velocity_gradient(const Boundary<dim>& boundary, const State<dim>& state,
                                               const Neighbours& near) {
  const auto& periodic = boundary.tank().periodic();
  const double *const places = state.position.data(), *const velocities = state.velocity.data();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    const auto x = column_at<dim>(places + dim * i), u = column_at<dim>(velocities + dim * i);
    Column<dim> sum[dim]{};
    [[maybe_unused]] Lanes4 all{};  // in the plane all products at once
    for (std::size_t e = 0, inner = water_pairs(columns, boundary.water()); e < inner; ++e) {
      const std::int64_t j = columns[e];
      const double inverse = inverses[e], w = (gradient_.radius * inverse - 1) * inverse * inverse;
      auto r = column_at<dim>(places + dim * j) - x;
      if constexpr (seams) over_seams<dim>(periodic, r);
      const auto du = column_at<dim>(velocities + dim * j) - u;
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
    const Tensor<dim>& inverse = water_[k];
    Motion& motion = motion_[k];
    motion.place = x;
    motion.velocity = u;
    for (int b = 0; b < dim; ++b) {
      motion.gradient[b] = sum[0] * inverse(0, b);
      for (int a = 1; a < dim; ++a) motion.gradient[b] += sum[a] * inverse(a, b);
    }
  }
}

// Δu_i = Δt (2d/(n0 λ)) Σ_j β l0 |δ_ij| δ_ij w, δ_ij = u_j − u_i − ½ (∇u_i + ∇u_j) r_ij; antisymmetric, so
// momentum is exact. |δ| is bounded where the explicit step would overshoot.
template <int dim>
template <bool seams>
void FittedScheme<dim>::find_filter(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& near,
                                    double dt) {
  const auto& periodic = boundary.tank().periodic();
  const double factor = 2.0 * dim / (gradient_.n0 * gradient_.lambda0) * p_.scheme.filter * p_.spacing * dt;
  constexpr double most_of_a_step = 0.25;
  const double bound = most_of_a_step / (factor * gradient_.n0);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    const Motion own = motion_[static_cast<std::size_t>(i)];
    const auto jump_of = [&](std::int32_t j) {
      const Motion& other = motion_[static_cast<std::size_t>(j)];
      auto r = other.place - own.place;
      if constexpr (seams) over_seams<dim>(periodic, r);
      auto jump = other.velocity - own.velocity;
      for (int b = 0; b < dim; ++b) jump -= (own.gradient[b] + other.gradient[b]) * (0.5 * r[b]);
      return jump;
    };
    Column<dim> sum{};
    const std::size_t inner = water_pairs(columns, boundary.water());
    std::size_t e = 0;
    for (; e + 4 <= inner; e += 4) {  // four roots take as long as one
      const Column<dim> a = jump_of(columns[e]), b = jump_of(columns[e + 1]), c = jump_of(columns[e + 2]),
                        d = jump_of(columns[e + 3]);
      const Lanes4 size = lanes::root(squares<dim>(a, b, c, d)), most = bound - Lanes4{};
      const Lanes4 inverse{inverses[e], inverses[e + 1], inverses[e + 2], inverses[e + 3]};
      const Lanes4 weight = (gradient_.radius * inverse - 1.0) * (size < most ? size : most);
      sum += a * weight[0];
      sum += b * weight[1];
      sum += c * weight[2];
      sum += d * weight[3];
    }
    for (; e < inner; ++e) {
      const Column<dim> jump = jump_of(columns[e]);
      const double size = std::sqrt(squares<dim>(jump, jump, jump, jump)[0]);
      sum += jump * ((gradient_.radius * inverses[e] - 1) * std::min(size, bound));
    }
    for (int d = 0; d < dim; ++d) state.velocity(d, i) += factor * sum[d];
  }
}

template <int dim>
void FittedScheme<dim>::fit_velocity(const Boundary<dim>& boundary, const State<dim>& state,
                                     const Neighbours& near) {
  motion_ = motions_.of<Motion>(static_cast<std::size_t>(boundary.water()));
  if (boundary.tank().periodic().any())
    find_velocity_gradient<true>(boundary, state, near);
  else
    find_velocity_gradient<false>(boundary, state, near);
}

template <int dim>
void FittedScheme<dim>::filter(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& near,
                               double dt) {
  const bool seams = boundary.tank().periodic().any();
  fit_velocity(boundary, state, near);
  if (p_.scheme.filter <= 0) return;
  if (seams)
    find_filter<true>(boundary, state, near, dt);
  else
    find_filter<false>(boundary, state, near, dt);
}

template class FittedScheme<2>;
template class FittedScheme<3>;

}  // namespace strake::fluid
