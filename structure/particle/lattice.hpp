#pragma once

#include "proto/interface.hpp"
#include "structure/body/mass.hpp"
#include "structure/body/parameters.hpp"

#include <Eigen/SparseCore>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace strake::structure {

/// One column per particle.
template <int dim>
using Vectors = Eigen::Matrix<double, dim, Eigen::Dynamic>;
using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
/// Decimals of a case file, not physics [spacing].
inline constexpr double file_decimals = 1e-6;

/// Where the particles at the boundary stand that have a piece of a cell: in the middle of the piece, or in
/// the middle of the cell.
enum class Places { pieces, cells };

/// A body as a square or cubic lattice of particles, numbered with x slowest. There is a particle where at
/// least half of a lattice cell lies in the body. Bodies of boxes fill their cells exactly. In other bodies a
/// particle at the boundary has the volume that its cell shares with the body. Volume in cells without a
/// particle is added to their neighbours, so that mass and moment of inertia are the body's. With
/// Places::pieces the particle stands in the middle of its volume (structure/THEORY.md, section 5.1).
///
/// A clamped face continues beyond the body, far enough to complete every bond of a free particle. With
/// ClampColumn::inside the last particles inside are fixed too (their centres half a spacing from the face).
/// The clamp then acts at the face (structure/THEORY.md, section 5.3); with `outside` each clamp is too long
/// by nearly a spacing. Particles outside are no part of the loaded body.
template <int dim>
struct Lattice {
  using Cell = Eigen::Matrix<int, dim, 1>;

  double spacing = 0;                            // [m]
  Eigen::Matrix<int, dim, Eigen::Dynamic> cell;  // integer coordinates, from 0, those outside included
  Cell extent = Cell::Zero();                    // cells along each axis
  int layers = 0;                                // through the thinnest part
  Vectors<dim> position;                         // [m] reference
  Vectors<dim> shift;                            // [spacing] of the position from the cell's middle
  std::vector<std::uint8_t> fixed;               // n
  std::vector<std::uint8_t> inside;              // n, within the body
  Eigen::VectorXd share;                         // n, volume over that of a lattice cell
  std::vector<int> part;                         // n, into `parts`
  std::vector<Part> parts;
  std::vector<int> number;  // of the particle in each cell of `extent`, or -1

  Eigen::Index size() const { return position.cols(); }
  const Material& material(Eigen::Index i) const {
    return parts[static_cast<std::size_t>(part[static_cast<std::size_t>(i)])].material;
  }
  Eigen::Vector3d place(Eigen::Index i) const {  // in space [m] reference
    Eigen::Vector3d X = Eigen::Vector3d::Zero();
    X.head<dim>() = position.col(i);
    return X;
  }
  Eigen::Index count_inside() const { return std::count(inside.begin(), inside.end(), 1); }
  /// Of the particle in a cell, or -1.
  Eigen::Index index(const Cell& at) const {
    std::size_t k = 0;
    for (int axis = 0; axis < dim; ++axis) {
      if (at[axis] < 0 || at[axis] >= extent[axis]) return -1;
      k = k * static_cast<std::size_t>(extent[axis]) + static_cast<std::size_t>(at[axis]);
    }
    return number[k];
  }
  /// [m^dim] of a lattice cell, and of a particle.
  double cell_volume() const { return dim == 2 ? spacing * spacing : spacing * spacing * spacing; }
  double volume(Eigen::Index i) const { return share[i] * cell_volume(); }
  Eigen::Matrix<double, dim, 1> origin() const {  // [m] lower corner of cell 0
    return position.col(0) -
           spacing * (cell.col(0).template cast<double>().array() + 0.5 + shift.col(0).array()).matrix();
  }
};

/// Calls `visit` with each lattice cell of a box of them.
template <int dim, class Visit>
void for_each_cell(const Eigen::Matrix<int, dim, 1>& first, const Eigen::Matrix<int, dim, 1>& end,
                   Visit visit) {
  if ((first.array() >= end.array()).any()) return;
  Eigen::Matrix<int, dim, 1> at = first;
  for (;;) {
    visit(at);
    int axis = dim - 1;
    while (axis >= 0 && ++at[axis] == end[axis]) {
      at[axis] = first[axis];
      --axis;
    }
    if (axis < 0) return;
  }
}

/// A field on the particles as points of space: in two dimensions with z = 0.
template <int dim>
Points in_space(const Vectors<dim>& vectors) {
  Points points = Points::Zero(3, vectors.cols());
  points.template topRows<dim>() = vectors;
  return points;
}

/// The body must have no lattice_fault.
template <int dim>
Lattice<dim> make_lattice(const Solid&, double spacing, double radius /* [spacing] */,
                          ClampColumn = ClampColumn::inside, Places = Places::pieces);

/// Why a lattice of this spacing cannot represent a body; an empty problem: it can. A body of boxes it must
/// fill exactly. For other bodies mass and moment of inertia must be within 1 %. The fix is a spacing.
SolidFault lattice_fault(const Solid&, double spacing);

/// Of the particles within the body, each a square or cube with an inertia of its own, m d²/6.
template <int dim>
MassProperties mass_of(const Lattice<dim>&);

/// Interpolates values on the particles to places in the body, m×n. Between the corners of a lattice cell
/// that all have particles in their middles it is linear along each axis. Towards the faces it extrapolates
/// by half a spacing. Beyond that, at the oblique faces of a mesh, it uses the least-squares linear field of
/// the particles around. Rows sum to 1 and are exact for linear fields. So the transpose, for forces, keeps
/// sum, moment and virtual work. Throws Error(case_file) for a place that is not in the body.
template <int dim>
SparseRows interpolation(const Lattice<dim>&, const Points& at);

}  // namespace strake::structure
