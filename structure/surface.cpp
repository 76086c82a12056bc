#include "structure/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake::structure {
namespace {

/// Points of the outline that lie on one face of the plate.
bool on_face(const Plate& plate, const std::string& face, const Eigen::Vector3d& X) {
  const double near = 1e-9 * plate.length;  // [m] round-off of the coordinates, far below any spacing
  if (face == "bottom") return std::abs(X.y() - plate.bottom.y()) < near;
  if (face == "top") return std::abs(X.y() - plate.bottom.y() - plate.thickness) < near;
  if (face == "left") return std::abs(X.x() - plate.bottom.x() + 0.5 * plate.length) < near;
  return std::abs(X.x() - plate.bottom.x() - 0.5 * plate.length) < near;
}

}  // namespace

InterfaceMesh outline(const Plate& plate, double spacing) {
  const auto parts = [spacing](double edge) {
    return std::max(1, static_cast<int>(std::lround(edge / spacing)));
  };
  const int along = parts(plate.length), through = parts(plate.thickness);
  const int n = 2 * (along + through);
  const double left = plate.bottom.x() - 0.5 * plate.length, right = plate.bottom.x() + 0.5 * plate.length;
  const double low = plate.bottom.y(), high = plate.bottom.y() + plate.thickness;

  InterfaceMesh mesh;
  mesh.name = "structure";
  mesh.dimension = 2;
  mesh.position = Points::Zero(3, n);
  mesh.faces.resize(2, n);
  int at = 0;
  const auto edge = [&](double x0, double y0, double x1, double y1, int count) {
    for (int i = 0; i < count; ++i, ++at) {
      const double s = static_cast<double>(i) / count;
      mesh.position.col(at) << x0 + s * (x1 - x0), y0 + s * (y1 - y0), 0.0;
    }
  };
  edge(left, low, right, low, along);
  edge(right, low, right, high, through);
  edge(right, high, left, high, along);
  edge(left, high, left, low, through);
  for (int i = 0; i < n; ++i) mesh.faces.col(i) << i, (i + 1) % n;
  return mesh;
}

InterfaceMesh surface(const Parameters& p) {
  return outline(p.plate, p.surface_spacing);
}

Eigen::VectorXd point_lengths(const InterfaceMesh& mesh) {
  Eigen::VectorXd length = Eigen::VectorXd::Zero(mesh.position.cols());
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const int a = mesh.faces(0, f), b = mesh.faces(1, f);
    const double half = 0.5 * (mesh.position.col(b) - mesh.position.col(a)).norm();
    length[a] += half;
    length[b] += half;
  }
  return length;
}

Points case_force(const CaseLoad& load, const Plate& plate, const InterfaceMesh& mesh) {
  Points force = Points::Zero(3, mesh.position.cols());
  if (load.kind == LoadKind::traction) {
    for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
      const int a = mesh.faces(0, f), b = mesh.faces(1, f);
      const Eigen::Vector3d xa = mesh.position.col(a), xb = mesh.position.col(b);
      if (!on_face(plate, load.face, xa) || !on_face(plate, load.face, xb)) continue;
      const Eigen::Vector3d half = 0.5 * (xb - xa).norm() * load.value;
      force.col(a) += half;
      force.col(b) += half;
    }
  } else if (load.kind == LoadKind::point) {
    Eigen::Index nearest = 0;
    (mesh.position.colwise() - load.at).colwise().squaredNorm().minCoeff(&nearest);
    force.col(nearest) = load.value;
  }
  return force;
}

double ramp_factor(double t, double ramp) {
  if (ramp <= 0 || t >= ramp) return 1;
  return t <= 0 ? 0 : 0.5 * (1 - std::cos(std::numbers::pi * t / ramp));
}

double enclosed_area(const InterfaceMesh& mesh) {
  double area = 0;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const Eigen::Vector3d a = mesh.position.col(mesh.faces(0, f)), b = mesh.position.col(mesh.faces(1, f));
    area += 0.5 * (a.x() * b.y() - b.x() * a.y());
  }
  return area;
}

}  // namespace strake::structure
