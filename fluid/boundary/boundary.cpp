#include "fluid/boundary/boundary.hpp"

#include "proto/error.hpp"
#include "proto/geometry/corner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace strake::fluid {

namespace {

/// Distance along the normal at which the first layers of water and body touch [l0], and the largest distance
/// aside.
constexpr double contact_distance = 1.02, contact_aside = 0.75;

bool is_filler(Kind kind) {
  return kind == Kind::dummy_wall || kind == Kind::dummy_interface;
}
bool is_row_of_body(Kind kind) {
  return kind == Kind::interface || kind == Kind::dummy_interface;
}

double largest_reach(const Parameters& p) {
  const Scheme& s = p.scheme;
  return p.spacing * std::max({s.radius_density, s.radius_gradient, s.radius_divergence, s.radius_laplacian});
}

}  // namespace

template <int dim>
Boundary<dim>::Boundary(const Parameters& p, const InterfaceMesh& partner, const Points& initial_velocity,
                        State<dim>& tank)
    : spacing_(p.spacing),
      water_density_(p.density),
      reach_(largest_reach(p)),
      counting_radius_(p.scheme.radius_density * p.spacing),
      tank_(p, reach_, tank),
      water_(tank_.first()),
      bodies_(tank_.last()) {
  mesh_.dimension = dim;
  if (partner.position.cols() > 0) {
    volume_ = p.interface == "volume";
    if (volume_)
      add_solids(partner, initial_velocity, tank);
    else {
      // A mesh in mm would be divided into a thousand times as many pieces first.
      check_place(tank, partner.position, 2 * spacing_);
      add_layers(partner, p.submerged ? knuckles_under_water : Knuckles{}, tank);
    }
  }
  const auto n = tank.position.cols();
  point_of_.resize(static_cast<std::size_t>(n - bodies_), -1);
  buried_.resize(static_cast<std::size_t>(n - bodies_), 0);
  if (volume_) {
    density_.setConstant(n - bodies_, p.density);
    if (partner.mass.size()) density_ = partner.mass / std::pow(p.spacing, dim);
  }
  find_seams();
  find_masters(tank);
  check_reach();
  built_ = true;
}

template <int dim>
void Boundary<dim>::move(State<dim>& state, const Points& displacement, const Points& velocity,
                         bool positions) {
  const auto m = mesh_.position.cols();
  if (m == 0) return;
  assert(displacement.cols() == m && velocity.cols() == m);
  if (positions) {
    state.interface_displacement = displacement.template topRows<dim>();
    state.interface_velocity = velocity.template topRows<dim>();
  }
  if (volume_) {
    state.velocity.rightCols(m) = velocity.template topRows<dim>();
    if (positions) state.position.rightCols(m) = (mesh_.position + displacement).template topRows<dim>();
    return;
  }
  if (body_surface_.empty()) return;
  if constexpr (dim == 2) {
    body_surface_.move(positions ? displacement.topRows<2>() : state.interface_displacement,
                       velocity.topRows<2>());
    if (positions) {
      Points wet = Points::Zero(3, body_surface_.points());
      for (int k = 0; k < body_surface_.points(); ++k) wet.col(k).head<2>() = body_surface_.point(k);
      check_place(state, wet, spacing_);
    }
  } else {
    body_surface_.move(displacement, velocity, positions);
    if (positions) check_place(state, mesh_.position + displacement, spacing_);
  }
  place_layers(state, positions);
}

template <int dim>
void Boundary<dim>::check_place(const State<dim>& state, const Points& place, double allowed) const {
  for (Eigen::Index k = 0; k < place.cols(); ++k) {
    const Vector<dim> x = place.col(k).template head<dim>();
    // Water beyond a seam meets the faces of a body on this side, but nothing keeps it out of what goes over.
    const bool past_seam = tank_.past_seam(x) > allowed;
    if (!past_seam && tank_.distance(x) >= -allowed) continue;
    const std::string at = fmt::format("({:.6g}, {:.6g}{})", place(0, k), place(1, k),
                                       dim == 3 ? fmt::format(", {:.6g}", place(2, k)) : ""),
                      beyond = past_seam ? "periodic ends" : "walls";
    if (!built_)
      throw Error(ExitCode::case_file, fmt::format("structure, t = {:.6g} s", state.time),
                  fmt::format("the body starts at {} m, beyond the {} of the tank", at, beyond),
                  "move the body, or enlarge fluid.tank; all lengths are in m, also those of a program of "
                  "your own: 1 mm is 0.001");
    throw Error(ExitCode::solver_fault, fmt::format("structure, t = {:.6g} s", state.time),
                fmt::format("the body has come to {} m, a spacing beyond the {} of the tank", at, beyond),
                past_seam
                    ? "end the run before it gets there, or make fluid.tank longer: no body goes over a seam"
                    : "end the run before it touches them, or make fluid.tank larger: bodies do not rebound "
                      "from walls, and loads since then are not to be used");
  }
}

template <int dim>
void Boundary<dim>::place_layers(State<dim>& state, bool positions) const {
  if constexpr (dim == 3) {
    const auto& particles = body_surface_.layer_particles();
    for (std::size_t r = 0; r < particles.size(); ++r) {
      const auto i = bodies_ + static_cast<std::int64_t>(r);
      state.velocity.col(i) = body_surface_.velocity(particles[r]);
      if (positions) state.position.col(i) = body_surface_.place(particles[r]);
    }
  } else {
    const int m = body_surface_.points();
    for (int layer = 0; layer < layers(); ++layer) {
      const double depth = (layer + 0.5) * spacing_;
      for (int k = 0; k < m; ++k) {
        const std::int64_t i = bodies_ + static_cast<std::int64_t>(layer) * m + k;
        state.velocity.col(i) = body_surface_.velocity(k) - depth * body_surface_.normal_rate(k);
        if (positions) state.position.col(i) = body_surface_.point(k) - depth * body_surface_.normal(k);
      }
    }
    // Beyond a corner: from the corner along the face, t = (−n_y, n_x).
    std::int64_t i = bodies_ + static_cast<std::int64_t>(layers()) * m;
    for (const BeyondCorner& filler : beyond_) {
      const Vector<2> n = body_surface_.normal(filler.point), rate = body_surface_.normal_rate(filler.point);
      state.velocity.col(i) = body_surface_.vertex_velocity(filler.vertex) +
                              filler.beside * Vector<2>(-rate.y(), rate.x()) - filler.depth * rate;
      if (positions)
        state.position.col(i) =
            body_surface_.vertex(filler.vertex) + filler.beside * Vector<2>(-n.y(), n.x()) - filler.depth * n;
      ++i;
    }
  }
}

template <int dim>
void Boundary<dim>::adopt(const State<dim>& state) {
  tank_.adopt(state);
  if (body_surface_.empty()) return;
  if constexpr (dim == 2)
    body_surface_.move(state.interface_displacement, state.interface_velocity);
  else
    body_surface_.move(state.interface_displacement, state.interface_velocity, true);
}

template <int dim>
Points Boundary<dim>::on_mesh(const Vectors<dim>& on_points) const {
  Points sum = Points::Zero(3, on_points.cols());
  sum.template topRows<dim>() = on_points;
  if constexpr (dim == 3) {
    if (!body_surface_.empty()) return body_surface_.spread(sum);
  }
  return sum;
}

template <int dim>
Vector<dim> Boundary<dim>::at_point(const Points& on_mesh, int point) const {
  if constexpr (dim == 3) {
    if (!body_surface_.empty()) return body_surface_.at(on_mesh, point);
  }
  return on_mesh.col(point).template head<dim>();
}

template <int dim>
void Boundary<dim>::set_water(std::int64_t water) {
  const std::int64_t shift = water - water_;
  tank_.set_first(water);
  water_ += shift;
  bodies_ += shift;
  for (std::int32_t& master : master_)
    if (master >= 0) master = static_cast<std::int32_t>(master + shift);
}

template <int dim>
bool Boundary<dim>::select_tank_layers(std::span<const std::int64_t> numbers, const State<dim>& state) {
  if (!tank_.select(numbers)) return false;
  bodies_ = tank_.last();
  find_masters(state);
  return true;
}

template <int dim>
Vector<dim> Boundary<dim>::face_area(std::int64_t row) const {
  if (row < bodies_) return tank_.area_of(row);
  const int k = point_of(row);
  if constexpr (dim == 2)
    return body_surface_.area(k) * body_surface_.normal(k);
  else
    return body_surface_.area_vector(k);
}

template <int dim>
std::span<const std::uint8_t> Boundary<dim>::tags(const State<dim>& state,
                                                  std::span<const std::uint8_t> owned,
                                                  std::span<const std::uint8_t> absent_layers) {
  const auto n = static_cast<std::size_t>(state.position.cols());
  tag_.assign(n, plain);
  for (std::size_t i = static_cast<std::size_t>(water_); i < n; ++i)
    if (is_filler(state.kind[i])) tag_[i] = filler;
  for (std::size_t i = 0; !owned.empty() && i < static_cast<std::size_t>(water_); ++i)
    if (!owned[i]) tag_[i] = passive;
  for (std::size_t k = 0; k < absent_layers.size(); ++k)
    if (absent_layers[k]) tag_[static_cast<std::size_t>(water_) + k] |= absent;
  if (body_surface_.empty()) return tag_;
  // A pair that crosses the surface has one end near the surface. In the plane that end lies within half the
  // pair's length of the bounding box, in space within that distance of the surface itself.
  for (std::size_t i = static_cast<std::size_t>(bodies_); i < n; ++i) tag_[i] |= asked;
  if constexpr (dim == 2) {
    const Vector<2> low = body_surface_.low().array() - 0.5 * reach_,
                    high = body_surface_.high().array() + 0.5 * reach_;
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < bodies_; ++i)
      if (any_image(state.position.col(i), [&](const Vector<2>& x) {
            return (x.array() >= low.array()).all() && (x.array() <= high.array()).all();
          }))
        tag_[static_cast<std::size_t>(i)] |= asked;
  } else {
    triangle_near_.assign(static_cast<std::size_t>(bodies_), -1);
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < bodies_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      double distance = std::numeric_limits<double>::infinity();
      any_image(state.position.col(i), [&](const Vector<3>& x) {
        const auto near = body_surface_.near(x, reach_);
        if (near.distance < distance) triangle_near_[k] = near.triangle;
        distance = std::min(distance, near.distance);
        return false;
      });
      if (distance <= 0.5 * reach_) tag_[k] |= asked;
    }
  }
  return tag_;
}

template <int dim>
bool Boundary<dim>::keep(const State<dim>& state, std::int32_t i, std::int32_t j, bool around) const {
  const bool i_row = is_row_of_body(state.kind[static_cast<std::size_t>(i)]);
  const bool j_row = is_row_of_body(state.kind[static_cast<std::size_t>(j)]);
  if (i_row && j_row)
    return dim == 2 && body_surface_.edge_of(point_of(i)) == body_surface_.edge_of(point_of(j));
  const std::int32_t row = i_row ? i : j, other = i_row ? j : i;
  if ((i_row || j_row) && other >= water_) return false;
  if constexpr (dim == 2) {
    if (i_row || j_row)
      return body_surface_.crosses(point_of(row), beside(point_of(row), state.position.col(other)),
                                   state.position.col(row));
    if (around) return way_around(state, i, j) < reach_;
    return !separates(state, std::min(i, j), std::max(i, j));
  } else {
    const auto near = [&](std::int32_t k) { return triangle_near_[static_cast<std::size_t>(k)]; };
    if (i_row || j_row)
      return body_surface_.crosses(point_of(row), near(other),
                                   beside(point_of(row), state.position.col(other)), state.position.col(row));
    const auto [a, b] = std::minmax(i, j);
    if (!separates(state, a, b)) return true;
    return around && b < water_ && way_around(state, a, b) < reach_;
  }
}

template <int dim>
template <class Visit>
void Boundary<dim>::for_each_straight_way(const State<dim>& state, std::int64_t a, std::int64_t b,
                                          const Visit& visit) const {
  const Vector<dim> from = state.position.col(a), to = state.position.col(b),
                    r = tank_.periodic().separation(from, to);
  if (r == to - from) return visit(from, to);
  visit(from, Vector<dim>(from + r));
  visit(Vector<dim>(to - r), to);
}

template <int dim>
bool Boundary<dim>::separates(const State<dim>& state, std::int64_t a, std::int64_t b) const {
  bool separated = false;
  for_each_straight_way(state, a, b, [&](const Vector<dim>& from, const Vector<dim>& to) {
    if constexpr (dim == 3)
      separated = separated || body_surface_.separates(from, triangle_near_[static_cast<std::size_t>(a)], to,
                                                       triangle_near_[static_cast<std::size_t>(b)]);
    else
      separated = separated || body_surface_.separates(from, to);
  });
  return separated;
}

template <int dim>
double Boundary<dim>::way_around(const State<dim>& state, std::int64_t i, std::int64_t j) const {
  const auto [a, b] = std::minmax(i, j);
  if constexpr (dim == 2) {
    double way = 0;  // the longer of both images: the body is on one of them
    for_each_straight_way(state, a, b, [&](const Vector<dim>& from, const Vector<dim>& to) {
      way = std::max(way, body_surface_.way_around(from, to));
    });
    return way;
  } else {
    if (!separates(state, a, b))
      return tank_.periodic().separation(state.position.col(a), state.position.col(b)).norm();
    const int near_a = triangle_near_[static_cast<std::size_t>(a)],
              near_b = triangle_near_[static_cast<std::size_t>(b)];
    double way = std::numeric_limits<double>::infinity();
    for_each_straight_way(state, a, b, [&](const Vector<dim>& from, const Vector<dim>& to) {
      way = std::min(way, body_surface_.way_around(from, near_a, to, near_b));
    });
    return way;
  }
}

template <int dim>
void Boundary<dim>::count_water(const State<dim>&, const Neighbours& rows, const LatticeConstants& lattice,
                                Eigen::VectorXd& n) const {
  if (body_surface_.empty() || flat_water_.size() == 0) return;
  for (int k = 0; k < body_surface_.points(); ++k) {
    const std::int64_t i = bodies_ + k;
    const auto columns = rows.row(i);
    const auto distances = rows.distances(i);
    double water = 0;
    for (std::size_t e = 0; e < columns.size() && columns[e] < water_; ++e)
      water += weight(distances[e], lattice.radius);
    n[i] = lattice.n0 + water - flat_water_[k];
  }
}

template <int dim>
void Boundary<dim>::keep_contact_open(const State<dim>& state, const Neighbours& near,
                                      std::span<const std::uint8_t> before,
                                      std::span<std::uint8_t> surface) const {
  if constexpr (dim == 2) {
    const double meeting = contact_distance * spacing_, aside = contact_aside * spacing_;
    std::vector<std::uint8_t> opposed(static_cast<std::size_t>(water_),
                                      0);  // 1: opposite a face, 2: touching it
    for (int k = 0; k < body_surface_.points(); ++k) {
      const auto i = static_cast<std::size_t>(bodies_ + k);
      const auto apart_of = [&](std::int32_t j) {  // along the normal; infinite for water too far aside
        const Vector<2> r = state.position.col(j) - state.position.col(bodies_ + k);
        const double apart = r.dot(body_surface_.normal(k));
        return r.squaredNorm() - apart * apart > aside * aside ? std::numeric_limits<double>::infinity()
                                                               : apart;
      };
      double nearest = std::numeric_limits<double>::infinity();
      for (const std::int32_t j : near.row(bodies_ + k)) {
        if (j >= water_) break;
        nearest = std::min(nearest, apart_of(j));
      }
      const bool touches = nearest <= meeting;
      for (const std::int32_t j : near.row(bodies_ + k)) {
        if (j >= water_) break;
        if (apart_of(j) > nearest + 0.5 * spacing_) continue;  // behind the water's first layer
        auto& mark = opposed[static_cast<std::size_t>(j)];
        mark = std::max<std::uint8_t>(mark, apart_of(j) <= meeting ? 2 : 1);
      }
      if (before[i] && !touches) surface[i] = 1;
    }
    for (std::size_t j = 0; j < opposed.size(); ++j)
      if (opposed[j] == 1 && before[j]) surface[j] = 1;
  }
}

template <int dim>
void Boundary<dim>::fill_dummies(State<dim>& state, const Vector<dim>& gravity,
                                 const Points& acceleration) const {
  const auto n = state.position.cols();
  for (std::int64_t i = water_; i < n; ++i) {
    const std::int32_t w = master_of(i);
    if (w < 0) continue;
    if (state.surface[static_cast<std::size_t>(w)]) {
      state.pressure[i] = 0;
      continue;
    }
    Vector<dim> field = gravity - tank_.acceleration_of(i);
    if (w >= bodies_ && acceleration.cols() > 0) field -= at_point(acceleration, point_of(w));
    state.pressure[i] =
        state.pressure[w] + water_density_ * field.dot(state.position.col(i) - state.position.col(w));
  }
}

template class Boundary<2>;
template class Boundary<3>;

}  // namespace strake::fluid
