#pragma once

#include "proto/interface.hpp"
#include "structure/parameters.hpp"

#include <Eigen/SparseCore>

#include <cstdint>
#include <vector>

namespace strake::structure {

/// The plate as a square lattice of particles, column by column, each from the bottom up. A clamped end goes
/// on beyond the span, far enough to complete every bond of a free particle. With ClampColumn::inside the
/// last column inside the span is fixed too (its centre half a spacing from the end face), so that the clamp
/// stands where the end face is (PHYSICS §6); with `outside` each clamp gives way by nearly a spacing.
/// Columns outside are no part of the wet plate.
struct Lattice {
  double spacing = 0;           // [m]
  int columns = 0, layers = 0;  // all columns, those outside the span included
  int outside_left = 0, outside_right = 0;
  Eigen::Matrix2Xd position;         // 2×n [m], reference
  std::vector<std::uint8_t> fixed;   // n
  std::vector<std::uint8_t> inside;  // n, within the span

  Eigen::Index size() const { return position.cols(); }
  Eigen::Index index(int column, int layer) const {
    return static_cast<Eigen::Index>(column) * layers + layer;
  }
};
Lattice make_lattice(const Plate&, double spacing, double radius /* [spacing] */,
                     ClampColumn = ClampColumn::inside);

/// m×n: values at places of the plate from values on the particles, bilinear in the nearest lattice cell and
/// extrapolated by half a spacing to the faces. Rows sum to 1 and are exact for linear fields, so that with
/// its transpose for forces sum, moment and virtual work are kept.
Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation(const Lattice&, const Points& at);

}  // namespace strake::structure
