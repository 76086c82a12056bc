#include "fluid/boundary/body_packing.hpp"

#include "fluid/boundary/fill.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <span>
#include <vector>

namespace strake::fluid {
namespace {

constexpr double depth = 6;       // [l0] of the water that may move. Chosen
constexpr double strength = 0.2;  // A, as of `pack`
constexpr double longest = 0.1;   // [l0] of one move
constexpr double rest = 1e-3;     // [l0] largest move at which it has settled
constexpr int most_rounds = 200;
constexpr double nearest_face = 0.25;  // [l0] water is not moved nearer to a face
constexpr double first_row = 0.75;     // [l0] water less deep than this stays at its level

template <int dim>
class Packing {
 public:
  Packing(const Parameters&, Boundary<dim>&, State<dim>&);
  void even_out();

 private:
  using Rows = const Neighbours&;
  void choose_water();
  bool beside_open_side(const Vector<dim>&) const;
  Rows search();
  double move(Vectors<dim>& by);
  double below_level(Eigen::Index i) const { return level_ - place_(1, i); }

  const Parameters& p_;
  Boundary<dim>& boundary_;
  State<dim>& state_;
  const BodySurface<dim>& body_;
  double l0_, level_;
  LatticeConstants gradient_;
  double radius_;
  std::vector<std::int32_t> global_;  // places of the state: those that move, other water, layers
  Eigen::Index movers_ = 0, water_ = 0;
  Vectors<dim> place_;
  NeighbourSearch<dim> search_;
};

template <int dim>
Packing<dim>::Packing(const Parameters& p, Boundary<dim>& boundary, State<dim>& state)
    : p_(p),
      boundary_(boundary),
      state_(state),
      body_(boundary.body_surface()),
      l0_(p.spacing),
      level_(p.water.max[1]),
      gradient_(lattice_constants<dim>(p.scheme.radius_gradient, p.spacing)),
      radius_(p.scheme.radius_laplacian * p.spacing),
      search_(radius_, 0.2 * p.spacing, boundary.tank().periodic()) {
  choose_water();
}

/// Whether water at x ends nearby at another place than body, walls or level.
template <int dim>
bool Packing<dim>::beside_open_side(const Vector<dim>& x) const {
  const int reach = static_cast<int>(std::ceil(radius_ / l0_)) - 1, side = 2 * reach + 1;
  const int all = dim == 2 ? side * side : side * side * side;
  for (int k = 0; k < all; ++k) {
    Vector<dim> at = x;
    for (int d = 0, rest = k; d < dim; ++d, rest /= side) at[d] += l0_ * (rest % side - reach);
    if (at[1] > level_) continue;
    at = boundary_.tank().periodic().wrap(at, boundary_.tank().shape().low());
    if (is_water_at<dim>(p_, at) || !boundary_.tank().shape().contains(at) || body_.inside(at)) continue;
    return true;
  }
  return false;
}

template <int dim>
void Packing<dim>::choose_water() {
  const double reach = (depth + 1) * l0_ + 2 * radius_;
  std::vector<std::int32_t> others, layers;
  for (std::int64_t i = 0; i < boundary_.first_of_bodies(); ++i) {
    const Vector<dim> x = state_.position.col(i);
    if (((x - body_.low()).array() < -reach).any() || ((body_.high() - x).array() < -reach).any()) continue;
    const double distance = body_.nearest(x).distance;
    if (distance > reach) continue;
    if (i >= boundary_.water()) {
      layers.push_back(static_cast<std::int32_t>(i));
      continue;
    }
    const bool moves = distance < depth * l0_ && !beside_open_side(x);
    (moves ? global_ : others).push_back(static_cast<std::int32_t>(i));
  }
  movers_ = std::ssize(global_);
  global_.insert(global_.end(), others.begin(), others.end());
  water_ = std::ssize(global_);
  global_.insert(global_.end(), layers.begin(), layers.end());
  for (std::int64_t i = boundary_.first_of_bodies(); i < state_.position.cols(); ++i)
    global_.push_back(static_cast<std::int32_t>(i));
  place_.resize(dim, std::ssize(global_));
  for (Eigen::Index k = 0; k < place_.cols(); ++k)
    place_.col(k) = state_.position.col(global_[static_cast<std::size_t>(k)]);
}

template <int dim>
const Neighbours& Packing<dim>::search() {
  const auto all = boundary_.tags(state_);
  std::vector<std::uint8_t> tags(global_.size());
  for (std::size_t k = 0; k < tags.size(); ++k) tags[k] = all[static_cast<std::size_t>(global_[k])];
  const auto keep = [this](std::int32_t i, std::int32_t j) {
    return boundary_.keep(state_, global_[static_cast<std::size_t>(i)], global_[static_cast<std::size_t>(j)]);
  };
  return search_.update(place_, tags, keep);
}

/// Moves the water, through no face. Returns the largest move [m].
template <int dim>
double Packing<dim>::move(Vectors<dim>& by) {
  const double least = nearest_face * l0_;
#pragma omp parallel for schedule(dynamic, 64)
  for (Eigen::Index i = 0; i < movers_; ++i) {
    if (below_level(i) < first_row * l0_) by(1, i) = 0;
    if (const double length = by.col(i).norm(); length > longest * l0_) by.col(i) *= longest * l0_ / length;
    Vector<dim> x = place_.col(i) + by.col(i);
    const auto near = body_.nearest(x);
    if (const bool inside = body_.inside(x); inside || near.distance < least)
      x = near.position + least * body_.normal(near.point);
    if (const auto foot = boundary_.tank().behind(x)) x = foot->position + least * foot->normal;
    x[1] = std::min(x[1], level_ - 0.25 * l0_);
    by.col(i) = x - place_.col(i);
    place_.col(i) = x;
    state_.position.col(global_[static_cast<std::size_t>(i)]) = x;
  }
  return movers_ > 0 ? by.colwise().norm().maxCoeff() : 0.0;
}

template <int dim>
void Packing<dim>::even_out() {
  const auto& periodic = boundary_.tank().periodic();
  Vectors<dim> by(dim, movers_);
  for (int round = 0; round < most_rounds; ++round) {
    const Neighbours& near = search();
#pragma omp parallel for schedule(static)
    for (Eigen::Index i = 0; i < movers_; ++i) {
      Vector<dim> sum = Vector<dim>::Zero();
      const auto add = [&](const Vector<dim>& r, double inverse) {
        sum += std::max(0.0, gradient_.radius * inverse - 1) * inverse * inverse * r;
      };
      const auto columns = near.row(i);
      const auto inverses = near.inverses(i);
      const double under = below_level(i);
      if (under < 0.5 * radius_) add(Vector<dim>::Unit(1) * 2 * under, 0.5 / under);
      for (std::size_t e = 0; e < columns.size(); ++e) {
        const std::int32_t j = columns[e];
        Vector<dim> r = periodic.separation(place_.col(i), place_.col(j));
        add(r, inverses[e]);
        if (j >= water_ || under + below_level(j) > radius_) continue;
        r[1] = under + below_level(j);  // the place j in the mirror
        add(r, 1 / r.norm());
      }
      by.col(i) = -strength * l0_ * l0_ * dim / gradient_.n0 * sum;
    }
    const double moved = move(by);
    if (getenv("PK")) fprintf(stderr, "even %d moved %g\n", round, moved / l0_);
    if (moved < rest * l0_) break;
  }
}

}  // namespace

template <int dim>
void pack_around(const Parameters& p, Boundary<dim>& boundary, State<dim>& state) {
  if (!water_is_packed(p, boundary)) return;
  Packing<dim> packing(p, boundary, state);
  packing.even_out();
}

template <int dim>
bool water_is_packed(const Parameters& p, const Boundary<dim>& boundary) {
  return p.submerged && !boundary.body_surface().empty();
}

template <int dim>
void begin_at_rest(const Parameters& p, const Boundary<dim>& boundary, State<dim>& state) {
  state.surface.assign(state.kind.size(), 1);
  if (!water_is_packed(p, boundary)) return;
  // `WallContact` keeps faces wet that have water within a spacing, and dries the others.
  for (std::int64_t i = boundary.first_of_bodies(); i < state.position.cols(); ++i)
    if (boundary.master_of(i) < 0) state.surface[static_cast<std::size_t>(i)] = 0;
  if (p.gravity_ramp > 0) return;
  const double slope = -p.density * p.gravity[1];
  for (std::int64_t i = 0; i < boundary.water(); ++i)
    state.pressure[i] = slope * std::max(0.0, p.water.max[1] - state.position(1, i));
}

template void pack_around<2>(const Parameters&, Boundary<2>&, State<2>&);
template void pack_around<3>(const Parameters&, Boundary<3>&, State<3>&);

template bool water_is_packed<2>(const Parameters&, const Boundary<2>&);
template bool water_is_packed<3>(const Parameters&, const Boundary<3>&);
template void begin_at_rest<2>(const Parameters&, const Boundary<2>&, State<2>&);
template void begin_at_rest<3>(const Parameters&, const Boundary<3>&, State<3>&);

}  // namespace strake::fluid
