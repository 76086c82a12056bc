#include "fluid/air/lower_faces.hpp"

namespace strake::fluid {
namespace {

constexpr double looks_down = 0.5;  // −n_y of a face from which on it has air under it; 60° against the level
constexpr double closed_within = 0.5;  // [l0] from a wall of the tank: no air passes

// Each body is walked counter-clockwise, so that its lower faces come in the order of x. Of several bodies
// the point after the last of one is the first of the same one.
std::vector<AirField<1>> fields_of(const BodySurface2d& body, double /*spacing*/, int per_point) {
  const int n = body.points();
  const auto following = [&](int k) { return body.mesh().faces(1, k); };
  std::vector<int> before(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) before[static_cast<std::size_t>(following(k))] = k;
  const auto down = [&](int k) { return -body.normal(k)[1] > looks_down; };
  std::vector<AirField<1>> fields;
  for (int first = 0; first < n; ++first) {
    if (!down(first) || down(before[static_cast<std::size_t>(first)])) continue;
    AirField<1> field;
    std::vector<double> middle, width;
    for (int point = first; down(point); point = following(point)) {
      const double whole = -body.normal(point)[1] * body.area(point);
      for (int part = 0; part < per_point; ++part) {
        field.points.push_back({point});
        middle.push_back(body.point(point)[0] + ((part + 0.5) / per_point - 0.5) * whole);
        width.push_back(whole / per_point);
      }
    }
    const auto size = static_cast<Eigen::Index>(middle.size());
    field.columns =
        air_strip(Eigen::VectorXd::Map(middle.data(), size), Eigen::VectorXd::Map(width.data(), size));
    fields.push_back(std::move(field));
  }
  return fields;
}

std::vector<AirField<2>> fields_of(const BodySurface3d& body, double spacing, int /*per_point*/) {
  const InterfaceMesh& mesh = body.mesh();
  std::vector<int> down;
  for (int t = 0; t < static_cast<int>(mesh.faces.cols()); ++t)
    if (-body.face_normal(t)[1] > looks_down) down.push_back(t);
  std::vector<std::vector<int>> points_of(static_cast<std::size_t>(mesh.faces.cols()));
  Eigen::Matrix2Xd place(2, body.points());
  for (int k = 0; k < body.points(); ++k) {
    points_of[static_cast<std::size_t>(body.triangle_of(k))].push_back(k);
    place.col(k) = Eigen::Vector2d(body.point(k).x(), body.point(k).z());
  }
  return columns_under_triangles(mesh, body.mesh_points(), down, points_of, place, spacing);
}

}  // namespace

template <int dim>
std::vector<AirField<dim - 1>> lower_faces(const Boundary<dim>& boundary, double spacing, int per_point) {
  const BodySurface<dim>& body = boundary.body_surface();
  std::vector<AirField<dim - 1>> fields = fields_of(body, spacing, per_point);
  for (auto& field : fields)
    std::erase_if(field.columns.sides, [&](const auto& side) {
      if (side.other >= 0) return false;
      Vector<dim> place = body.point(field.points[static_cast<std::size_t>(side.column)].front());
      place[0] = side.middle[0];
      if constexpr (dim == 3) place[2] = side.middle[1];
      return boundary.tank().distance(place) < closed_within * spacing || boundary.goes_on_over_seam(place);
    });
  return fields;
}

template std::vector<AirField<1>> lower_faces<2>(const Boundary<2>&, double, int);
template std::vector<AirField<2>> lower_faces<3>(const Boundary<3>&, double, int);

}  // namespace strake::fluid
