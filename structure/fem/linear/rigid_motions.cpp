#include "proto/error.hpp"
#include "structure/fem/mesh/mesh.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>

namespace strake::structure::fem {
namespace {

constexpr int count(int dim) {
  return dim == 2 ? 3 : 6;
}

/// The rigid motions of all unknowns, as if none were fixed.
template <int dim>
Eigen::MatrixXd motions_of(const Mesh<dim>& mesh) {
  const RankDivision& division = mesh.division;
  const auto own_nodes = mesh.node.leftCols(division.own(mesh.n_unknowns()) / dim);
  const Eigen::Matrix<double, dim, 1> middle = division.sum(own_nodes.rowwise().sum().eval()) *
                                               (dim / static_cast<double>(division.size(mesh.n_unknowns())));
  const double length = division.max((mesh.node.colwise() - middle).cwiseAbs().maxCoeff());
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(mesh.n_unknowns(), count(dim));
  for (int i = 0; i < mesh.n_nodes(); ++i) {
    const Eigen::Matrix<double, dim, 1> r = (mesh.node.col(i) - middle) / length;
    for (int k = 0; k < dim; ++k) motions(dim * i + k, k) = 1;
    if constexpr (dim == 2) {
      motions.template block<2, 1>(2 * i, 2) << -r(1), r(0);
    } else {
      for (int axis = 0; axis < 3; ++axis)
        motions.template block<3, 1>(3 * i, 3 + axis) = Eigen::Vector3d::Unit(axis).cross(r);
    }
  }
  return motions;
}

}  // namespace

template <int dim>
Eigen::MatrixXd rigid_motions(const Mesh<dim>& mesh) {
  Eigen::MatrixXd motions = motions_of(mesh);
  for (const int i : mesh.fixed) motions.row(i).setZero();
  return motions;
}

// Counts the rigid motions that the supports leave. It subtracts from their number the rank of u = a + ω × (X
// − X̄)/L, restricted to the fixed unknowns.
template <int dim>
int rigid_motions_left(const Mesh<dim>& mesh) {
  std::vector<int> own = mesh.fixed;
  std::erase_if(own, [&](int i) { return !mesh.division.owns(i); });
  const Eigen::MatrixXd fixed = motions_of(mesh)(own, Eigen::all);
  constexpr double stopped = 1e-10;  // of the largest pivot: the square of what round-off leaves of a rank
  Eigen::FullPivLU<Eigen::MatrixXd> factors;
  factors.setThreshold(stopped).compute(mesh.division.sum(Eigen::MatrixXd(fixed.transpose() * fixed)));
  return static_cast<int>(factors.dimensionOfKernel());
}

template <int dim>
void require_constrained(const Mesh<dim>& mesh) {
  if (rigid_motions_left(mesh) > 0)
    throw Error(
        ExitCode::case_file, "structure.analysis = \"static\"",
        "without enough supports there is no equilibrium: the body can move or turn as a whole",
        "hold it: structure.plate.supports, the supports of a structure.box, or [[structure.support]]");
}

template <int dim>
void require_free(const Mesh<dim>& mesh) {
  const RankDivision& division = mesh.division;
  const Eigen::Index all = division.size(mesh.n_unknowns());
  const auto held = std::ranges::count_if(mesh.fixed, [&](int i) { return division.owns(i); });
  const auto free = static_cast<double>(all) - division.sum(static_cast<double>(held));
  if (free < 2)  // one has no frequency that an iteration could find
    throw Error(ExitCode::case_file, "structure.fem",
                fmt::format("of {} unknowns of this mesh the supports leave {:.0f} free, too few to deform",
                            all, free),
                "structure.fem.refinement = 1 or more, a smaller cell_size, or degree = 2");
}

template void require_free(const Mesh<2>&);
template void require_free(const Mesh<3>&);
template Eigen::MatrixXd rigid_motions(const Mesh<2>&);
template Eigen::MatrixXd rigid_motions(const Mesh<3>&);
template int rigid_motions_left(const Mesh<2>&);
template int rigid_motions_left(const Mesh<3>&);
template void require_constrained(const Mesh<2>&);
template void require_constrained(const Mesh<3>&);

}  // namespace strake::structure::fem
