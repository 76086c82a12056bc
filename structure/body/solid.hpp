#pragma once

#include "proto/interface.hpp"
#include "structure/material/material.hpp"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace strake::structure {

/// How a face of a body is supported; constrained motions are those of the supports.
///   clamped    every point, in every direction
///   pinned     the line at the face's middle, in every direction: the face can turn
///   roller     that line, across the face's normal only: it can turn and draw in
///   symmetry   every point, along the normal only
enum class Support { free, clamped, pinned, roller, symmetry };
inline constexpr std::array<const char*, 5> support_names = {"free", "clamped", "pinned", "roller",
                                                             "symmetry"};

struct Part {
  std::string name;
  Material material;
  bool constrained = false;  // all of it moves with the supports
};

/// Facets with a name, and the support that acts on them.
struct SupportedFace {
  std::string name;  // "bottom.left"
  Support support = Support::free;
  std::vector<int> facet;
};

/// An elastic body as conforming cells of its parts: quadrilaterals in two dimensions, hexahedra in three.
/// Finite elements, particles, loaded surface and mass follow from this one description, so that all solvers
/// have the same geometry.
struct Solid {
  int dimension = 2;
  Points node;               // 3×n [m]
  Eigen::MatrixXi cell;      // 4 or 8 × m, nodes in lexicographic order: x fastest
  std::vector<int> part_of;  // m, into `parts`
  std::vector<Part> parts;
  Eigen::MatrixXi facet;        // 2 or 4 × k, faces that only one cell has, counter-clockwise seen from
                                // outside. A segment (a, b) has its normal (t_y, -t_x) outside
  std::vector<int> facet_cell;  // k
  std::vector<SupportedFace> supported;
  /// Boxes only: the planes that bound them along each of their axes, ascending [m]. x = turn · y, with y
  /// between the planes.
  std::array<std::vector<double>, 3> plane;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();

  bool empty() const { return cell.cols() == 0; }
  const Part& part(Eigen::Index c) const {
    return parts[static_cast<std::size_t>(part_of[static_cast<std::size_t>(c)])];
  }
  bool made_of_boxes() const { return !plane[0].empty(); }
  bool along_axes() const { return made_of_boxes() && turn.isIdentity(0); }
};

/// One axis-aligned box of a union; where two overlap the first one counts.
struct SolidBox {
  std::string name;
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();  // [m]
  Material material;
  bool constrained = false;
  /// left, right (x), bottom, top (y), back, front (z).
  std::array<Support, 6> support = {};
};
inline constexpr std::array<const char*, 6> side_names = {"left", "right", "bottom", "top", "back", "front"};

/// What is wrong with a body; an empty problem: nothing.
struct SolidFault {
  std::string problem, fix;
};

/// The union of boxes, cut along all their planes so that cells conform. z is of no account in two
/// dimensions.
Solid solid_of_boxes(int dimension, const std::vector<SolidBox>&);

/// Cells of the grid that the planes of all boxes make, of which their union has some. No integer: there may
/// be too many for one.
double grid_count(int dimension, const std::vector<SolidBox>&);
/// Fills node, cell and part_of with the cells of the grid of `plane`, x fastest. `part_at` gives the part of
/// the cell in three intervals, −1: none. The nodes are numbered in the order of their first use.
void fill_grid(Solid&, const std::function<int(const std::array<std::size_t, 3>&)>& part_at);

/// Fills facet and facet_cell from the cells.
void find_facets(Solid&);

/// Returns the first fault: no cells, a cell that is turned inside out or has no volume, parts that do not
/// touch or are covered by others, a support that holds nothing.
SolidFault fault_of(const Solid&);

/// True if a face is supported or a part is held.
bool has_supports(const Solid&);

/// The half spaces whose common part is a cell, 4×(sides): columns (n, c) with n·X ≤ c inside and |n| = 1.
/// The sides of a hexahedron are taken as flat.
Eigen::Matrix4Xd half_spaces(const Solid&, int cell);
/// The cell that contains a place to within `slack` [m], or -1.
int cell_at(const Solid&, const Eigen::Vector3d& X, double slack);

/// The outer boundary as closed polygons of the plane, counter-clockwise, without enclosed cavities. It has
/// corners only: a straight chain of facets is one edge. Two dimensions.
std::vector<std::vector<Eigen::Vector2d>> outer_polygons(const Solid&);

/// Cuts the outer boundary of a solid of three dimensions into triangles, without enclosed cavities. Their
/// edges are about `spacing` [m] long, their normals point outside.
InterfaceMesh outer_surface(const Solid&, double spacing);

/// Whether a place lies on a facet, to within `slack` [m].
bool on_facet(const Solid&, int facet, const Eigen::Vector3d& X, double slack);
/// Normal of a facet, outside, as long as the facet is large.
Eigen::Vector3d facet_normal(const Solid&, int facet);
/// Mean normal of a supported face, outside.
Eigen::Vector3d normal_of(const Solid&, const SupportedFace&);
/// The axis that a supported face lies across. Throws Error(case_file) where there is none, as only a clamped
/// face may lie.
Eigen::Index axis_of(const Solid&, const SupportedFace&);
/// Unit vector within a supported face, along the shorter of its two directions. In the plane: along the
/// face.
Eigen::Vector3d shorter_direction(const Solid&, const SupportedFace&);
/// Middle of a supported face: of the box around it [m].
Eigen::Vector3d middle_of(const Solid&, const SupportedFace&);

/// Finds the facets of a named face; empty if there are none. A name is one of these:
/// - an entry of `supported` (a physical name of a mesh file);
/// - "left", "right", "bottom", "top", "back" or "front": the side of the whole body, all facets in its
///   outermost plane;
/// - "part.side": that side of one of its parts.
std::vector<int> facets_named(const Solid&, const std::string& name);

/// Extent of each part along each axis, of turned boxes along their own, 3×n [m].
Points part_sizes(const Solid&);
/// Smallest extent of a solid's parts [m]: what a discretisation has to resolve.
double thinnest(const Solid&);

/// Names the material laws of a body's parts. Examples: "neo-Hookean", or, if they differ, "linear elasticity
/// (rib) and Saint Venant-Kirchhoff (plate, deck)".
std::string material_law(const std::vector<Part>&);
/// Whether every part is linear: small strains, the reference configuration throughout.
bool all_linear(const std::vector<Part>&);

}  // namespace strake::structure
