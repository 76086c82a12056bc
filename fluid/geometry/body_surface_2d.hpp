#pragma once

#include "fluid/geometry/outline.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace strake::fluid {

/// The wetted surface of plane bodies: straight or smooth edges between corners (`Bend`). Within an edge a
/// knuckle divides two stretches, so that it stays where it is. Each stretch is divided evenly into pieces of
/// about one particle spacing, with a wet point in the middle of each. The motion is given on the wet points.
/// Corners follow from the points beside them, so that a rigid motion is followed exactly.
///
/// The order is counter-clockwise; the normal points into the fluid.
class BodySurface2d {
 public:
  using Vector2 = Eigen::Vector2d;
  using Vectors2 = Eigen::Matrix2Xd;

  /// One edge: wet points first … first+count−1, vertices vertex … vertex+count.
  struct Edge {
    int first = 0, count = 0, vertex = 0;
    std::vector<int> stretch;    // pieces that begin one between knuckles or chines; count
    int previous = 0, next = 0;  // neighbours around the body
    bool closed = false;         // smooth body without corners
    bool curved = false;         // it bends smoothly in the reference
    bool plane = false;          // no knuckle or chine, and it turns by less than 20 degrees in all
    bool owns_start = true, owns_end = true;  // a segment through the very corner crosses one edge only
    double piece = 0;                         // reference length of a piece [m]
    // Angle inside the body at its corners [rad], in the reference; π where it has none.
    double start_angle = std::numbers::pi, end_angle = std::numbers::pi;
    // Whether water leaves the body there: a corner of at most a right angle that is no keel. Both faces of a
    // keel look down, in the reference.
    bool start_sharp = false, end_sharp = false;
  };

  BodySurface2d() = default;
  /// partner: closed chains of segments. Throws Error(case_file)
  /// when they are open or clockwise.
  BodySurface2d(const InterfaceMesh& partner, double spacing, const Knuckles& = {});

  bool empty() const { return edges_.empty(); }
  const InterfaceMesh& mesh() const { return mesh_; }  // wet points, faces between neighbours around the body
  const std::vector<Edge>& edges() const { return edges_; }
  int edge_of(int point) const { return edge_of_[static_cast<std::size_t>(point)]; }
  int points() const { return static_cast<int>(edge_of_.size()); }

  /// Moves the outline: displacement and velocity of the wet points, 2×m.
  void move(const Vectors2& displacement, const Vectors2& velocity);

  Eigen::Vector3d reference(int k) const { return mesh_.position.col(k); }
  Vector2 point(int k) const { return point_.col(k); }
  Vector2 velocity(int k) const { return velocity_.col(k); }
  Vector2 normal(int k) const { return normal_.col(k); }
  Vector2 normal_rate(int k) const { return normal_rate_.col(k); }  // dn/dt [1/s]
  Vector2 vertex(int v) const { return vertex_.col(v); }
  Vector2 vertex_velocity(int v) const { return vertex_velocity_.col(v); }
  double area(int k) const { return area_[k]; }  // length of the piece [m]
  Vector2 low() const { return whole_.low; }     // bounding box
  Vector2 high() const { return whole_.high; }

  /// Whether the segment a–b crosses the edge of that wet point, on a piece that turns from the point's by
  /// less than 90 degrees: both sides of a thin body with a round end are one edge. Corners count for the
  /// edge that owns them.
  bool crosses(int point, const Vector2& a, const Vector2& b) const {
    return crosses_edge(edge_of(point), a, b, Corners::owned, point);
  }
  /// Whether it crosses any edge, corners included. The first piece beside a corner sharper than 86° does not
  /// count: the tip is thinner than a spacing there, and water on its two sides stays as near as it was
  /// before the tip came between.
  bool separates(const Vector2& a, const Vector2& b) const;
  /// Returns the length of the way from a to b past the body [m]: straight, around the corner between the two
  /// edges that the segment crosses, or around knuckles of one. Across others there is none: infinity.
  double way_around(const Vector2& a, const Vector2& b) const;
  /// Whether x lies within that distance of a corner or a knuckle.
  bool beside_corner(const Vector2& x, double distance) const {
    return whole_.covers(x, distance) && is_near_corner(x, distance);
  }
  bool inside(const Vector2& x) const;
  /// Returns the distance of x from the nearer end of that edge, along its first and last piece [m]. It is
  /// negative past an end, and infinite where no end is within four spacings: a bent edge may turn back.
  double within(int edge, const Vector2& x) const {
    const auto& [start, end] = ends_[static_cast<std::size_t>(edge)];
    if (edges_[static_cast<std::size_t>(edge)].closed) return std::numeric_limits<double>::infinity();
    return std::min(start.inside(x), end.inside(x));
  }
  /// One end of an edge, and how far inside it x lies, along the face [m]; infinite where it has no ends.
  struct End {
    Vector2 place;
    double inside;
    bool sharp;  // water leaves the body there
  };
  End end_of(int edge, bool last, const Vector2& x) const;
  /// Returns the distance of x inside the plane that halves the nearest chine of that wet point's stretch
  /// (`Bend::chine`), along the face [m]. It is negative past it, and infinite where none is near.
  double inside_chine(int point, const Vector2& x) const {
    double inside = std::numeric_limits<double>::infinity();
    if (chines_.chine.empty()) return inside;
    const auto& beside = chines_.beside[static_cast<std::size_t>(point)];
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
      if (const int c = beside[side]; c >= 0)
        inside = std::min(inside, chines_.chine[static_cast<std::size_t>(c)].ending[side].inside(x));
    return inside;
  }
  bool is_between_sharp_corners(int edge) const;
  bool is_curved(int edge) const { return edges_[static_cast<std::size_t>(edge)].curved; }

  struct Foot {
    int point = -1;  // piece it lies on
    Vector2 position;
    double distance = 0;
  };
  Foot nearest(const Vector2& x) const;

 private:
  struct Ending {  // of an edge: its first or last piece, from the end inwards
    Vector2 place, inwards;
    double length = 0;
    double reach2 = 0;  // square of the distance up to which it counts [m²]
    double inside(const Vector2& x) const {
      const Vector2 r = x - place;
      return r.squaredNorm() < reach2 ? r.dot(inwards) / length : std::numeric_limits<double>::infinity();
    }
  };
  struct Chine {
    int before, place, behind;     // vertices
    std::array<Ending, 2> ending;  // of the stretch behind it, and of that before it
  };
  struct Chines {
    std::vector<Chine> chine;
    std::vector<std::array<int, 2>> beside;  // of each wet point: at the start, the end of its stretch
  };
  struct Box {
    Vector2 low = Vector2::Zero(), high = Vector2::Zero();
    bool covers(const Vector2& x, double farther) const {
      return (x.array() >= low.array() - farther).all() && (x.array() <= high.array() + farther).all();
    }
    bool meets(const Box& other) const {
      return (low.array() <= other.high.array()).all() && (high.array() >= other.low.array()).all();
    }
  };
  /// Which corners count: those that the edge owns, all but the tips (see `separates`), or all.
  enum class Corners : std::uint8_t { owned, without_tips, all };
  bool is_near_corner(const Vector2& x, double distance) const;
  bool crosses_edge(int edge, const Vector2& a, const Vector2& b, Corners, int before = -1) const;
  void add_edges(const Outline&);
  void add_pieces(const Outline&, std::size_t begin, std::size_t end, Edge&);
  void connect(std::size_t first_edge);
  Vector2 half_piece(const Edge&, int point, bool is_position) const;
  void place_vertices(const Edge&, const Vectors2& from, Vectors2& to, bool is_position);
  void meet_at_bisectors();
  void find_chines(const Outline&, std::size_t begin, const Edge&);
  void place_chines();
  void place_boxes();
  std::pair<int, int> pieces_beside(int edge, const Vector2& a, const Vector2& b) const;
  bool crosses_piece(int vertex, const Vector2& a, const Vector2& b, double from, double to) const;

  double spacing_ = 0;
  InterfaceMesh mesh_;
  std::vector<Edge> edges_;
  std::vector<int> edge_of_;
  Vectors2 reference_;   // wet points
  Vectors2 half_piece_;  // reference half tangent of each piece, for edges of a single point
  Vectors2 point_, velocity_, normal_, normal_rate_;
  Vectors2 vertex_, vertex_velocity_;
  Eigen::VectorXd area_;
  std::vector<std::array<Ending, 2>> ends_;  // of each edge: start, end
  Chines chines_;
  std::vector<std::uint8_t> is_even_;
  std::vector<Box> box_, block_box_;      // around each edge; around blocks of its pieces
  std::vector<std::size_t> first_block_;  // of each edge
  Box whole_;
};

}  // namespace strake::fluid
