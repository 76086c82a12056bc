#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/ranks/subdomain.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace strake::fluid {

/// The faces of walls and bodies for a scheme in which a wall is a condition on ∂p/∂n. The wall has no
/// unknown. The class computes where the faces lie, and which of them water touches.
///
/// A first-layer particle becomes wet when water comes within 0.52 l0 of its face; the first layer of a
/// lattice has the height 0.5 l0. It stays wet until the water is 1.0 l0 away. The layers behind it follow.
/// Dry layers do not enter any sum: water that flies towards a wall is not slowed before it is there. The
/// flag is State::surface of the first layer (1: dry).
///
/// Faces of bodies that have just become wet are listed: the water takes them on gradually (F71). Beside a
/// body that stood in the water a face itself comes and goes gradually (F91): one that is dry may still
/// count.
template <int dim>
class WallContact {
 public:
  /// least_speed: of (F91), with which a face of a body comes or goes in still water [m/s]; infinite: at
  /// once.
  WallContact(const Boundary<dim>&, const State<dim>&, double spacing,
              double least_speed = std::numeric_limits<double>::infinity());

  /// Places the faces where they are now, and marks them wet or dry from the water's places. near: rows of at
  /// least 2 l0. time: since the last update [s].
  /// aired: 1 for wet points of bodies with air between them and the water, whose faces stay dry; empty:
  /// none.
  void update(const Boundary<dim>&, State<dim>&, const Neighbours& near, double time = 0,
              std::span<const std::uint8_t> aired = {}, const RankExchange<dim>& ranks = {});

  /// Renumbers the layer particles, which follow that many water particles.
  void set_water(std::int64_t water);

  /// Whether its face counts.
  bool wet(std::int64_t row) const { return wet_[static_cast<std::size_t>(row)] != 0; }
  /// Returns the part with which its face counts: of a wall what no body covers, of a body (F91).
  double bare(std::int64_t row) const { return bare_[row - first_]; }
  /// Returns the weight of a pair with that layer particle, q (R/|r| − 1) with the part q of its face that
  /// counts. radius: R [m]; inverse: 1/|r| [1/m].
  double weight(std::int64_t row, double radius, double inverse) const {
    return bare(row) * (radius * inverse - 1);
  }
  /// The same of any particle: R/|r| − 1 for water, 0 for a dry layer.
  double pair_weight(std::int64_t j, double radius, double inverse) const {
    if (j < first_) return radius * inverse - 1;
    return wet(j) ? weight(j, radius, inverse) : 0;
  }
  /// Returns P r, the component of r along the face's normal. At an edge of the tank it is all of r across
  /// the edge, in a corner all of r.
  Vector<dim> projection(std::int64_t row, const Vector<dim>& r) const {
    const Vector<dim> axis = axis_.col(row - first_);
    const double along = axis.dot(r);
    return corner_[static_cast<std::size_t>(row)] ? Vector<dim>(r - along * axis) : Vector<dim>(along * axis);
  }
  /// A layer particle of a body whose face has become wet after the start, and the water nearest to the face.
  struct Joined {
    std::int64_t row, nearest;
  };
  /// Those of the last `update`, in order.
  const std::vector<Joined>& joined() const { return joined_; }
  /// Returns how much nearer water must come to make the next face of a body wet [m], at the last `update`.
  double contact_gap() const { return contact_gap_; }
  bool corner(std::int64_t row) const { return corner_[static_cast<std::size_t>(row)] != 0; }
  /// Returns the normal of the face, into the water. Corners have none.
  Vector<dim> normal(std::int64_t row) const { return axis_.col(row - first_); }
  double depth(std::int64_t row) const { return depth_[row - first_]; }  // behind its face [m]
  /// Returns the height of x over the face of that layer particle [m], zero beneath it.
  double height(std::int64_t row, const Vector<dim>& row_position, const Vector<dim>& x) const {
    return corner(row) ? 0.0
                       : std::max(0.0, axis_.col(row - first_).dot(x - row_position) - depth_[row - first_]);
  }

 private:
  /// The water nearest to a face: its height over it [l0], and its number (−1: none).
  struct Nearest {
    double height;
    std::int64_t particle;
  };
  bool leaves(const Boundary<dim>&, const State<dim>&, std::int64_t row, std::int64_t particle,
              const Vector<dim>& place) const;
  Nearest nearest_water(const Boundary<dim>&, const State<dim>&, const Neighbours&, std::int64_t row) const;
  void list_joined(const Boundary<dim>&, const State<dim>&);
  void place_bodies(const Boundary<dim>&, const State<dim>&);
  bool fades() const { return least_speed_ < std::numeric_limits<double>::infinity(); }
  double faded(const State<dim>&, std::int64_t row, std::int64_t nearest, double part, double time,
               bool is_wet) const;
  double find_bare(const Boundary<dim>&, const State<dim>&, std::int64_t row) const;
  double spacing_, least_speed_, contact_gap_ = std::numeric_limits<double>::infinity();
  std::int64_t first_;  // layer particle
  Vectors<dim> axis_;   // normal of a face; direction of an edge between two walls; zero in a corner
  Eigen::VectorXd depth_, bare_;
  std::vector<std::uint8_t> corner_, wet_;
  std::vector<std::int64_t> joins_;  // of each layer particle: water nearest to a face newly wet; else −1
  std::vector<Joined> joined_;
};

}  // namespace strake::fluid
