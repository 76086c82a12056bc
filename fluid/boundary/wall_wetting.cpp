#include "fluid/boundary/wall_wetting.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::fluid {

namespace {
/// Heights of water over a face at which the face becomes wet or dry [l0]. A dry face becomes wet below the
/// first, a wet face becomes dry above the second. The first layer of a lattice has the height 0.5.
constexpr double joining_height = 0.52, leaving_height = 1.0;
/// Water whose velocity past a dry face points away from it by more than the first, the sine of 15 degrees,
/// leaves the body there, where a corner is nearer than the second [l0]: it lies beside the first face.
/// Chosen; a slope of 0.1 gives the same, 0.5 is too much for sides of 60 degrees.
constexpr double leaving_slope = 0.26, leaving_reach = 1.5;
/// Distance along the face up to which water counts [l0].
constexpr double aside = 1.01;
/// Distance of a body before a wall below which it covers the wall [l0].
constexpr double covering_distance = 0.1;
/// Places in a wall's face, a square of l0, that tell which part of it a body covers. Place k lies k l0/37
/// along and 6 k l0/37 aside, less whole l0: rows turned by 10 degrees, so that an edge of the body along the
/// lattice or across it passes them one by one. With 37 places the part changes by steps of 0.03.
constexpr int face_places = 37, face_turn = 6;
/// A body farther off covers all of a face or nothing [l0]: more than half the diagonal of the square.
constexpr double half_diagonal = 0.75;
/// How fast a face of a body that stood in the water comes or goes, of v/l0 (F91). Chosen; 1: about the same.
constexpr double fading_rate = 4;
/// A corner becomes wet when water is nearer to it than √2 l0 and this margin [l0]. It has no face: √2 l0 is
/// the distance of the first lattice particle at an edge of two walls. In a corner of three walls that
/// particle is √3 l0 away.
constexpr double corner_margin = 0.02;

/// Returns the direction of the edge between two walls at a layer particle without a normal; zero in a corner
/// of three, and in the plane.
template <int dim>
Vector<dim> edge_at(const Boundary<dim>& boundary, const Vector<dim>& place) {
  Vector<dim> along = Vector<dim>::Zero();
  if constexpr (dim == 3) {
    const Tank<3>& tank = boundary.tank();
    const auto& shape = tank.shape();
    const Vector<3> x = tank.periodic().wrap(tank.in_tank(place), shape.low());
    int inside = 0, free = 0;
    for (int a = 0; a < 3; ++a)
      if (x[a] > shape.low()[a] && x[a] < shape.high()[a]) {
        ++inside;
        free = a;
      }
    if (inside == 1) along = tank.turned(Vector<3>::Unit(free));
  }
  return along;
}
}  // namespace

template <int dim>
WallContact<dim>::WallContact(const Boundary<dim>& boundary, const State<dim>& state, double spacing,
                              double least_speed)
    : spacing_(spacing), least_speed_(least_speed), first_(boundary.water()) {
  const auto n = state.position.cols();
  axis_.setZero(dim, n - first_);
  depth_.setZero(n - first_);
  bare_.setOnes(n - first_);
  corner_.assign(static_cast<std::size_t>(n), 0);
  wet_.assign(static_cast<std::size_t>(n), 0);
  joins_.assign(static_cast<std::size_t>(n), -1);
  for (std::int64_t j = boundary.water(); j < boundary.first_of_bodies(); ++j) {
    axis_.col(j - first_) = boundary.normal_of(j);
    depth_[j - first_] = -boundary.tank().distance(state.position.col(j));
    if (axis_.col(j - first_).squaredNorm() > 0) continue;
    corner_[static_cast<std::size_t>(j)] = 1;
    axis_.col(j - first_) = edge_at<dim>(boundary, state.position.col(j));  // along it r is free
  }
}

template <int dim>
void WallContact<dim>::set_water(std::int64_t water) {
  const auto renumber = [&](auto& column, auto value) {
    const auto layers = std::ssize(column) - first_;
    std::rotate(column.begin(), column.begin() + first_, column.end());
    column.resize(static_cast<std::size_t>(layers));
    column.insert(column.begin(), static_cast<std::size_t>(water), value);
  };
  renumber(corner_, std::uint8_t{0});
  renumber(wet_, std::uint8_t{0});
  joins_.assign(corner_.size(), -1);
  joined_.clear();
  first_ = water;
}

template <int dim>
void WallContact<dim>::place_bodies(const Boundary<dim>& boundary, const State<dim>& state) {
  if (boundary.body_surface().empty()) return;
  for (std::int64_t j = boundary.first_of_bodies(); j < state.position.cols(); ++j) {
    const int k = boundary.point_of(j);
    axis_.col(j - first_) = boundary.body_surface().normal(k);
    depth_[j - first_] = axis_.col(j - first_).dot(boundary.body_surface().point(k) - state.position.col(j));
  }
}

/// Whether water leaves a body at a face: beside a corner where the face begins, with the velocity u past it,
///   u·n > leaving_slope |u| .
/// Water that passes a chine is near the face beyond, and flies away from it. As a face that the water has
/// met, it would hold the water until that is l0 away, and then let it go in one step.
template <int dim>
bool WallContact<dim>::leaves(const Boundary<dim>& boundary, const State<dim>& state, std::int64_t row,
                              std::int64_t particle, const Vector<dim>& place) const {
  const Vector<dim> past = state.velocity.col(particle) - state.velocity.col(row);
  return past.dot(axis_.col(row - first_)) > leaving_slope * past.norm() &&
         std::min(boundary.inside_free_end(boundary.point_of(row), place, false),
                  boundary.inside_chine(boundary.point_of(row), place)) < leaving_reach * spacing_;
}

template <int dim>
typename WallContact<dim>::Nearest WallContact<dim>::nearest_water(const Boundary<dim>& boundary,
                                                                   const State<dim>& state,
                                                                   const Neighbours& near,
                                                                   std::int64_t j) const {
  Nearest nearest{std::numeric_limits<double>::infinity(), -1};
  const bool is_body = j >= boundary.first_of_bodies() && !boundary.volume();
  const bool meets = is_body && state.surface[static_cast<std::size_t>(j)] != 0 && !fades();
  for (const std::int32_t i : near.row(j)) {
    if (i >= boundary.water()) break;
    const Vector<dim> r = boundary.tank().periodic().separation(state.position.col(j), state.position.col(i));
    double height = 0;
    if (corner(j)) {
      height = joining_height - corner_margin + projection(j, r).norm() / spacing_ - std::sqrt(2.0);
    } else {
      const double up = r.dot(axis_.col(j - first_));
      if (r.squaredNorm() - up * up > aside * aside * spacing_ * spacing_) continue;
      height = (up - depth_[j - first_]) / spacing_;
      const Vector<dim> place = state.position.col(j) + r;
      if (is_body && boundary.inside_chine(boundary.point_of(j), place) < 0) continue;
      if (meets && height < joining_height && leaves(boundary, state, j, i, place)) continue;
    }
    if (height < nearest.height) nearest = {height, i};
  }
  return nearest;
}

/// Computes the part of the face of a wall's layer particle that no body covers, from places in that face. A
/// face that dries at once takes a row of pairs from the water: a keel between walls then has a blow each
/// time that it has passed l0. In the plane, where no row of faces dries together, the middle counts for the
/// face.
template <int dim>
double WallContact<dim>::find_bare(const Boundary<dim>& boundary, const State<dim>& state,
                                   std::int64_t j) const {
  const auto& body = boundary.body_surface();
  const Vector<dim> n = axis_.col(j - first_);
  const Vector<dim> before = state.position.col(j) + (depth_[j - first_] + covering_distance * spacing_) * n;
  if constexpr (dim == 2) {
    return body.inside(before) ? 0 : 1;
  } else {
    if (!(body.near(before, half_diagonal * spacing_).distance < half_diagonal * spacing_))
      return body.inside(before) ? 0 : 1;
    const Vector<3> across = std::abs(n.z()) > 0.5 ? Vector<3>::UnitX() : Vector<3>::UnitZ();
    const Vector<3> v = spacing_ * n.cross(across).normalized(), u = v.cross(n);
    int open = 0;
    for (int k = 0; k < face_places; ++k) {
      const double along = (k + 0.5) / face_places - 0.5,
                   aside = (k * face_turn % face_places + 0.5) / face_places - 0.5;
      open += body.inside(before + along * u + aside * v) ? 0 : 1;
    }
    return static_cast<double>(open) / face_places;
  }
}

/// Computes the part with which a body's face counts after that time (F91). It goes from 0 to 1 and back with
///   4 max(v, |u_n|)/l0 ,
/// v the least speed, u_n that of the nearest water past the face, along the normal.
template <int dim>
double WallContact<dim>::faded(const State<dim>& state, std::int64_t row, std::int64_t nearest, double part,
                               double time, bool is_wet) const {
  double speed = least_speed_;
  if (nearest >= 0) {
    const Vector<dim> past = state.velocity.col(nearest) - state.velocity.col(row);
    speed = std::max(speed, std::abs(past.dot(axis_.col(row - first_))));
  }
  const double change = fading_rate * speed / spacing_ * time;
  return std::clamp(part + (is_wet ? change : -change), 0.0, 1.0);
}

/// Lists the layer particles whose faces have become wet, those behind the first layer too.
template <int dim>
void WallContact<dim>::list_joined(const Boundary<dim>& boundary, const State<dim>& state) {
  joined_.clear();
  for (std::int64_t j = boundary.first_of_bodies(); j < state.position.cols(); ++j) {
    const std::int32_t master = boundary.master_of(j);
    const std::int64_t nearest = joins_[static_cast<std::size_t>(master < 0 ? j : master)];
    if (nearest >= 0) joined_.push_back({j, nearest});
  }
}

template <int dim>
void WallContact<dim>::update(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& near,
                              double time, std::span<const std::uint8_t> aired,
                              const RankExchange<dim>& ranks) {
  if (boundary.tank().moves())
    for (std::int64_t j = boundary.water(); j < boundary.first_of_bodies(); ++j)
      axis_.col(j - first_) =
          corner(j) ? edge_at<dim>(boundary, state.position.col(j)) : boundary.normal_of(j);
  place_bodies(boundary, state);
  const auto n = static_cast<std::int64_t>(state.kind.size());
  const std::int64_t bodies = boundary.first_of_bodies();
  const bool begins = fades() && state.wet_part.size() != n - bodies;
  if (begins) state.wet_part.setZero(n - bodies);
  double gap = std::numeric_limits<double>::infinity();  // [l0]
#pragma omp parallel for schedule(static) reduction(min : gap)
  for (std::int64_t j = boundary.water(); j < n; ++j) {
    const auto k = static_cast<std::size_t>(j);
    if (boundary.master_of(j) >= 0 || state.kind[k] == Kind::solid) continue;
    const Nearest nearest = nearest_water(boundary, state, near, j);
    const bool was_dry = state.surface[k] != 0;
    bool is_wet = nearest.height < (was_dry ? joining_height : leaving_height);
    if (is_wet && j < boundary.first_of_bodies() && !corner(j) && !boundary.body_surface().empty()) {
      // The wall is dry behind a body that touches it, even where water is near the body's corner.
      bare_[j - first_] = find_bare(boundary, state, j);
      is_wet = bare_[j - first_] > 0;
    }
    if (!aired.empty() && j >= boundary.first_of_bodies())
      is_wet = is_wet && !aired[static_cast<std::size_t>(boundary.point_of(j))];
    const bool joins = is_wet && was_dry && state.step > 0 && j >= bodies && !fades();
    if (!is_wet && j >= bodies) gap = std::min(gap, nearest.height - joining_height);
    joins_[k] = joins && !boundary.volume() ? nearest.particle : -1;
    state.surface[k] = is_wet ? 0 : 1;
    wet_[k] = is_wet ? 1 : 0;
    if (!fades() || j < bodies) continue;
    const double part = state.wet_part[j - bodies];
    bare_[j - first_] = begins ? wet_[k] : faded(state, j, nearest.particle, part, time, is_wet);
    wet_[k] = bare_[j - first_] > 0 ? 1 : 0;
  }
  contact_gap_ = spacing_ * gap;
  ranks.update_layers(state.surface, boundary.water());
  ranks.update_layers(wet_, boundary.water());
  if (!boundary.body_surface().empty()) ranks.update_layers(bare_, 0);
  for (std::int64_t j = boundary.water(); j < n; ++j)
    if (const std::int32_t m = boundary.master_of(j); m >= 0) {
      wet_[static_cast<std::size_t>(j)] = wet_[static_cast<std::size_t>(m)];
      bare_[j - first_] = bare_[m - first_];
    }
  if (fades()) state.wet_part = bare_.tail(n - bodies);
  list_joined(boundary, state);
}

template class WallContact<2>;
template class WallContact<3>;

}  // namespace strake::fluid
