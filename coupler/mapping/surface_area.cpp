#include "coupler/mapping/mapping_parts.hpp"
#include "coupler/mapping/point_tree.hpp"

#include <Eigen/Geometry>

#include <cassert>
#include <vector>

namespace strake {

using Eigen::Index;
using Eigen::Vector3d;

namespace {

/// Length (2-D) or area of a face [m, m²].
double measure(const InterfaceMesh& mesh, Index f) {
  const auto corner = [&](Index k) -> Vector3d { return mesh.position.col(mesh.faces(k, f)); };
  if (mesh.faces.rows() == 2) return (corner(1) - corner(0)).norm();
  return 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
}

/// Centres of the equal parts of a segment or triangle, with edges divided into n, as weights of the corners.
std::vector<Vector3d> centres_of_parts(Index corners, int n) {
  std::vector<Vector3d> centres;
  for (int i = 0; i < n; ++i) {
    if (corners == 2) {
      const double t = (i + 0.5) / n;
      centres.emplace_back(1 - t, t, 0);
      continue;
    }
    for (int j = 0; i + j < n; ++j)
      for (const double third :
           {1.0 / 3, 2.0 / 3}) {  // the part that points as the face does, and its mirror
        if (third > 0.5 && i + j + 1 >= n) continue;
        const double u = (i + third) / n, v = (j + third) / n;
        centres.emplace_back(1 - u - v, u, v);
      }
  }
  return centres;
}

}  // namespace

Eigen::VectorXd point_areas(const InterfaceMesh& mesh) {
  Eigen::VectorXd area = Eigen::VectorXd::Zero(mesh.position.cols());
  for (Index f = 0; f < mesh.faces.cols(); ++f)
    for (Index k = 0; k < mesh.faces.rows(); ++k)
      area[mesh.faces(k, f)] += measure(mesh, f) / static_cast<double>(mesh.faces.rows());
  return area;
}

Eigen::VectorXd nearest_areas(const Points& points, const InterfaceMesh& surface, int fineness) {
  const PointTree tree(points);
  const Index corners = surface.faces.rows();
  const std::vector<Vector3d> parts = centres_of_parts(corners, fineness);
  Eigen::VectorXd area = Eigen::VectorXd::Zero(points.cols());
  for (Index f = 0; f < surface.faces.cols(); ++f) {
    const double part = measure(surface, f) / static_cast<double>(parts.size());
    for (const Vector3d& weight : parts) {
      Vector3d centre = Vector3d::Zero();
      for (Index k = 0; k < corners; ++k) centre += weight[k] * surface.position.col(surface.faces(k, f));
      area[tree.nearest(centre, 1e-12)] += part;
    }
  }
  return area;
}

// v'_i = v_i + |v_i| (S − Σ A v)/Σ A|v|. Where v has one sign this is v S/Σ A v, the scaled-consistent
// mapping as it is usually written; where its parts cancel it stays bounded, and what is zero (dry) stays
// zero.
void match_integral(Eigen::Ref<Eigen::MatrixXd> value, const Eigen::VectorXd& area,
                    const Eigen::VectorXd& wanted) {
  assert(value.cols() == area.size() && value.rows() == wanted.size());
  const Eigen::VectorXd sum = value * area, absolute = value.cwiseAbs() * area;
  for (Index d = 0; d < value.rows(); ++d) {
    if (!(absolute[d] > 0)) continue;
    value.row(d) += (wanted[d] - sum[d]) / absolute[d] * value.row(d).cwiseAbs();
  }
}

void match_sums(Eigen::Ref<Eigen::MatrixXd> value, const Eigen::VectorXd& wanted) {
  match_integral(value, Eigen::VectorXd::Ones(value.cols()), wanted);
}

}  // namespace strake
