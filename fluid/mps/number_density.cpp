#include "fluid/mps/number_density.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace strake::fluid {
namespace {

using std::size_t;

/// Radii of the circles that decide whether a particle is surface [l0]. A particle inside joins the surface
/// when its circle of the first radius is not covered by the equal circles of its neighbours. A surface
/// particle leaves it when the smaller circle is covered. So a crack between two layers of water opens when
/// their centres are 1.95 l0 apart, while a body's layer that comes from outside closes the surface at
/// 1.15 l0. The smaller radius still covers itself on the lattice, where it needs 1/√2.
constexpr double joining_radius = 1.05, leaving_radius = 0.72;

/// Directions from a particle, evenly spread: every 5 degrees in the plane, a spiral of equal areas on the
/// sphere.
template <int dim>
struct Directions {
  static constexpr int count = dim == 2 ? 72 : 256;
  static constexpr int open = 3;  // uncovered directions that make an opening (15 degrees of the circle)
  std::array<std::array<double, count>, dim> axis;
  Directions() {
    for (size_t k = 0; k < static_cast<size_t>(count); ++k) {
      if constexpr (dim == 2) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(k) / count;
        axis[0][k] = std::cos(angle);
        axis[1][k] = std::sin(angle);
      } else {
        const double z = 1 - (2 * static_cast<double>(k) + 1) / count, r = std::sqrt(1 - z * z);
        const double angle = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(k);
        axis[0][k] = r * std::cos(angle);
        axis[1][k] = r * std::sin(angle);
        axis[2][k] = z;
      }
    }
  }
};

/// Whether the circle (sphere) of radius R around i has an opening. The point x_i + R s is inside the circle
/// of j when s·r_ij > |r_ij|²/(2R).
template <int dim>
bool uncovered(const Vectors<dim>& position, const Neighbours& rows, Eigen::Index i, double radius) {
  static const Directions<dim> directions;
  constexpr auto n = static_cast<size_t>(Directions<dim>::count);
  std::array<std::uint8_t, n> covered{};
  const auto row = rows.row(i);
  const auto distance = rows.distances(i);
  const auto seams = rows.seams<dim>();
  for (size_t k = 0; k < row.size(); ++k) {
    if (distance[k] >= 2 * radius) continue;
    const Vector<dim> r = seams.separation(position.col(i), position.col(row[k]));
    const double threshold = distance[k] * distance[k] / (2 * radius);
    for (size_t s = 0; s < n; ++s) {
      double along = 0;
      for (size_t d = 0; d < static_cast<size_t>(dim); ++d)
        along += directions.axis[d][s] * r[static_cast<Eigen::Index>(d)];
      covered[s] |= along > threshold ? std::uint8_t{1} : std::uint8_t{0};
    }
  }
  int open = 0;
  for (const auto c : covered) open += c ? 0 : 1;
  return open >= Directions<dim>::open;
}

}  // namespace

Eigen::VectorXd number_density(const Neighbours& rows, double radius) {
  const auto n = rows.size();
  Eigen::VectorXd density(n);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    double sum = 0;
    const InverseRow inverses = rows.inverses(i);
    for (std::size_t e = 0; e < inverses.size(); ++e) sum += std::max(radius * inverses[e] - 1, 0.0);
    density[i] = sum;
  }
  return density;
}

std::vector<std::int32_t> neighbour_counts(const Neighbours& rows, double radius) {
  const auto n = rows.size();
  std::vector<std::int32_t> counts(static_cast<size_t>(n));
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    std::int32_t count = 0;
    for (const double distance : rows.distances(i)) count += distance < radius ? 1 : 0;
    counts[static_cast<size_t>(i)] = count;
  }
  return counts;
}

template <int dim>
std::vector<std::uint8_t> surface_flags(const Vectors<dim>& position, std::span<const Kind> kind,
                                        const Neighbours& rows, const Eigen::VectorXd& n,
                                        const SurfaceTest& test, std::span<const std::uint8_t> previous) {
  const auto size = rows.size();
  assert(position.cols() == size && n.size() == size && kind.size() == static_cast<size_t>(size));
  assert(previous.empty() || previous.size() == static_cast<size_t>(size));
  assert(test.spacing > 0);
  std::vector<std::uint8_t> flags(static_cast<size_t>(size));
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < size; ++i) {
    const auto k = static_cast<size_t>(i);
    if (!has_pressure(kind[k]) || n[i] >= test.beta * test.lattice.n0) continue;
    const bool before = previous.empty() || previous[k];
    const double radius = (before ? leaving_radius : joining_radius) * test.spacing;
    const bool surface = test.second == SecondCriterion::none || uncovered<dim>(position, rows, i, radius);
    flags[k] = surface ? 1 : 0;
  }
  return flags;
}

template std::vector<std::uint8_t> surface_flags<2>(const Vectors<2>&, std::span<const Kind>,
                                                    const Neighbours&, const Eigen::VectorXd&,
                                                    const SurfaceTest&, std::span<const std::uint8_t>);
template std::vector<std::uint8_t> surface_flags<3>(const Vectors<3>&, std::span<const Kind>,
                                                    const Neighbours&, const Eigen::VectorXd&,
                                                    const SurfaceTest&, std::span<const std::uint8_t>);

}  // namespace strake::fluid
