#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace strake::fluid {

/// Faces of walls and bodies for a scheme in which a wall is a condition on ∂p/∂n and not an unknown: where
/// they lie, and which of them water touches.
///
/// A first-layer particle becomes wet when water comes within 0.52 l0 of its face, where a lattice row stands
/// at 0.5. It stays wet until the water is 1.0 l0 away. The layers behind it follow. Dry layers are not seen:
/// water that flies towards a wall is not slowed before it is there. The flag is State::surface of the first
/// layer (1: dry).
template <int dim>
class WallContact {
 public:
  WallContact(const Boundary<dim>&, const State<dim>&, double spacing);

  /// Faces where they are now; wet and dry from the water's places. near: rows of at least 2 l0.
  void update(const Boundary<dim>&, State<dim>&, const Neighbours& near);

  bool wet(std::int64_t row) const { return wet_[static_cast<std::size_t>(row)] != 0; }
  /// P r: the part of r along the face's normal; at an edge of the tank all of r across it, in a corner all.
  Vector<dim> projection(std::int64_t row, const Vector<dim>& r) const {
    const Vector<dim> axis = axis_.col(row - first_);
    const double along = axis.dot(r);
    return corner_[static_cast<std::size_t>(row)] ? Vector<dim>(r - along * axis) : Vector<dim>(along * axis);
  }
  bool corner(std::int64_t row) const { return corner_[static_cast<std::size_t>(row)] != 0; }
  /// Of the face, into the water; only for rows that are no corner.
  Vector<dim> normal(std::int64_t row) const { return axis_.col(row - first_); }
  double depth(std::int64_t row) const { return depth_[row - first_]; }  // of the row behind its face [m]
  /// Height of x over the face of that row [m], zero beneath it.
  double height(std::int64_t row, const Vector<dim>& row_position, const Vector<dim>& x) const {
    return corner(row) ? 0.0
                       : std::max(0.0, axis_.col(row - first_).dot(x - row_position) - depth_[row - first_]);
  }

 private:
  void place_bodies(const Boundary<dim>&, const State<dim>&);
  double spacing_;
  std::int64_t first_;  // row
  Vectors<dim> axis_;   // normal of a face; direction of an edge between two walls; zero in a corner
  Eigen::VectorXd depth_;
  std::vector<std::uint8_t> corner_, wet_;
};

}  // namespace strake::fluid
