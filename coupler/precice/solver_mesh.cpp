#include "coupler/precice/solver_mesh.hpp"

#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace strake {

int SolverMesh::add_vertex(std::span<const double> position) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < position.size() && i < 3; ++i)
    point[static_cast<Eigen::Index>(i)] = position[i];
  if (!point.allFinite()) {
    std::vector<std::string> numbers;
    for (const double x : position) numbers.push_back(fmt::format("{}", x));
    throw Error(ExitCode::solver_fault, name_,
                fmt::format("vertex {} has a coordinate that is not finite: {}", size(), joined(numbers)),
                "");
  }
  points_.push_back(point);
  return size() - 1;
}

const int* SolverMesh::find_invalid(std::span<const int> ids) const {
  const auto found = std::find_if(ids.begin(), ids.end(), [this](int id) { return id < 0 || id >= size(); });
  return found == ids.end() ? nullptr : &*found;
}

void SolverMesh::check(std::initializer_list<int> ids, const char* what) const {
  if (const int* invalid = find_invalid({ids.begin(), ids.size()}))
    throw Error(ExitCode::solver_fault, name_,
                fmt::format("{} with vertex {}, which it does not have", what, *invalid),
                size() == 0 ? "set the vertices first"
                            : fmt::format("vertices are numbered from 0 to {}", size() - 1));
  for (const int* id = ids.begin(); id != ids.end(); ++id)
    if (std::find(id + 1, ids.end(), *id) != ids.end())
      throw Error(ExitCode::solver_fault, name_, fmt::format("{} that has vertex {} twice", what, *id),
                  "its vertices must differ");
}

void SolverMesh::add_face(std::vector<int> ids) {
  std::vector<int> sorted = ids;
  std::sort(sorted.begin(), sorted.end());
  if (known_.insert(std::move(sorted)).second) faces_.push_back(std::move(ids));
}

void SolverMesh::add_edge(int first, int second) {
  check({first, second}, "an edge");
  if (dimension_ == 2) add_face({first, second});
}

void SolverMesh::add_triangle(int first, int second, int third) {
  check({first, second, third}, "a triangle");
  if (dimension_ == 3) add_face({first, second, third});
}

void SolverMesh::add_quad(int first, int second, int third, int fourth) {
  if (dimension_ == 2)
    throw Error(ExitCode::solver_fault, name_, "has two dimensions and takes no quadrilaterals", "set edges");
  check({first, second, third, fourth}, "a quadrilateral");
  const double one = (point(first) - point(third)).norm(), other = (point(second) - point(fourth)).norm();
  if (one <= other) {
    add_face({first, second, third});
    add_face({first, third, fourth});
  } else {
    add_face({first, second, fourth});
    add_face({second, third, fourth});
  }
}

void SolverMesh::add_tetrahedron(int first, int second, int third, int fourth) const {
  if (dimension_ == 2)
    throw Error(ExitCode::solver_fault, name_, "has two dimensions and takes no tetrahedra", "set triangles");
  check({first, second, third, fourth}, "a tetrahedron");
}

InterfaceMesh SolverMesh::interface_mesh() const {
  InterfaceMesh mesh;
  mesh.name = name_;
  mesh.dimension = dimension_;
  mesh.position.resize(3, size());
  for (int i = 0; i < size(); ++i) mesh.position.col(i) = point(i);
  mesh.faces.resize(dimension_, static_cast<Eigen::Index>(faces_.size()));
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (int k = 0; k < dimension_; ++k)
      mesh.faces(k, static_cast<Eigen::Index>(f)) = faces_[f][static_cast<std::size_t>(k)];
  return mesh;
}

InterfaceMesh joined(const std::vector<InterfaceMesh>& all, const std::string& name) {
  if (all.size() == 1) return all.front();
  InterfaceMesh mesh;
  mesh.name = name;
  mesh.dimension = all.front().dimension;
  Eigen::Index points = 0, faces = 0;
  for (const InterfaceMesh& one : all) {
    mesh.meshes.push_back({one.name, points, faces});
    points += one.position.cols();
    faces += one.faces.cols();
  }
  mesh.position.resize(3, points);
  mesh.faces.resize(mesh.dimension, faces);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto& [own_name, point, face] = mesh.meshes[k];
    mesh.position.middleCols(point, all[k].position.cols()) = all[k].position;
    mesh.faces.middleCols(face, all[k].faces.cols()) = all[k].faces.array() + static_cast<int>(point);
  }
  return mesh;
}

}  // namespace strake
