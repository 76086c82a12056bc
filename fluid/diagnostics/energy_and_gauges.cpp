#include "fluid/diagnostics/energy_and_gauges.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace strake::fluid {
namespace {

constexpr double layer = 2;   // [l0] above the floor that belong to the front's layer
constexpr double gap = 2;     // [l0] between particles that end a body of water
constexpr double column = 1;  // [l0] half-width of the column whose level is sought
constexpr double gauge_half_width =
    2;  // [l0] of a wave gauge: a whole number, so that a lattice sums to itself

/// Returns the farthest of `places` that is reached from 0 without a gap. It is −l0/2 where the first one is
/// too far.
double reached(std::vector<double>& places, double spacing) {
  std::sort(places.begin(), places.end());
  double last = -0.5 * spacing;
  for (const double place : places) {
    if (place - last > gap * spacing) break;
    last = std::max(last, place);
  }
  return last;
}

/// ∫ of the hat (1 − |s|/b)/b from −∞ to s.
double hat_below(double s, double b) {
  const double t = std::clamp(s / b, -1.0, 1.0);
  return t < 0 ? 0.5 * (1 + t) * (1 + t) : 1 - 0.5 * (1 - t) * (1 - t);
}

}  // namespace

template <int dim>
WaterAccount<dim> account_of(const State<dim>& state, std::span<const std::int64_t> water, double mass,
                             const Vector<dim>& gravity, const Vector<dim>& corner) {
  WaterAccount<dim> account;
  double squares = 0, fastest = 0;
  Vector<dim> places = Vector<dim>::Zero();
  for (const std::int64_t i : water) {
    const double square = state.velocity.col(i).squaredNorm();
    squares += square;
    fastest = std::max(fastest, square);
    places += state.position.col(i) - corner;
    ++(state.surface[static_cast<std::size_t>(i)] ? account.surface : account.inner);
  }
  account.kinetic = 0.5 * mass * squares;
  account.potential = -mass * gravity.dot(places);
  account.largest_speed = std::sqrt(fastest);
  if (!water.empty()) account.centre = corner + places / static_cast<double>(water.size());
  return account;
}

template <int dim>
WaterAccount<dim> together(WaterAccount<dim> own, const RankExchange<dim>& ranks) {
  if (!ranks.several()) return own;
  const auto count = static_cast<double>(own.inner + own.surface);
  const Vector<dim> sums =
      ranks.sum(Vector<dim>(Vector<dim>::Unit(0) * own.kinetic + Vector<dim>::Unit(1) * own.potential));
  own.kinetic = sums[0];
  own.potential = sums[1];
  own.largest_speed = ranks.max(own.largest_speed);
  own.centre = ranks.sum(Vector<dim>(count * own.centre));
  own.inner = ranks.sum(own.inner);
  own.surface = ranks.sum(own.surface);
  own.centre /= static_cast<double>(std::max<std::int64_t>(1, own.inner + own.surface));
  return own;
}

template <int dim>
double front(const Vectors<dim>& position, std::span<const std::int64_t> water, const Vector<dim>& at,
             double spacing) {
  std::vector<double> ahead;
  for (const std::int64_t i : water) {
    const Vector<dim> x = position.col(i) - at;
    if (x[0] > -0.5 * spacing && x[1] > -spacing && x[1] < layer * spacing) ahead.push_back(x[0]);
  }
  return at[0] + reached(ahead, spacing) + 0.5 * spacing;
}

template <int dim>
double level(const Vectors<dim>& position, std::span<const std::int64_t> water, const Vector<dim>& at,
             double spacing) {
  std::vector<double> above;
  for (const std::int64_t i : water) {
    const Vector<dim> x = position.col(i) - at;
    const bool over =
        std::abs(x[0]) <= column * spacing && (dim == 2 || std::abs(x[dim - 1]) <= column * spacing);
    if (over && x[1] > -0.5 * spacing) above.push_back(x[1]);
  }
  return reached(above, spacing) + 0.5 * spacing;
}

template <int dim>
double wetted_height(const Vectors<dim>& position, std::span<const std::int64_t> water, const Vector<dim>& at,
                     const Vector<dim>& low, const Vector<dim>& high, double spacing) {
  const double b = gauge_half_width * spacing;
  double sum = 0;
  for (const std::int64_t i : water) {
    const Vector<dim> x = position.col(i) - at;
    if (x[1] <= -0.5 * spacing) continue;
    double weight = 1;
    for (int d = 0; d < dim; d += 2) weight *= std::max(0.0, 1 - std::abs(x[d]) / b) / b;
    sum += weight;
  }
  double share = 1;  // of the hat that lies in the tank
  for (int d = 0; d < dim; d += 2) share *= hat_below(high[d] - at[d], b) - hat_below(low[d] - at[d], b);
  return share > 0 ? sum * std::pow(spacing, dim) / share : 0;
}

template <int dim>
bool gauge_reads(const std::string& quantity, const Vector<dim>& x, double spacing) {
  if (quantity == "front") return std::abs(x[1]) <= layer * spacing;
  const double reach = std::max(column, gauge_half_width) * spacing;
  return std::abs(x[0]) <= reach && (dim == 2 || std::abs(x[dim - 1]) <= reach);
}

template bool gauge_reads<2>(const std::string&, const Vector<2>&, double);
template bool gauge_reads<3>(const std::string&, const Vector<3>&, double);
template WaterAccount<2> together(WaterAccount<2>, const RankExchange<2>&);
template WaterAccount<2> account_of(const State<2>&, std::span<const std::int64_t>, double, const Vector<2>&,
                                    const Vector<2>&);
template double front(const Vectors<2>&, std::span<const std::int64_t>, const Vector<2>&, double);
template double level(const Vectors<2>&, std::span<const std::int64_t>, const Vector<2>&, double);
template double wetted_height(const Vectors<2>&, std::span<const std::int64_t>, const Vector<2>&,
                              const Vector<2>&, const Vector<2>&, double);
template WaterAccount<3> together(WaterAccount<3>, const RankExchange<3>&);
template WaterAccount<3> account_of(const State<3>&, std::span<const std::int64_t>, double, const Vector<3>&,
                                    const Vector<3>&);
template double front(const Vectors<3>&, std::span<const std::int64_t>, const Vector<3>&, double);
template double level(const Vectors<3>&, std::span<const std::int64_t>, const Vector<3>&, double);
template double wetted_height(const Vectors<3>&, std::span<const std::int64_t>, const Vector<3>&,
                              const Vector<3>&, const Vector<3>&, double);

}  // namespace strake::fluid
