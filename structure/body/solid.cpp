#include "structure/body/solid.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Faces of a cell with lexicographic nodes, seen from outside counter-clockwise: x−, x+, y−, y+, z−, z+.
const std::vector<std::vector<int>>& sides(int dimension) {
  static const std::vector<std::vector<int>> quadrilateral = {{2, 0}, {1, 3}, {0, 1}, {3, 2}},
                                             hexahedron = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                           {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  return dimension == 2 ? quadrilateral : hexahedron;
}

/// Ascending, with what lies nearer together than `near` taken as one.
std::vector<double> distinct(std::vector<double> values, double near) {
  std::sort(values.begin(), values.end());
  std::vector<double> kept;
  for (const double v : values)
    if (kept.empty() || v > kept.back() + near) kept.push_back(v);
  return kept;
}

/// Jacobian of a cell's mapping at one of its corners: the product of the edges that meet there.
double corner_jacobian(const Solid& solid, Index c, int corner) {
  const auto at = [&](int k) -> Vector3d { return solid.node.col(solid.cell(k, c)); };
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  for (int axis = 0; axis < solid.dimension; ++axis) {
    const int bit = 1 << axis, low = corner & ~bit, high = corner | bit;
    J.col(axis) = at(high) - at(low);
  }
  return J.determinant();
}

/// Finds the cells that are connected over whole faces. Each cell gets the number of the first cell of its
/// group.
std::vector<int> groups_of_cells(const Solid& solid) {
  std::vector<int> group(static_cast<std::size_t>(solid.cell.cols()));
  std::iota(group.begin(), group.end(), 0);
  const auto root = [&](int c) {
    while (group[static_cast<std::size_t>(c)] != c) c = group[static_cast<std::size_t>(c)];
    return c;
  };
  std::map<std::vector<int>, int> seen;
  const auto& local = sides(solid.dimension);
  for (int c = 0; c < solid.cell.cols(); ++c)
    for (const auto& side : local) {
      std::vector<int> key;
      for (const int k : side) key.push_back(solid.cell(k, c));
      std::sort(key.begin(), key.end());
      const auto [found, fresh] = seen.emplace(std::move(key), c);
      if (fresh) continue;
      const int a = root(c), b = root(found->second);
      group[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  for (int c = 0; c < solid.cell.cols(); ++c) group[static_cast<std::size_t>(c)] = root(c);
  return group;
}

std::string text(const Solid& solid, const Vector3d& X) {
  return solid.dimension == 2 ? fmt::format("({:.6g}, {:.6g})", X.x(), X.y())
                              : fmt::format("({:.6g}, {:.6g}, {:.6g})", X.x(), X.y(), X.z());
}

}  // namespace

namespace {

/// Lists the planes of all boxes along each axis. Decimals of a case file that differ only in the last digit
/// are one plane.
std::array<std::vector<double>, 3> planes_of(int dimension, const std::vector<SolidBox>& boxes) {
  double size = 0;
  for (const SolidBox& box : boxes) size = std::max(size, (box.max - box.min).head(dimension).maxCoeff());
  const double near = 1e-9 * size;
  std::array<std::vector<double>, 3> planes;
  for (int axis = 0; axis < dimension; ++axis) {
    std::vector<double> all;
    for (const SolidBox& box : boxes) all.insert(all.end(), {box.min[axis], box.max[axis]});
    planes[static_cast<std::size_t>(axis)] = distinct(all, near);
  }
  return planes;
}

/// Nodes and cells of the grid that the planes of all sides make, those in no box left out.
void add_grid(Solid& solid, const std::vector<SolidBox>& boxes) {
  solid.plane = planes_of(solid.dimension, boxes);
  // The first box that contains an interval's middle owns the cell.
  fill_grid(solid, [&](const std::array<std::size_t, 3>& at) {
    const auto inside = [&](const SolidBox& box) {
      for (int axis = 0; axis < solid.dimension; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double middle = 0.5 * (solid.plane[a][at[a]] + solid.plane[a][at[a] + 1]);
        if (!(middle > box.min[axis] && middle < box.max[axis])) return false;
      }
      return true;
    };
    const auto owner = std::find_if(boxes.begin(), boxes.end(), inside);
    return owner == boxes.end() ? -1 : static_cast<int>(owner - boxes.begin());
  });
}

}  // namespace

double grid_count(int dimension, const std::vector<SolidBox>& boxes) {
  double count = boxes.empty() ? 0 : 1;
  for (const std::vector<double>& plane : planes_of(dimension, boxes))
    if (!plane.empty()) count *= static_cast<double>(plane.size() - 1);
  return count;
}

void fill_grid(Solid& solid, const std::function<int(const std::array<std::size_t, 3>&)>& part_at) {
  std::array<std::size_t, 3> nodes = {1, 1, 1}, cells = {1, 1, 1};  // along each axis
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(solid.dimension); ++axis) {
    nodes[axis] = solid.plane[axis].size();
    cells[axis] = nodes[axis] - 1;
  }
  const int corners = 1 << solid.dimension;
  std::vector<int> number(nodes[0] * nodes[1] * nodes[2], -1), corner_of_cells;
  std::vector<Vector3d> node;
  for (std::size_t k = 0; k < cells[2]; ++k)
    for (std::size_t j = 0; j < cells[1]; ++j)
      for (std::size_t i = 0; i < cells[0]; ++i) {
        const int part = part_at({i, j, k});
        if (part < 0) continue;
        solid.part_of.push_back(part);
        for (std::size_t corner = 0; corner < static_cast<std::size_t>(corners); ++corner) {
          const std::size_t x = i + (corner & 1), y = j + ((corner >> 1) & 1), z = k + ((corner >> 2) & 1);
          int& at = number[(z * nodes[1] + y) * nodes[0] + x];
          if (at < 0) {
            at = static_cast<int>(node.size());
            node.emplace_back(solid.plane[0][x], solid.plane[1][y],
                              solid.dimension == 3 ? solid.plane[2][z] : 0.0);
          }
          corner_of_cells.push_back(at);
        }
      }
  solid.cell =
      Eigen::Map<Eigen::MatrixXi>(corner_of_cells.data(), corners, static_cast<Index>(solid.part_of.size()));
  solid.node.resize(3, static_cast<Index>(node.size()));
  for (std::size_t i = 0; i < node.size(); ++i) solid.node.col(static_cast<Index>(i)) = node[i];
}

Solid solid_of_boxes(int dimension, const std::vector<SolidBox>& boxes) {
  Solid solid;
  solid.dimension = dimension;
  for (const SolidBox& box : boxes) solid.parts.push_back({box.name, box.material, box.constrained});
  if (boxes.empty()) return solid;
  add_grid(solid, boxes);
  find_facets(solid);

  // Supports: the facets of a box's own cells that lie in its side.
  for (std::size_t b = 0; b < boxes.size(); ++b)
    for (std::size_t side = 0; side < static_cast<std::size_t>(2 * dimension); ++side) {
      if (boxes[b].support[side] == Support::free) continue;
      const std::string name = boxes[b].name + "." + side_names[side];
      solid.supported.push_back({name, boxes[b].support[side], facets_named(solid, name)});
    }
  return solid;
}

void find_facets(Solid& solid) {
  struct Seen {
    int cells = 0, cell = 0;
    std::vector<int> nodes;
  };
  std::map<std::vector<int>, Seen> faces;
  std::vector<std::vector<int>>
      order;  // in the order of their first use, so that the numbering is that of the cells
  const auto& local = sides(solid.dimension);
  for (int c = 0; c < solid.cell.cols(); ++c)
    for (const auto& side : local) {
      std::vector<int> nodes;
      for (const int k : side) nodes.push_back(solid.cell(k, c));
      std::vector<int> key = nodes;
      std::sort(key.begin(), key.end());
      Seen& seen = faces[key];
      if (seen.cells++ == 0) {
        seen.cell = c;
        seen.nodes = nodes;
        order.push_back(key);
      }
    }
  const auto rows = static_cast<Index>(local.front().size());
  std::vector<int> flat;
  solid.facet_cell.clear();
  for (const auto& key : order) {
    const Seen& seen = faces.at(key);
    if (seen.cells != 1) continue;
    flat.insert(flat.end(), seen.nodes.begin(), seen.nodes.end());
    solid.facet_cell.push_back(seen.cell);
  }
  solid.facet = Eigen::Map<Eigen::MatrixXi>(flat.data(), rows, static_cast<Index>(solid.facet_cell.size()));
}

std::vector<int> facets_named(const Solid& solid, const std::string& name) {
  for (const SupportedFace& face : solid.supported)
    if (face.name == name && !face.facet.empty()) return face.facet;
  const std::size_t dot = name.rfind('.');
  const std::string part = dot == std::string::npos ? "" : name.substr(0, dot),
                    side = dot == std::string::npos ? name : name.substr(dot + 1);
  const auto found = std::find(side_names.begin(), side_names.end(), side);
  const auto number = static_cast<Index>(found - side_names.begin());
  if (found == side_names.end() || number >= 2 * solid.dimension) return {};
  const Index axis = number / 2;
  const double sign = number % 2 == 0 ? -1 : 1;
  const auto belongs = [&](Index cell) { return part.empty() || solid.part(cell).name == part; };
  // How far a facet's nearest node lies towards that side, and how far the outermost facet does.
  const auto reach = [&](Index f) {
    double least = std::numeric_limits<double>::infinity();
    for (Index k = 0; k < solid.facet.rows(); ++k)
      least = std::min(least, sign * solid.node(axis, solid.facet(k, f)));
    return least;
  };
  double most = -std::numeric_limits<double>::infinity();
  for (Index c = 0; c < solid.cell.cols(); ++c)
    if (belongs(c))
      for (Index k = 0; k < solid.cell.rows(); ++k)
        most = std::max(most, sign * solid.node(axis, solid.cell(k, c)));
  const double slack = 1e-9 * (solid.node.rowwise().maxCoeff() - solid.node.rowwise().minCoeff()).maxCoeff();
  std::vector<int> facets;
  for (Index f = 0; f < solid.facet.cols(); ++f)
    if (belongs(solid.facet_cell[static_cast<std::size_t>(f)]) && reach(f) >= most - slack)
      facets.push_back(static_cast<int>(f));
  if (!facets.empty() || !solid.made_of_boxes() || solid.along_axes()) return facets;
  // No side of turned boxes lies across an axis of space: those across their own axes are meant.
  Solid level = solid;
  level.node = solid.turn.transpose() * solid.node;
  level.turn.setIdentity();
  return facets_named(level, name);
}

SolidFault fault_of(const Solid& solid) {
  if (solid.empty()) return {"it has no cells", "give it at least one box with min below max"};
  const int corners = 1 << solid.dimension;
  for (Index c = 0; c < solid.cell.cols(); ++c) {
    for (int k = 0; k < corners; ++k)
      if (!(corner_jacobian(solid, c, k) > 0))
        return {fmt::format("cell {} of part \"{}\" is turned inside out or has no volume at {}", c + 1,
                            solid.part(c).name, text(solid, solid.node.col(solid.cell(k, c)))),
                "mesh that place anew: four corners of a quadrilateral must make a convex shape"};
  }
  const std::vector<int> group = groups_of_cells(solid);
  for (std::size_t c = 0; c < group.size(); ++c)
    if (group[c] != group[0]) {
      const Vector3d X = solid.node.col(solid.cell(0, static_cast<Index>(c)));
      return {fmt::format("part \"{}\" near {} does not touch the rest (\"{}\") along a face",
                          solid.part(static_cast<Index>(c)).name, text(solid, X), solid.part(0).name),
              "let the parts share a face: in a mesh file the same nodes, in boxes the same plane"};
    }
  for (std::size_t p = 0; p < solid.parts.size(); ++p)
    if (std::find(solid.part_of.begin(), solid.part_of.end(), static_cast<int>(p)) == solid.part_of.end())
      return {fmt::format("part \"{}\" is covered by the parts before it", solid.parts[p].name),
              "leave it out, or give it a place of its own"};
  for (const SupportedFace& face : solid.supported)
    if (face.facet.empty() && face.support != Support::free)
      return {fmt::format("support \"{}\" holds nothing: no part of that face is at the body's boundary",
                          face.name),
              "name a face that other parts do not cover"};
  return {};
}

bool has_supports(const Solid& solid) {
  return std::any_of(solid.supported.begin(), solid.supported.end(),
                     [](const SupportedFace& face) { return face.support != Support::free; }) ||
         std::any_of(solid.parts.begin(), solid.parts.end(),
                     [](const Part& part) { return part.constrained; });
}

Eigen::Matrix4Xd half_spaces(const Solid& solid, int c) {
  const auto& local = sides(solid.dimension);
  Eigen::Matrix4Xd planes(4, static_cast<Index>(local.size()));
  for (std::size_t s = 0; s < local.size(); ++s) {
    const auto corner = [&](std::size_t k) -> Vector3d { return solid.node.col(solid.cell(local[s][k], c)); };
    Vector3d normal, middle;
    if (solid.dimension == 2) {
      const Vector3d t = corner(1) - corner(0);
      normal << t.y(), -t.x(), 0;
      middle = corner(0);
    } else {
      normal = (corner(2) - corner(0)).cross(corner(3) - corner(1));
      middle = 0.25 * (corner(0) + corner(1) + corner(2) + corner(3));
    }
    normal.normalize();
    planes.col(static_cast<Index>(s)) << normal, normal.dot(middle);
  }
  return planes;
}

// Corners of a warped side stand beyond its mean plane; so do places on it, at most as far.
int cell_at(const Solid& solid, const Vector3d& X, double slack) {
  for (int c = 0; c < solid.cell.cols(); ++c) {
    const Eigen::Matrix4Xd planes = half_spaces(solid, c);
    const auto beyond = [&](const Vector3d& x) -> Eigen::RowVectorXd {
      return x.transpose() * planes.topRows<3>() - planes.row(3);
    };
    Eigen::RowVectorXd warp = Eigen::RowVectorXd::Zero(planes.cols());
    for (Index k = 0; k < solid.cell.rows(); ++k)
      warp = warp.cwiseMax(beyond(solid.node.col(solid.cell(k, c))));
    if ((beyond(X) - warp).maxCoeff() <= slack) return c;
  }
  return -1;
}

Points part_sizes(const Solid& solid) {
  Points size(3, static_cast<Index>(solid.parts.size()));
  for (std::size_t p = 0; p < solid.parts.size(); ++p) {
    Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (Index c = 0; c < solid.cell.cols(); ++c) {
      if (solid.part_of[static_cast<std::size_t>(c)] != static_cast<int>(p)) continue;
      for (Index k = 0; k < solid.cell.rows(); ++k) {
        const Vector3d X = solid.turn.transpose() * solid.node.col(solid.cell(k, c));
        low = low.cwiseMin(X);
        high = high.cwiseMax(X);
      }
    }
    size.col(static_cast<Index>(p)) = high - low;
  }
  return size;
}

double thinnest(const Solid& solid) {
  return part_sizes(solid).topRows(solid.dimension).minCoeff();
}

std::string material_law(const std::vector<Part>& parts) {
  constexpr std::array<std::pair<MaterialModel, const char*>, 3> known = {
      {{MaterialModel::linear, "linear elasticity"},
       {MaterialModel::saint_venant_kirchhoff, "Saint Venant-Kirchhoff"},
       {MaterialModel::neo_hookean, "neo-Hookean"}}};
  std::vector<std::pair<std::string, std::string>> laws;  // law, names of its parts
  for (const auto& [model, law] : known)
    for (const Part& part : parts) {
      if (part.material.model != model) continue;
      if (laws.empty() || laws.back().first != law) laws.emplace_back(law, "");
      std::string& names = laws.back().second;
      names += (names.empty() ? "" : ", ") + part.name;
    }
  std::string text;
  for (const auto& [law, names] : laws)
    text += (text.empty() ? "" : " and ") + law + (laws.size() > 1 ? " (" + names + ")" : "");
  return text;
}

bool all_linear(const std::vector<Part>& parts) {
  return std::all_of(parts.begin(), parts.end(),
                     [](const Part& part) { return part.material.model == MaterialModel::linear; });
}

}  // namespace strake::structure
