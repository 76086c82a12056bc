#pragma once

#include "fluid/boundary/tank.hpp"
#include "fluid/geometry/body_surface_2d.hpp"
#include "fluid/geometry/body_surface_3d.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

namespace strake::fluid {

/// The wetted surface of moving bodies: a closed line in the plane, a closed surface in space.
template <int dim>
using BodySurface = std::conditional_t<dim == 2, BodySurface2d, BodySurface3d>;

/// Returns the distance of x to a body's faces, infinity beyond `limit` [m].
template <int dim>
double distance_to(const BodySurface<dim>& body, const Vector<dim>& x, double limit) {
  double distance;
  if constexpr (dim == 2)
    distance = body.nearest(x).distance;
  else
    distance = body.near(x, limit).distance;
  return distance <= limit ? distance : std::numeric_limits<double>::infinity();
}

/// Walls, moving bodies and, in volume coupling, the structure's own particles. Order of particles: water,
/// tank layers, then bodies.
///
/// A body's face has layers of particles along its inward normal. The first, l0/2 behind the face, has a
/// pressure unknown with the MPS scheme; the deeper ones complete the support. Layers belong to one edge of
/// the body's surface. A pair of water and layer particle counts when its segment crosses that edge. So a
/// plate thinner than the support keeps the water above and below apart, and a corner is not counted twice
/// (fluid/THEORY.md, section 10). At corners with an interior angle above 90° each face's layers continue
/// past the corner. In space the edges are the patches of a BodySurface3d, and the corners lie between them.
template <int dim>
class Boundary {
 public:
  /// Appends the particles of the bodies to `tank`, which has the water and the tank layers of `fill`. Throws
  /// Error(case_file) when a body leaves the tank.
  Boundary(const Parameters&, const InterfaceMesh& partner, const Points& initial_velocity, State<dim>& tank);

  /// Throws Error(case_file) when a body overlaps the water.
  void check_overlap(const State<dim>&) const;

  const InterfaceMesh& mesh() const { return mesh_; }
  const BodySurface<dim>& body_surface() const { return body_surface_; }  // empty in volume coupling
  /// Places on the bodies that layers belong to: wet points, in volume coupling the structure's particles.
  std::int64_t points() const {
    return body_surface_.empty() ? mesh_.position.cols() : body_surface_.points();
  }
  /// Sums over those places, dim×points, as sums over the points of `mesh`, 3×m.
  Points on_mesh(const Vectors<dim>& on_points) const;
  /// What is given on the points of `mesh`, at one of those places.
  Vector<dim> at_point(const Points& on_mesh, int point) const;
  bool volume() const { return volume_; }
  std::int64_t water() const { return water_; }  // particles [0, water) are water
  /// Renumbers all layer particles, which follow that many water particles.
  void set_water(std::int64_t water);
  /// Keeps the tank's layer particles with these numbers alone (`Tank::select`), which `state` has. Returns
  /// whether others were kept before.
  bool select_tank_layers(std::span<const std::int64_t> numbers, const State<dim>& state);
  std::int64_t first_of_bodies() const { return bodies_; }           // [water, first_of_bodies) are the tank
  const Eigen::VectorXd& solid_density() const { return density_; }  // of the last particles, [bodies, end)

  /// Place on the body, one of `points`, that particle i belongs to; −1: none.
  int point_of(std::int64_t i) const {
    return i < bodies_ ? -1 : point_of_[static_cast<std::size_t>(i - bodies_)];
  }
  /// First-layer particle whose pressure dummy i extends; −1: i is no dummy.
  std::int32_t master_of(std::int64_t i) const {
    return i < water_ ? -1 : master_[static_cast<std::size_t>(i - water_)];
  }
  /// Whether i is a structure particle whose own neighbourhood is complete. Water does not touch it, so it
  /// has no unknown unless a crack exposes it.
  bool buried(std::int64_t i) const {
    return i >= bodies_ && buried_[static_cast<std::size_t>(i - bodies_)] != 0;
  }

  /// Puts the bodies at that motion of the interface points. positions = false: velocities alone, at the old
  /// places.
  void move(State<dim>&, const Points& displacement, const Points& velocity, bool positions);
  /// The tank's layers in a step that ends at `time`: first their velocities (positions = false), then their
  /// places.
  void move_tank(State<dim>& state, double time, bool positions) { tank_.move(state, time, positions); }
  /// Adopts the places that `state` was saved with.
  void adopt(const State<dim>& state);

  /// Returns the tags of the particles for the neighbour search. owned: mask, particles of
  /// this rank; other water has no rows; empty: all are. absent_layers: mask, layer particles that have no
  /// pairs; empty: none.
  std::span<const std::uint8_t> tags(const State<dim>&, std::span<const std::uint8_t> owned = {},
                                     std::span<const std::uint8_t> absent_layers = {});
  /// Whether a pair counts. around: one of water that a corner comes between counts while the way around the
  /// corner is within reach.
  bool keep(const State<dim>&, std::int32_t i, std::int32_t j, bool around = false) const;
  /// Whether x is within `distance` of the box around the bodies.
  bool near_bodies(const Vector<dim>& x, double distance) const {
    const Vector<dim> low = body_surface_.low().array() - distance,
                      high = body_surface_.high().array() + distance;
    return any_image(x, [&](const Vector<dim>& y) {
      return (y.array() >= low.array()).all() && (y.array() <= high.array()).all();
    });
  }
  /// Whether particle i is within a pair's reach of a body's corner; in space of a keel or a blunt edge.
  bool beside_corner(const State<dim>& state, std::int64_t i) const {
    return any_image(state.position.col(i),
                     [this](const Vector<dim>& x) { return body_surface_.beside_corner(x, reach_); });
  }
  /// Returns that way between water particles i and j [m]; infinity where the body separates them.
  double way_around(const State<dim>&, std::int64_t i, std::int64_t j) const;

  /// Corrects the number density of a body's first layer, whose own layers end at corners:
  ///   n_i ← n0 + Σ_water w − the same sum under a flat water surface at l0.
  /// Only water counts.
  void count_water(const State<dim>&, const Neighbours&, const LatticeConstants&, Eigen::VectorXd& n) const;

  /// Treats water and a body's face as apart until they are nearer than 1.02 l0, along the normal. Until then
  /// a particle that was surface before stays surface, and a dry layer particle stays dry, whatever the
  /// surface test gives. A pair that counts as touching over a wider gap gets an impulse from the symmetric
  /// pressure gradient. Plane bodies alone.
  void keep_contact_open(const State<dim>&, const Neighbours& near, std::span<const std::uint8_t> before,
                         std::span<std::uint8_t> surface) const;

  /// Neumann condition P_d = P_w + ρ(g − a_w)·(r_d − r_w) on dummy layers; 0 behind a dry first layer.
  void fill_dummies(State<dim>&, const Vector<dim>& gravity, const Points& acceleration) const;

  const Tank<dim>& tank() const { return tank_; }
  /// Returns the normal, into the water, of the tank wall in front of layer particle i. It is zero in corners
  /// and for particles that are not of the tank.
  Vector<dim> normal_of(std::int64_t i) const { return tank_.normal_of(i); }
  /// Whether x lies over the face of that wet point: not past the ends of its edge.
  bool is_over(int point, const Vector<dim>& x) const {
    if constexpr (dim == 2)
      return body_surface_.within(body_surface_.edge_of(point), beside(point, x)) >= 0;
    else
      return body_surface_.faces(point, beside(point, x));
  }
  /// Returns the distance of x from the nearest end of the face of that wet point, along the face [m]. It is
  /// negative past the end, and infinite where no end is near. Where the body goes on over a seam is no end.
  double within(int point, const Vector<dim>& x) const;
  /// Whether a body that ends there, at a seam of the tank, goes on from the other side of the seam.
  bool goes_on_over_seam(const Vector<dim>& place) const;
  /// Whether that face has sharp corners at all its ends: of at most a right angle, and no keels. Those of
  /// plates and boxes have. In space it is plane as well.
  bool is_between_sharp_corners(int point) const {
    if constexpr (dim == 2)
      return body_surface_.is_between_sharp_corners(body_surface_.edge_of(point));
    else
      return body_surface_.is_between_sharp_corners(point);
  }
  /// Whether that face belongs to a curved part of the surface, in the reference.
  bool is_curved(int point) const {
    if constexpr (dim == 2)
      return body_surface_.is_curved(body_surface_.edge_of(point));
    else
      return body_surface_.is_curved(point);
  }
  /// Returns the same distance from the nearest free end [m]: a corner that does not stand at a wall.
  /// only_sharp: of at most a right angle, and no keel.
  double inside_free_end(int point, const Vector<dim>& x, bool only_sharp = true) const;
  /// Returns the distance of x inside the plane that halves the nearest chine of that face (`Bend::chine`),
  /// along the face [m]. It is negative past it, and infinite where none is near.
  double inside_chine(int point, const Vector<dim>& x) const {
    return body_surface_.inside_chine(point, beside(point, x));
  }
  /// Returns the same distance from the nearest keel of at most a right angle [m]; infinity in the plane.
  double inside_keel(int point, const Vector<dim>& x) const {
    if constexpr (dim == 2)
      return std::numeric_limits<double>::infinity();
    else
      return body_surface_.inside_keel(point, beside(point, x));
  }
  /// Area vector of a tank wall particle, towards the water [m, m² in 3-D].
  Vector<dim> wall_area(const State<dim>&, std::int64_t i) const { return tank_.area_of(i); }
  /// The same of the face in front of a first-layer particle, of tank or body.
  Vector<dim> face_area(std::int64_t row) const;

  /// Whether particle i has been removed because it left the tank. Each removed particle has a place of its
  /// own, out of reach of all others.
  bool is_removed(const State<dim>& state, std::int64_t i) const {
    return i < water_ && tank_.is_removed(state.position.col(i));
  }
  bool left_domain(const Vector<dim>& x) const { return tank_.left(x); }
  Vector<dim> place_of_removed(std::int64_t number) const { return tank_.place_of_removed(number); }

 private:
  /// Returns the image of x beside that wet point: over a seam, where that is nearer.
  Vector<dim> beside(int point, Vector<dim> x) const {
    if (!around_.any()) return x;
    const Vector<dim> r = x - body_surface_.point(point);
    for (int d = 0; d < dim; ++d) x[d] += around_.nearest(r[d], d) - r[d];
    return x;
  }
  /// Whether is_one(image) holds for x or one of its images over the seams.
  template <class IsOne>
  bool any_image(const Vector<dim>& x, const IsOne& is_one, int direction = 0) const {
    if (direction == dim) return is_one(x);
    if (any_image(x, is_one, direction + 1)) return true;
    if (!around_.along(direction)) return false;
    const Vector<dim> over = around_.length()[direction] * Vector<dim>::Unit(direction);
    return any_image(x + over, is_one, direction + 1) || any_image(x - over, is_one, direction + 1);
  }
  void find_seams();
  int layers() const { return static_cast<int>(std::ceil(reach_ / spacing_ - 0.5)); }  // behind a face
  /// A layer particle past a corner: `beside` it along the face, `depth` behind the face.
  struct BeyondCorner {
    int point, vertex;     // the last of the edge before the corner, and the corner
    double beside, depth;  // [m]; beside is negative before an edge's start
  };
  /// Calls visit(from, to) with the ends of the straight way from particle a to b. Over a seam it has two
  /// images, one from a and one to b: what lies on the way, a body or the nearest place of an edge, is met by
  /// one of them.
  template <class Visit>
  void for_each_straight_way(const State<dim>&, std::int64_t a, std::int64_t b, const Visit&) const;
  /// Whether the body lies between two particles that are not of the body.
  bool separates(const State<dim>&, std::int64_t a, std::int64_t b) const;
  void add_layers(const InterfaceMesh& partner, const Knuckles&, State<dim>&);
  void place_layers(State<dim>&, bool positions) const;
  /// allowed: how far beyond a wall or a periodic end a point may lie [m].
  void check_place(const State<dim>&, const Points& place, double allowed) const;
  void go_beyond(const BodySurface2d::Edge&, bool at_end);
  void add_solids(const InterfaceMesh& partner, const Points& initial_velocity, State<dim>&);
  void find_masters(const State<dim>&);
  void check_reach() const;

  double spacing_, water_density_;
  double reach_, counting_radius_;  // largest radius, and that of the number density [m]
  Tank<dim> tank_;
  Periodic<dim> around_;  // the directions in which water meets a body over a seam
  InterfaceMesh mesh_;
  BodySurface<dim> body_surface_;
  bool volume_ = false;
  bool built_ = false;  // before that a wrong place is a fault of the case
  std::int64_t water_, bodies_;
  std::vector<BeyondCorner> beyond_;
  Eigen::VectorXd density_;    // of the structure's particles in volume coupling [kg/m³]
  std::vector<int> point_of_;  // of the bodies' particles
  std::vector<std::int32_t>
      master_;  // of all that is no water; of a dummy: the first-layer particle it extends
  std::vector<std::uint8_t> buried_;  // of the bodies' particles
  std::vector<std::uint8_t> tag_;
  std::vector<int> triangle_near_;  // in space: of what is no body, nearest within reach; −1: none
  Eigen::VectorXd flat_water_;      // Σ_water w of each interface point under a flat surface at l0
};

}  // namespace strake::fluid
