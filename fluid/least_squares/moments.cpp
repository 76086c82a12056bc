#include "fluid/least_squares/film.hpp"
#include "fluid/least_squares/moment_inverse.hpp"
#include "fluid/least_squares/scheme.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <algorithm>
#include <cstring>

namespace strake::fluid {

namespace {

/// Rows and columns of a symmetric tensor's different entries.
template <int dim>
struct Symmetric {
  static constexpr int parts = dim * (dim + 1) / 2;
  static constexpr int row[] = {0, 1, 1, 2, 2, 2}, column[] = {0, 0, 1, 0, 1, 2};
};

/// Returns the sums of the lanes, stored at once. Numbers that are written one by one and read as a vector
/// would stall.
template <int dim>
inline Vector<dim> vector_of(const Double8 (&lanes)[dim]) {
  Vector<dim> out;
  if constexpr (dim == 2) {
    const Double2 both{sum(lanes[0]), sum(lanes[1])};
    std::memcpy(out.data(), &both, sizeof both);
  } else {
    for (int d = 0; d < dim; ++d) out[d] = sum(lanes[d]);
  }
  return out;
}

/// The tensor of those sums, written in place.
template <int dim>
inline void write_symmetric(const Double8 (&parts)[Symmetric<dim>::parts], Tensor<dim>& out) {
#pragma GCC unroll 6
  for (int m = 0; m < Symmetric<dim>::parts; ++m) {
    const int row = Symmetric<dim>::row[m], column = Symmetric<dim>::column[m];
    out(row, column) = out(column, row) = sum(parts[m]);
  }
}

/// Returns 1 beside one face or none, 0 in a corner of two: 1 − 2 (1 − tr a²/(tr a)²), not below zero.
template <int dim>
inline double one_wall(const Tensor<dim>& a) {
  const double trace = a.trace();
  return trace > 0 ? std::max(0.0, 2 * a.squaredNorm() / (trace * trace) - 1) : 1.0;
}

/// Lengths of pairs over the radius. around: a pair's length may be the way around a corner, which is longer
/// than r. one: 0 for a lane without a pair.
template <int dim, class Separation>
inline Double8 part_of_radius(const Separation& r, Double8 inverse, Double8 one, double radius, bool around) {
  if (around) return one / (inverse * radius + (1.0 - one));
  Double8 squares = r[0] * r[0];
#pragma GCC unroll 6
  for (int d = 1; d < dim; ++d) squares += r[d] * r[d];
  return squares * inverse * (1 / radius);
}

}  // namespace

template <int dim>
void LeastSquaresScheme<dim>::measure(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& far,
                                      const Neighbours& near, double time) {
  if (moments_.diagonal.size() != boundary.water()) resize(boundary.water());
  walls_.update(boundary, state, near, time, air_->aired, ranks_);
  fade_lags(boundary, state);
  cover_layers(boundary, state, near);
  const std::int64_t water = boundary.water();
  ranks_.update_layers(wall_.cover, 0);
  const bool seams = boundary.tank().periodic().any(), shares = shares_entries(far);
  find_images(boundary, state, far);
  moments_.own_entries = !shares || images_.any;
  if (moments_.own_entries) make_room(moments_.entry, far.column().size());
  const auto fit_one = [&](std::int64_t i) {
    if (shares)
      seams ? fit<true, true>(boundary, state, far, near, i)
            : fit<false, true>(boundary, state, far, near, i);
    else
      seams ? fit<true, false>(boundary, state, far, near, i)
            : fit<false, false>(boundary, state, far, near, i);
  };
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i)
    if (ranks_.owns(i))
      fit_one(i);
    else
      moments_.water_stop[static_cast<std::size_t>(i)] = far.start()[static_cast<std::size_t>(i)];
  ranks_.update(surface_.share, Rings::first);
  if (images_.any) {
    ranks_.update(surface_.normal, Rings::first);
    pair_images(boundary, state, far);
    const auto listed = std::ssize(images_.particles);
#pragma omp parallel for schedule(static)
    for (std::int64_t e = 0; e < listed; ++e) add_images(far, images_.particles[static_cast<std::size_t>(e)]);
  }
  // Water that comes under the surface is no film at once (F69).
  if (p_.submerged) film_.share.array() *= surface_.share.array();
  ranks_.update(film_.share);
  if (p_.submerged) find_depth(boundary, far);
  list_films(boundary, state, far);
}

/// Sums of particle i over the water, eight pairs at a time.
template <int dim>
template <bool seams, bool shares>
void LeastSquaresScheme<dim>::sum_water(const Boundary<dim>& boundary, const State<dim>& state,
                                        const Neighbours& far, std::int64_t i, ParticleSums& out) {
  const auto& periodic = boundary.tank().periodic();
  const auto columns = far.row(i);
  const double reach = laplacian_.radius;
  const std::size_t inner = water_pairs(columns, boundary.water());
  const auto k = static_cast<std::size_t>(i);
  const std::int64_t first = far.start()[k];
  const bool around = boundary.beside_corner(state, i);
  const float* const shared = far.entry().data() + first;
  float* const entries = moments_.own_entries ? moments_.entry.data() + first : nullptr;
  moments_.water_stop[k] = first + static_cast<std::int64_t>(inner);
  // w_L, W and w/r² of eight pairs at a time; the last is zero beyond the gradient's radius.
  Double8 diagonals{}, volumes{}, stiffnesses{}, opens[dim]{}, crowdings[dim]{};
  Double8 moments[Symmetric<dim>::parts]{};  // Σ w r⊗r/r²
  for (std::size_t e = 0; e < inner; e += simd::width) {
    const auto [r, one] = eight_pairs<seams>(state, periodic, i, columns.first(inner), e);
    const int count = static_cast<int>(std::min<std::size_t>(simd::width, inner - e));
    Double8 inverse;
    Float8 single;
    if constexpr (shares) {
      single = -simd::load(shared + e, count);
      inverse = (one + simd::widened(single)) * far.scale();
      if (entries) simd::store(-single, entries + e, inner - e);
    } else {
      inverse = Double8{};
      for (int p = 0; p < count; ++p) inverse[p] = far.inverse_of(first + static_cast<std::int64_t>(e) + p);
      single = simd::narrowed(positive(reach * inverse - one));
      simd::store(-single, entries + e, inner - e);
    }
    const Double8 w = simd::widened(single), q = part_of_radius<dim>(r, inverse, one, reach, around);
    const Double8 s = positive(one - q);
    diagonals += w;
    volumes += s * s * s * s * (1 + 4 * q);
    const Double8 near_weight = positive(gradient_.radius * inverse - one) * inverse * inverse;
    // Of w r/r² along r: −d/dr (R/r − 1)/r = (2R/r − 1)/r².
    stiffnesses += positive(2 * gradient_.radius * inverse - one) * inverse * inverse;
    Double8 arm[dim];
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
  out.diagonal = sum(diagonals);
  out.volume = sum(volumes);
  out.stiffness = sum(stiffnesses);
  out.m = vector_of<dim>(opens);
  out.concentration = vector_of<dim>(crowdings);
  write_symmetric<dim>(moments, out.b);
  out.m_projected = out.m;
  out.weights = out.diagonal;
  out.filled = 1 + out.volume;
}

/// Adds the wet layer particles to the sums. Those of far enter the sums with w_L and W, those of near the
/// others.
template <int dim>
void LeastSquaresScheme<dim>::add_layers(const Boundary<dim>& boundary, const State<dim>& state,
                                         const Neighbours& far, const Neighbours& near, std::int64_t i,
                                         ParticleSums& sums) const {
  const auto& periodic = boundary.tank().periodic();
  const std::int64_t water = boundary.water();
  const Vector<dim> x = state.position.col(i);
  const double reach = laplacian_.radius;
  const auto columns = far.row(i);
  const std::int64_t first = far.start()[static_cast<std::size_t>(i)];
  for (std::size_t e = water_pairs(columns, water); e < columns.size(); ++e) {
    const std::int64_t j = columns[e];
    if (!walls_.wet(j)) continue;
    const Vector<dim> r = periodic.separation(x, state.position.col(j));
    const double inverse = far.inverse_of(first + static_cast<std::int64_t>(e));
    const double far_weight = walls_.weight(j, reach, inverse);
    sums.weights += far_weight;
    const double part = volume_weight(1 / (inverse * reach));
    sums.volume += walls_.bare(j) * part;
    sums.filled += wall_.cover[j - water] * part;
    sums.m += far_weight * r;
    sums.m_projected += far_weight * walls_.projection(j, r);
  }
  const auto near_columns = near.row(i);
  const auto inverses = near.inverses(i);
  for (std::size_t e = water_pairs(near_columns, water); e < near_columns.size(); ++e) {
    const std::int64_t j = near_columns[e];
    if (!walls_.wet(j)) continue;
    const Vector<dim> r = periodic.separation(x, state.position.col(j));
    const double weight = walls_.weight(j, gradient_.radius, inverses[e]) * inverses[e] * inverses[e];
    sums.concentration += weight * r;
    sums.stiffness += walls_.weight(j, 2 * gradient_.radius, inverses[e]) * inverses[e] * inverses[e];
    const double share = share_of(boundary, state, i, j);
    if (!(share > 0)) continue;
    const Vector<dim> projected = walls_.projection(j, r);
    sums.a.noalias() += share * weight * projected * projected.transpose();
    if (j >= boundary.first_of_bodies()) sums.bodies += share * weight * projected.squaredNorm();
    sums.beside_wall = true;
  }
}

/// Subtracts the layers past the end of a body's face: they are no water above the particle. Within l0 of the
/// end, face and free surface share the particle (F73). In the plane `past` goes on to rise outside the end.
template <int dim>
void LeastSquaresScheme<dim>::leave_out_past_faces(const Boundary<dim>& boundary, const State<dim>& state,
                                                   const Neighbours& far, std::int64_t i,
                                                   ParticleSums& sums) const {
  // Of water that starts under the level it is σ before. What lacks at a corner there is the body, and no
  // air.
  const double open = starts_under_level(state, i) ? surface_share(sums.m.norm()) : 1;
  if (!(open > 0)) return;
  const auto& periodic = boundary.tank().periodic();
  const std::int64_t water = boundary.water();
  const Vector<dim> x = state.position.col(i);
  const double reach = laplacian_.radius;
  const auto columns = far.row(i);
  const std::int64_t first = far.start()[static_cast<std::size_t>(i)];
  for (std::size_t e = water_pairs(columns, water); e < columns.size(); ++e) {
    const std::int64_t j = columns[e];
    if (j < boundary.first_of_bodies() || !walls_.wet(j)) continue;
    double past = 1 - share_of(boundary, state, i, j);
    if (!boundary.volume() && (dim == 2 || past < 1))
      past = std::max(past, 1 - boundary.inside_free_end(boundary.point_of(j), x) / p_.spacing);
    if (!(past > 0)) continue;
    past *= open;
    const Vector<dim> r = periodic.separation(x, state.position.col(j));
    const double inverse = far.inverse_of(first + static_cast<std::int64_t>(e));
    const double far_weight = past * (reach * inverse - 1);
    sums.weights -= far_weight;
    sums.filled -= past * wall_.cover[j - water] * volume_weight(1 / (inverse * reach));
    sums.m -= far_weight * r;
    sums.m_projected -= far_weight * walls_.projection(j, r);
  }
}

/// σ (F37) of |m|.
template <int dim>
double LeastSquaresScheme<dim>::surface_share(double m) const {
  const LeastSquaresConstants& tuned = least_squares_constants();
  const double least = tuned.surface_begins * lattice_.second_moment;
  return std::clamp((m - least) / (tuned.surface_counts * lattice_.second_moment - least), 0.0, 1.0);
}

/// σ, N, D, κ and b of particle i (F37)–(F39), (F47). Returns D [m], or a negative number where the particle
/// is not shown as surface.
template <int dim>
double LeastSquaresScheme<dim>::fit_surface(std::int64_t i, const ParticleSums& sums) {
  const LeastSquaresConstants& tuned = least_squares_constants();
  const double m = sums.m.norm();
  double share = surface_share(m);
  Vector<dim> normal = Vector<dim>::Zero();
  if (m > 0) normal = sums.m / m;
  const double sharp = std::clamp((1 - sums.weights / lattice_.first_weights) / tuned.edge, 0.0, 1.0);
  const double depth =
      std::clamp(lattice_.depth(sums.filled / (1 + lattice_.volume)),
                 (tuned.least_depth + (tuned.first_row - tuned.least_depth) * sharp) * p_.spacing,
                 tuned.largest_depth * p_.spacing);
  double kappa = share * std::max(0.0, sums.m_projected.dot(normal)) / depth;
  // A film or a drop has surface on both sides, so that m is small. κ then follows from the missing weight.
  const double missing = (lattice_.weights - sums.weights) / (lattice_.weights - lattice_.first_weights);
  const double thin = missing * lattice_.first_moment / (tuned.first_row * p_.spacing);
  if (sums.weights < lattice_.first_weights && thin > kappa) {
    kappa = thin;
    share = 1;
  }
  Tensor<dim> all = sums.a + sums.b;
  const double beside_body = std::min(1.0, sums.bodies / (tuned.body_counts * gradient_.n0));
  const double outwards = beside_body * one_wall<dim>(sums.a) * depth * normal.dot(sums.concentration);
  const double lacking = share * std::max({0.0, gradient_.n0 / dim - normal.dot(all * normal), outwards});
  all.noalias() += lacking * normal * normal.transpose();
  inverse_where_seen<dim>(all, moments_.a_inverse[static_cast<std::size_t>(i)]);
  surface_.normal.col(i) = normal.template cast<float>();
  surface_.kappa[i] = static_cast<float>(kappa);
  surface_.share[i] = static_cast<float>(share);
  surface_.slope_weight[i] = static_cast<float>(lacking / depth);
  return kappa > 0 && share >= 1 ? depth : -1;
}

template <int dim>
template <bool seams, bool shares>
void LeastSquaresScheme<dim>::fit(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& far,
                                  const Neighbours& near, std::int64_t i) {
  const LeastSquaresConstants& tuned = least_squares_constants();
  const auto k = static_cast<std::size_t>(i);
  ParticleSums sums;
  sum_water<seams, shares>(boundary, state, far, i, sums);
  add_layers(boundary, state, far, near, i, sums);
  inverse_where_seen<dim>(sums.b, moments_.b_inverse[k]);
  film_.share[i] = 0;
  moments_.m_projected.col(i) = sums.m_projected.template cast<float>();
  moments_.concentration.col(i) = sums.concentration.template cast<float>();
  moments_.stiffness[i] = static_cast<float>(sums.stiffness * p_.spacing * p_.spacing / gradient_.n0);
  moments_.diagonal[i] = sums.diagonal;
  moments_.volume[i] = static_cast<float>(sums.volume);

  if (const double started = starts_packed() ? start_share(boundary, state, i) : 0; started > 0)
    // It turns with the tank.
    sums.m -= started * boundary.tank().turned(start_.opening.col(state.id[k]).template cast<double>());
  const double least_moment = tuned.surface_begins * lattice_.second_moment;
  if (!full_ &&
      (sums.m.squaredNorm() > least_moment * least_moment || sums.weights < lattice_.first_weights)) {
    leave_out_past_faces(boundary, state, far, i, sums);
    const double depth = fit_surface(i, sums);
    film_.share[i] = surface_.share[i] > 0 ? static_cast<float>(film_share<dim>(sums.b)) : 0.0F;
    state.surface[k] = depth >= 0 && depth < tuned.shown_depth * p_.spacing ? 1 : 0;
    return;
  }
  if (sums.beside_wall)
    inverse_where_seen<dim>(sums.a + sums.b, moments_.a_inverse[k]);
  else
    for (int c = 0; c < dim * dim; ++c) moments_.a_inverse[k].data()[c] = moments_.b_inverse[k].data()[c];
  surface_.normal.col(i).setZero();
  surface_.kappa[i] = 0;
  surface_.share[i] = 0;
  surface_.slope_weight[i] = 0;
  state.surface[k] = 0;
}

#define STRAKE_INSTANTIATE(dim)                                                                        \
  template void LeastSquaresScheme<dim>::measure(const Boundary<dim>&, State<dim>&, const Neighbours&, \
                                                 const Neighbours&, double);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
