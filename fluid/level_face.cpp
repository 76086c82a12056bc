#include "fluid/level_face.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake::fluid {

double level_face(const InterfaceMesh& mesh, double water_level) {
  const double least = std::cos(std::numbers::pi / 180);
  double level = 0;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const Eigen::Vector3d a = mesh.position.col(mesh.faces(0, f)), b = mesh.position.col(mesh.faces(1, f));
    double lowest = std::min(a.y(), b.y());
    Eigen::Vector3d normal(b.y() - a.y(), a.x() - b.x(), 0);  // as long as the face
    if (mesh.dimension == 3) {
      const Eigen::Vector3d c = mesh.position.col(mesh.faces(2, f));
      lowest = std::min(lowest, c.y());
      normal = 0.5 * (b - a).cross(c - a);
    }
    if (-normal.y() > least * normal.norm() && lowest >= water_level) level += normal.norm();
  }
  return level;
}

}  // namespace strake::fluid
