#include "fluid/boundary/submerged.hpp"

#include "fluid/boundary/boundary.hpp"
#include "fluid/boundary/fill.hpp"
#include "fluid/particles/columns.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace strake::fluid {

namespace {

/// Smallest distance of water to a face at the start [l0], before it is packed.
constexpr double least_distance = 0.3;
/// Points along each side of a cell, at which it is asked whether the body covers it.
constexpr int points_in_plane = 16, points_in_space = 6;
/// Cells covered alike, of which all or none are left out, so that a symmetric body stays symmetric.
constexpr std::size_t symmetric_images = 8;

/// The surface of a body that stands in the water: it has corners where `Boundary` finds them.
template <int dim>
BodySurface<dim> surface_of(const InterfaceMesh& body, double spacing) {
  if constexpr (dim == 2)
    return BodySurface2d(body, spacing);
  else
    return BodySurface3d(body, spacing, spacing, knuckles_under_water);
}

/// Returns the number of points of the cell around x that lie inside the body.
template <int dim>
long covered_points(const BodySurface<dim>& surface, const Vector<dim>& x, double spacing) {
  const long along = dim == 2 ? points_in_plane : points_in_space;
  const long all = dim == 2 ? along * along : along * along * along;
  if (((x - surface.low()).array() < -spacing).any() || ((surface.high() - x).array() < -spacing).any())
    return 0;
  const double half_diagonal = 0.5 * std::sqrt(dim) * spacing;
  if (distance_to<dim>(surface, x, half_diagonal) > half_diagonal) return surface.inside(x) ? all : 0;
  long covered = 0;
  for (long k = 0; k < all; ++k) {
    Vector<dim> at = x;
    for (long d = 0, rest = k; d < dim; ++d, rest /= along)
      at[d] += spacing * ((static_cast<double>(rest % along) + 0.5) / static_cast<double>(along) - 0.5);
    covered += surface.inside(at) ? 1 : 0;
  }
  return covered;
}

/// Returns which cells of water are left out: as many as the body covers in sum, the most covered first. Of
/// many cells that are covered alike some are taken at even intervals.
std::vector<std::uint8_t> displaced(const std::vector<long>& covered, long points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < covered.size(); ++i)
    if (covered[i] > 0) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return covered[a] > covered[b]; });
  const long sum = std::accumulate(covered.begin(), covered.end(), 0L);
  auto left = static_cast<std::size_t>(std::lround(static_cast<double>(sum) / static_cast<double>(points)));
  std::vector<std::uint8_t> out(covered.size(), 0);
  for (std::size_t first = 0, last = 0; first < order.size() && left > 0; first = last) {
    while (last < order.size() && covered[order[last]] == covered[order[first]]) ++last;
    const std::size_t alike = last - first;
    std::size_t taken = std::min(alike, left);
    if (taken < alike && alike <= symmetric_images) taken = 2 * taken >= alike ? alike : 0;
    for (std::size_t k = 0; k < alike; ++k)
      if ((k + 1) * taken / alike > k * taken / alike) out[order[first + k]] = 1;
    left -= std::min(left, std::max(taken, std::min(alike, left)));
  }
  return out;
}

}  // namespace

template <int dim>
State<dim> fill_around(const Parameters& p, const InterfaceMesh& body) {
  State<dim> state = fill<dim>(p);
  if (!p.submerged || body.position.cols() == 0 || p.interface == "volume") return state;
  const BodySurface<dim> surface = surface_of<dim>(body, p.spacing);
  const auto n = state.position.cols();
  std::vector<long> covered(static_cast<std::size_t>(n), 0);
#pragma omp parallel for schedule(dynamic, 256)
  for (Eigen::Index i = 0; i < n; ++i)
    if (state.kind[static_cast<std::size_t>(i)] == Kind::fluid)
      covered[static_cast<std::size_t>(i)] = covered_points<dim>(surface, state.position.col(i), p.spacing);
  const auto out =
      displaced(covered, static_cast<long>(std::pow(dim == 2 ? points_in_plane : points_in_space, dim)));
  std::vector<std::int32_t> kept;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (out[k]) continue;
    kept.push_back(static_cast<std::int32_t>(i));
    if (state.kind[k] != Kind::fluid) continue;
    const Vector<dim> x = state.position.col(i);
    const double least = least_distance * p.spacing;
    if (distance_to<dim>(surface, x, least) >= least && !surface.inside(x)) continue;
    const auto foot = surface.nearest(x);
    state.position.col(i) = foot.position + least * surface.normal(foot.point);
  }
  select_particles<dim>(state, kept);
  std::iota(state.id.begin(), state.id.end(), 0);
  return state;
}

template State<2> fill_around<2>(const Parameters&, const InterfaceMesh&);
template State<3> fill_around<3>(const Parameters&, const InterfaceMesh&);

}  // namespace strake::fluid
