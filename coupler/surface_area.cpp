#include "coupler/surface_area.hpp"

#include <Eigen/Geometry>
#include <cassert>

namespace strake {

using Eigen::Index;
using Eigen::Vector3d;

Eigen::VectorXd point_areas(const InterfaceMesh& mesh) {
  Eigen::VectorXd area = Eigen::VectorXd::Zero(mesh.position.cols());
  const Index corners = mesh.faces.rows();
  for (Index f = 0; f < mesh.faces.cols(); ++f) {
    const auto corner = [&](Index k) -> Vector3d { return mesh.position.col(mesh.faces(k, f)); };
    const double whole = corners == 2 ? (corner(1) - corner(0)).norm()
                                      : 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (Index k = 0; k < corners; ++k) area[mesh.faces(k, f)] += whole / static_cast<double>(corners);
  }
  return area;
}

// v'_i = v_i + |v_i| (S − Σ A v)/Σ A|v|. Where v has one sign this is v S/Σ A v, the scaled-consistent
// mapping as it is usually written; where its parts cancel it stays bounded, and what is zero (dry) stays
// zero.
void match_integral(Eigen::MatrixXd& value, const Eigen::VectorXd& area, const Eigen::VectorXd& wanted) {
  assert(value.cols() == area.size() && value.rows() == wanted.size());
  const Eigen::VectorXd sum = value * area, absolute = value.cwiseAbs() * area;
  for (Index d = 0; d < value.rows(); ++d) {
    if (!(absolute[d] > 0)) continue;
    value.row(d) += (wanted[d] - sum[d]) / absolute[d] * value.row(d).cwiseAbs();
  }
}

void match_sums(Eigen::MatrixXd& value, const Eigen::VectorXd& wanted) {
  match_integral(value, Eigen::VectorXd::Ones(value.cols()), wanted);
}

}  // namespace strake
