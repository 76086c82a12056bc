#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>

#include <set>
#include <span>
#include <string>
#include <vector>

namespace strake {

/// The mesh that a solver sets point by point and face by face, before the run. Every function throws
/// Error(solver_fault) for a vertex that is not there, a face that uses one twice, and numbers that are not
/// finite.
class SolverMesh {
 public:
  SolverMesh(std::string name, int dimension) : name_(std::move(name)), dimension_(dimension) {}

  const std::string& name() const { return name_; }
  int dimension() const { return dimension_; }
  int size() const { return static_cast<int>(points_.size()); }
  /// The coordinates of a vertex [m]; z = 0 in two dimensions.
  const Eigen::Vector3d& point(int id) const { return points_[static_cast<std::size_t>(id)]; }

  /// position: `dimension` numbers [m]. Returns the vertex's number.
  int add_vertex(std::span<const double> position);
  /// In two dimensions a face of the surface; in three dimensions not used.
  void add_edge(int first, int second);
  /// In three dimensions a face of the surface; in two dimensions not used.
  void add_triangle(int first, int second, int third);
  /// Two triangles, cut along the shorter diagonal. Error in two dimensions.
  void add_quad(int first, int second, int third, int fourth);
  /// Checked and not used. Error in two dimensions.
  void add_tetrahedron(int first, int second, int third, int fourth) const;

  /// The first number that is no vertex; nullptr if all are.
  const int* find_invalid(std::span<const int> ids) const;
  /// The mesh as the coupler takes it; each face once.
  InterfaceMesh interface_mesh() const;

 private:
  void check(std::initializer_list<int> ids, const char* what) const;
  void add_face(std::vector<int> ids);

  std::string name_;
  int dimension_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::vector<int>> faces_;
  std::set<std::vector<int>> known_;  // sorted
};

/// Several meshes as the coupler takes them: one after the other in one, whose `meshes` names them. One alone
/// stays as it is. name: of the joined mesh.
InterfaceMesh joined(const std::vector<InterfaceMesh>&, const std::string& name);

}  // namespace strake
