#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace strake::fluid {

/// A particle that represents a piece of the tank's wall.
template <int dim>
struct WallParticle {
  Vector<dim> position;
  Vector<dim> normal = Vector<dim>::Zero();     // of the face, into the water; zero where two faces meet
  Vector<dim> area = Vector<dim>::Zero();       // of the faces it represents, into the water [m, m² in 3-D]
  Vector<dim> absorbing = Vector<dim>::Zero();  // sum of the normals of its absorbing faces
  bool floor = false;                           // below the water: its load counts as the floor's
};
template <int dim>
struct WallParticles {
  std::vector<WallParticle<dim>> wall;   // the layer l0/2 behind the faces
  std::vector<WallParticle<dim>> dummy;  // the layers behind it
};

/// The place on the face to which a place behind a wall belongs.
template <int dim>
struct WallFoot {
  Vector<dim> position, normal;  // on the face; into the water
};

/// The faces of the tank before any motion: a box, or in the plane a polygon. A box may be open at the top
/// and periodic along an axis; an open polygon has no wall from its last corner to its first. Behind each
/// face are layers of particles at (k + ½) l0.
///
/// Layers of a polygon run parallel to its faces, divided evenly between the mitres of its corners. At the
/// solid corners that protrude into the water the layers of both faces end at the mitre, so that no place is
/// counted twice. On a right angle they are the lattice.
template <int dim>
class TankShape {
 public:
  explicit TankShape(const Parameters&);

  WallParticles<dim> particles(int dummy_rows) const;
  /// Calls visit(particle, is in the first layer) for the same particles, each layer in the same order. Those
  /// of a box are not stored.
  using VisitParticle = std::function<void(const WallParticle<dim>&, bool)>;
  void for_each_particle(int dummy_rows, const VisitParticle& visit) const;
  /// Distance to the nearest wall [m], negative behind it. Open and periodic sides are no walls.
  double distance(const Vector<dim>& x) const;
  /// Whether x lies between the walls, or above an open side.
  bool contains(const Vector<dim>& x) const { return distance(x) >= 0; }
  /// Whether x is more than l0 behind a wall, or above an open side by three times the tank's height.
  bool left(const Vector<dim>& x) const;
  /// Returns the nearest place on the face of a wall that x lies behind. There is none between the walls, or
  /// outside of the tank above its rim.
  std::optional<WallFoot<dim>> behind(const Vector<dim>& x) const;
  /// Returns the volume between the walls; infinity where a side is open [m², m³].
  double volume() const;
  /// Whether all faces stand on the lattice that starts at `low`.
  bool on_lattice() const;
  /// Distance to the nearest face that is off the lattice [m]; infinity: there is none.
  double distance_to_slanted(const Vector<dim>& x) const;
  /// Returns the edge off the lattice on which x lies, up to round-off.
  std::optional<std::size_t> slanted_edge_at(const Vector<dim>& x) const;

  const Vector<dim>& low() const { return low_; }  // bounding box
  const Vector<dim>& high() const { return high_; }

 private:
  struct Edge {  // of the polygon, counter-clockwise
    Eigen::Vector2d from, to, along, normal;
    double length = 0;
    bool wall = true, on_lattice = true;
  };
  struct Row {  // a layer of one edge at one depth: from + (j or j + ½) interval
    Eigen::Vector2d from;
    double length = 0, interval = 0;
    long count = 0;
    bool starts = false, ends = false;  // at a corner; else at an open rim
  };
  struct Nearest {
    std::size_t edge = 0;
    double distance = 0;
    bool inside = false;
  };
  void visit_box(int dummy_rows, const VisitParticle& visit) const;
  WallParticles<dim> polygon_particles(int dummy_rows) const;
  Nearest nearest(const Vector<dim>& x, bool walls_alone) const;
  bool joins(std::size_t edge) const;  // a wall goes on at the edge's end
  Row row_of(std::size_t edge, double depth) const;
  Eigen::Vector2d mitre(std::size_t edge, double depth) const;

  double spacing_;
  Vector<dim> low_, high_;
  bool open_top_, absorbing_bottom_, absorbing_sides_;
  std::array<bool, 3> periodic_;
  std::vector<Edge> edges_;  // empty: a box
};

}  // namespace strake::fluid
