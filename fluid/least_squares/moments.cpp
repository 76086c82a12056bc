#include "fluid/least_squares/scheme.hpp"
#include "fluid/particles/pair_loop.hpp"

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
LeastSquaresScheme<dim>::LeastSquaresScheme(const Parameters& p, const Boundary<dim>& boundary,
                                            const State<dim>& state)
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
  for (SingleVectors* v : {&moment_, &inward_, &crowding_, &reaction_}) v->setZero(dim, water);
  for (Eigen::VectorXf* v : {&stiffness_, &eased_, &soft_, &yielding_, &volume_, &surface_factor_,
                             &surface_pull_, &surface_share_})
    v->setZero(water);
  for (Eigen::VectorXd* v : {&meant_, &diagonal_}) v->setZero(water);
  gradient_of_p_.setZero(dim, water);
  mean_approach_.setZero(dim, state.position.cols() - water);
  cover_.setZero(state.position.cols() - water);
}

template <int dim>
void LeastSquaresScheme<dim>::measure(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& far,
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
void LeastSquaresScheme<dim>::fit(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& far,
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
  moment_.col(i) = walled.template cast<float>();
  crowding_.col(i) = crowding.template cast<float>();
  stiffness_[i] = static_cast<float>(stiffness * p_.spacing * p_.spacing / gradient_.n0);
  diagonal_[i] = diagonal;
  volume_[i] = static_cast<float>(volume);

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
  inward_.col(i) = inward.template cast<float>();
  surface_factor_[i] = static_cast<float>(factor);
  surface_share_[i] = static_cast<float>(share);
  surface_pull_[i] = static_cast<float>(pull);
  state.surface[k] = factor > 0 && share >= 1 && depth < shown_depth * p_.spacing ? 1 : 0;
}

#define STRAKE_INSTANTIATE(dim)                                                                        \
  template LeastSquaresScheme<dim>::LeastSquaresScheme(const Parameters&, const Boundary<dim>&,        \
                                                       const State<dim>&);                             \
  template void LeastSquaresScheme<dim>::measure(const Boundary<dim>&, State<dim>&, const Neighbours&, \
                                                 const Neighbours&);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
