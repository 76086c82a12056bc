#include "fluid/boundary/body_packing.hpp"

#include "fluid/boundary/fill.hpp"
#include "fluid/boundary/packing.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace strake::fluid {
namespace {

constexpr double body_depth = 6;  // [l0] of the water that may move. Chosen
constexpr int most_body_rounds = 200;
constexpr int tag_rounds = 10;         // after which it is asked anew what lies beside the faces
constexpr double nearest_face = 0.25;  // [l0] water is not moved nearer to a face
constexpr double closest = 0.4;        // [l0] distance of two particles below which water is refused
constexpr double dry_distance = 1;     // [l0] from a face's first row to water, above which it is dry
constexpr double dry_stretch = 4;      // [l0] around a dry face, in which others are counted
constexpr double covered = 0.1;        // [l0] distance of a face to a wall below which it is covered
constexpr long most_dry_in_plane = 5, most_dry_in_space = 20;

/// The places around a body that are moved, and those around them.
template <int dim>
class Packing {
 public:
  Packing(const Parameters&, Boundary<dim>&, State<dim>&);
  void even_out();
  /// Throws Error(case_file) where the water found no place.
  void check() const;

 private:
  void choose_water();
  const Neighbours& search(int round);
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
  std::vector<double> away_;          // of each that moves: from the faces, at least [m]
  std::vector<std::uint8_t> tags_;
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

template <int dim>
void Packing<dim>::choose_water() {
  const double reach = body_depth * l0_ + radius_ + l0_;
  std::vector<std::int32_t> others, layers;
  for (std::int64_t i = 0; i < boundary_.first_of_bodies(); ++i) {
    const Vector<dim> x = state_.position.col(i);
    if (((x - body_.low()).array() < -reach).any() || ((body_.high() - x).array() < -reach).any()) continue;
    const double distance = distance_to<dim>(body_, x, reach);
    if (distance > reach) continue;
    if (i >= boundary_.water()) {
      layers.push_back(static_cast<std::int32_t>(i));
      continue;
    }
    const bool moves = distance < body_depth * l0_ && !beside_open_side<dim>(p_, boundary_, x, radius_);
    (moves ? global_ : others).push_back(static_cast<std::int32_t>(i));
    if (moves) away_.push_back(distance);
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
const Neighbours& Packing<dim>::search(int round) {
  if (round % tag_rounds == 0) {
    const auto all = boundary_.tags(state_);
    tags_.resize(global_.size());
    for (std::size_t k = 0; k < tags_.size(); ++k) {
      tags_[k] = all[static_cast<std::size_t>(global_[k])];
      if (k >= static_cast<std::size_t>(movers_)) tags_[k] |= passive;  // what does not move needs no row
    }
  }
  const auto keep = [this](std::int32_t i, std::int32_t j) {
    return boundary_.keep(state_, global_[static_cast<std::size_t>(i)], global_[static_cast<std::size_t>(j)]);
  };
  return search_.update(place_, tags_, keep);
}

/// Moves the water, through no face. Returns the largest move [m].
template <int dim>
double Packing<dim>::move(Vectors<dim>& by) {
  const double least = nearest_face * l0_;
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < movers_; ++i) {
    if (below_level(i) < level_row * l0_) by(1, i) = 0;
    if (const double length = by.col(i).norm(); length > longest_move * l0_)
      by.col(i) *= longest_move * l0_ / length;
    Vector<dim> x = place_.col(i) + by.col(i);
    double& away = away_[static_cast<std::size_t>(i)];
    away -= by.col(i).norm();
    if (away < least) {
      const auto near = body_.nearest(x);
      away = near.distance;
      if (near.distance < least || body_.inside(x)) {
        x = near.position + least * body_.normal(near.point);
        away = 0;  // in a narrow place another face may be nearer
      }
    }
    if (const auto foot = boundary_.tank().behind(x)) x = foot->position + least * foot->normal;
    x[1] = std::min(x[1], level_ - least);
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
  for (int round = 0; round < most_body_rounds; ++round) {
    const Neighbours& near = search(round);
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
      by.col(i) = -packing_strength * l0_ * l0_ * dim / gradient_.n0 * sum;
    }
    const double moved = move(by);
    if (moved < settled_move * l0_) break;
  }
}

/// Refuses a stretch of faces under water without water, and water that is pressed together. In the tip of an
/// acute corner a few faces stay dry.
template <int dim>
void Packing<dim>::check() const {
  const auto refuse = [&](const Vector<dim>& at, const char* problem) {
    throw Error(ExitCode::case_file, "fluid.submerged",
                fmt::format("the water {} at ({:.6g}, {:.6g}{}): a gap there is narrower than two spacings",
                            problem, at[0], at[1], dim == 3 ? fmt::format(", {:.6g}", at[dim - 1]) : ""),
                fmt::format("make the gap between bodies or to a wall {:.3g} m or wider, close it, or refine "
                            "fluid.spacing",
                            2 * l0_));
  };
  const auto nearest_to = [&](const Vector<dim>& x, Eigen::Index but) {
    double square = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < water_; ++i)
      if (i != but)
        square = std::min(square, boundary_.tank().periodic().separation(x, place_.col(i)).squaredNorm());
    return std::sqrt(square);
  };
  for (Eigen::Index i = 0; i < movers_; ++i)
    if (away_[static_cast<std::size_t>(i)] < l0_ && nearest_to(place_.col(i), i) < closest * l0_)
      refuse(place_.col(i), "is pressed together");
  std::vector<Vector<dim>> dry;
  for (int k = 0; k < static_cast<int>(body_.points()); ++k) {
    const Vector<dim> at = body_.point(k), normal = body_.normal(k), before = at + 0.5 * l0_ * normal;
    const Vector<dim> outside = at + covered * l0_ * normal;
    if (level_ - before[1] < l0_ || boundary_.tank().distance(outside) < 0) continue;
    if (is_water_at<dim>(p_, outside) && nearest_to(before, -1) > dry_distance * l0_) dry.push_back(before);
  }
  for (const Vector<dim>& x : dry) {
    const auto beside = [&](const Vector<dim>& y) { return (y - x).norm() < dry_stretch * l0_; };
    if (std::count_if(dry.begin(), dry.end(), beside) > (dim == 2 ? most_dry_in_plane : most_dry_in_space))
      refuse(x, "does not reach the body's face");
  }
}

}  // namespace

template <int dim>
void pack_around(const Parameters& p, Boundary<dim>& boundary, State<dim>& state) {
  if (!water_is_packed(p, boundary)) return;
  Packing<dim> packing(p, boundary, state);
  packing.even_out();
  packing.check();
}

template <int dim>
bool water_is_packed(const Parameters& p, const Boundary<dim>& boundary) {
  return p.submerged && !boundary.body_surface().empty();
}

template <int dim>
bool water_starts_packed(const Parameters& p, const Boundary<dim>& boundary) {
  return water_is_packed(p, boundary) || !boundary.tank().shape().on_lattice();
}

template <int dim>
bool beside_open_side(const Parameters& p, const Boundary<dim>& boundary, const Vector<dim>& x,
                      double radius) {
  const double level = p.water.max[1];
  const int reach = static_cast<int>(std::ceil(radius / p.spacing)) - 1, side = 2 * reach + 1;
  const int all = dim == 2 ? side * side : side * side * side;
  for (int k = 0; k < all; ++k) {
    Vector<dim> at = x;
    for (int d = 0, rest = k; d < dim; ++d, rest /= side) at[d] += p.spacing * (rest % side - reach);
    if (at[1] > level) continue;
    at = boundary.tank().periodic().wrap(at, boundary.tank().shape().low());
    if (is_water_at<dim>(p, at) || !boundary.tank().shape().contains(at)) continue;
    if (!boundary.body_surface().empty() && boundary.body_surface().inside(at)) continue;
    return true;
  }
  return false;
}

/// Whether the face of that wet point reaches under the level, within the distance along the face in which
/// `WallContact` looks for water. Faces that lean over the water do not.
template <int dim>
static bool reaches_water(const Parameters& p, const Boundary<dim>& boundary, int point) {
  const Vector<dim> n = boundary.body_surface().normal(point);
  const double steepness = std::sqrt(std::max(0.0, 1 - n[1] * n[1]));  // sine of the face's slope
  return boundary.body_surface().point(point)[1] - p.spacing * steepness <= p.water.max[1];
}

/// Sets the pressure of still water, p = ρ g (level − y).
template <int dim>
static void press_by_depth(const Parameters& p, const Boundary<dim>& boundary, State<dim>& state) {
  const double slope = -p.density * p.gravity[1];
  for (std::int64_t i = 0; i < boundary.water(); ++i)
    state.pressure[i] = slope * std::max(0.0, p.water.max[1] - state.position(1, i));
}

template <int dim>
void begin_at_rest(const Parameters& p, const Boundary<dim>& boundary, State<dim>& state) {
  state.surface.assign(state.kind.size(), 1);
  if (p.starts_level() || (water_is_packed(p, boundary) && !(p.gravity_ramp > 0)))
    press_by_depth(p, boundary, state);
  // `WallContact` keeps faces wet that have water within a spacing, and dries the others. Packed water stands
  // a little farther from a wall than a lattice. A face that was dry under water would be met later, in a
  // blow.
  const bool packed = water_is_packed(p, boundary), on_lattice = boundary.tank().shape().on_lattice();
  if (!packed && on_lattice) return;
  const std::int64_t bodies = boundary.first_of_bodies();
  for (std::int64_t i = boundary.water(); i < (packed ? state.position.cols() : bodies); ++i) {
    const bool corner = i < bodies && !(boundary.normal_of(i).squaredNorm() > 0);
    if (boundary.master_of(i) >= 0 || (corner && on_lattice)) continue;
    if (i >= bodies && !reaches_water(p, boundary, boundary.point_of(i))) continue;
    state.surface[static_cast<std::size_t>(i)] = 0;
  }
}

template void pack_around<2>(const Parameters&, Boundary<2>&, State<2>&);
template void pack_around<3>(const Parameters&, Boundary<3>&, State<3>&);

template bool water_is_packed<2>(const Parameters&, const Boundary<2>&);
template bool water_is_packed<3>(const Parameters&, const Boundary<3>&);
template bool water_starts_packed<2>(const Parameters&, const Boundary<2>&);
template bool water_starts_packed<3>(const Parameters&, const Boundary<3>&);
template bool beside_open_side<2>(const Parameters&, const Boundary<2>&, const Vector<2>&, double);
template bool beside_open_side<3>(const Parameters&, const Boundary<3>&, const Vector<3>&, double);
template void begin_at_rest<2>(const Parameters&, const Boundary<2>&, State<2>&);
template void begin_at_rest<3>(const Parameters&, const Boundary<3>&, State<3>&);

}  // namespace strake::fluid
