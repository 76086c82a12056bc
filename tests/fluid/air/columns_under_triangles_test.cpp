#include "fluid/air/air_layer.hpp"
#include "fluid/air/lower_faces.hpp"
#include "fluid/air/near_columns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace strake::fluid {
namespace columns_under_triangles_test {

using std::numbers::pi;

/// A fan of triangles around a corner ring that looks down, and a wet point in the middle of each l0-cell.
struct Plate {
  InterfaceMesh mesh;
  std::vector<int> triangles;
  std::vector<std::vector<int>> points_of;
  Eigen::Matrix2Xd points;
};

/// corners: x, z in order, of a polygon that its middle sees whole.
Plate fan(const std::vector<Eigen::Vector2d>& corners, double spacing) {
  Plate out;
  const auto n = static_cast<int>(corners.size());
  out.mesh.dimension = 3;
  out.mesh.position.setZero(3, n + 1);
  out.mesh.faces.resize(3, n);
  Eigen::Vector2d low = corners[0], high = low;
  for (int k = 0; k < n; ++k) {
    const Eigen::Vector2d& x = corners[static_cast<std::size_t>(k)];
    out.mesh.position.col(k + 1) << x.x(), 0, x.y();
    out.mesh.faces.col(k) << 0, k + 1, (k + 1) % n + 1;
    out.triangles.push_back(k);
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  out.points_of.resize(corners.size());
  std::vector<Eigen::Vector2d> points;
  for (double x = low.x() + 0.5 * spacing; x < high.x(); x += spacing)
    for (double z = low.y() + 0.5 * spacing; z < high.y(); z += spacing)
      for (int k = 0; k < n; ++k) {
        const Eigen::Vector2d a = corners[static_cast<std::size_t>(k)],
                              b = corners[static_cast<std::size_t>((k + 1) % n)], p(x, z);
        const double whole = a.x() * b.y() - a.y() * b.x();
        const double s = (p.x() * b.y() - p.y() * b.x()) / whole, t = (a.x() * p.y() - a.y() * p.x()) / whole;
        if (s < 0 || t < 0 || s + t > 1) continue;
        out.points_of[static_cast<std::size_t>(k)].push_back(static_cast<int>(points.size()));
        points.push_back(p);
        break;
      }
  out.points.resize(2, static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) out.points.col(static_cast<Eigen::Index>(k)) = points[k];
  return out;
}

AirField<2> only_field(const Plate& plate, double spacing) {
  auto fields = columns_under_triangles(plate.mesh, plate.mesh.position, plate.triangles, plate.points_of,
                                        plate.points, spacing);
  EXPECT_EQ(fields.size(), 1u);
  return fields.at(0);
}

/// Largest |Σ l n| of a column over its sides, and the length of the open border.
std::pair<double, double> opening_and_border(const AirColumns<2>& columns) {
  Eigen::Matrix2Xd sum = Eigen::Matrix2Xd::Zero(2, columns.size());
  double border = 0;
  for (const auto& side : columns.sides) {
    sum.col(side.column) += side.length * side.normal;
    if (side.other >= 0)
      sum.col(side.other) -= side.length * side.normal;
    else
      border += side.length;
  }
  return {sum.colwise().norm().maxCoeff(), border};
}

TEST(ColumnsUnderTriangles, ARectangleIsDividedEvenly) {
  const double l0 = 0.01;
  const AirField<2> field = only_field(fan({{-0.1, -0.05}, {0.1, -0.05}, {0.1, 0.05}, {-0.1, 0.05}}, l0), l0);
  ASSERT_EQ(field.columns.size(), 200);
  EXPECT_NEAR((field.columns.area.array() - l0 * l0).abs().maxCoeff(), 0, 1e-15);
  EXPECT_EQ(field.columns.sides.size(), static_cast<std::size_t>(19 * 10 + 20 * 9 + 60));
  const auto [opening, border] = opening_and_border(field.columns);
  EXPECT_LT(opening, 1e-15);
  EXPECT_NEAR(border, 0.6, 1e-12);
  for (const auto& points : field.points) EXPECT_EQ(points.size(), 1u);
}

TEST(ColumnsUnderTriangles, ATurnedSquareKeepsItsAreaAndBorder) {
  const double l0 = 0.01, side = 0.1;
  std::vector<Eigen::Vector2d> corners;
  for (int k = 0; k < 4; ++k)
    corners.push_back(std::sqrt(0.5) * side *
                      Eigen::Vector2d(std::cos(0.3 + 0.5 * pi * k), std::sin(0.3 + 0.5 * pi * k)));
  const AirField<2> field = only_field(fan(corners, l0), l0);
  EXPECT_NEAR(field.columns.area.sum(), side * side, 1e-14);
  EXPECT_GT(field.columns.area.minCoeff(), 0.29 * l0 * l0);
  const auto [opening, border] = opening_and_border(field.columns);
  EXPECT_LT(opening, 1e-12);
  EXPECT_NEAR(border, 4 * side, 1e-12);
  std::size_t points = 0;
  for (const auto& of_column : field.points) {
    EXPECT_GE(of_column.size(), 1u);
    points += of_column.size();
  }
  EXPECT_GT(points, 80u);
}

TEST(ColumnsUnderTriangles, TwoPlatesAreTwoFields) {
  Plate one = fan({{-0.1, -0.05}, {0, -0.05}, {0, 0.05}, {-0.1, 0.05}}, 0.01);
  const auto n = one.mesh.position.cols();
  InterfaceMesh both = one.mesh;
  both.position.conservativeResize(3, 2 * n);
  both.position.rightCols(n) = one.mesh.position.colwise() + Eigen::Vector3d(0.2, 0, 0);
  both.faces.conservativeResize(3, 8);
  both.faces.rightCols(4) = one.mesh.faces.array() + static_cast<int>(n);
  std::vector<std::vector<int>> points_of(8);
  Eigen::Matrix2Xd points(2, 2 * one.points.cols());
  points << one.points, one.points.colwise() + Eigen::Vector2d(0.2, 0);
  for (std::size_t t = 0; t < 4; ++t) {
    points_of[t] = one.points_of[t];
    for (const int k : one.points_of[t]) points_of[t + 4].push_back(k + static_cast<int>(one.points.cols()));
  }
  const auto fields =
      columns_under_triangles(both, both.position, {0, 1, 2, 3, 4, 5, 6, 7}, points_of, points, 0.01);
  ASSERT_EQ(fields.size(), 2u);
  for (const auto& field : fields) EXPECT_NEAR(field.columns.area.sum(), 0.01, 1e-14);
}

// The cushion under a disc, ⅜ρV²R²/h² (fluid/THEORY.md, section 17a), on cells that its rim cuts.
TEST(ColumnsUnderTriangles, ACutDiscCarriesTheCushion) {
  const double l0 = 0.02, radius = 0.2, h0 = 0.03, h = 0.01, speed = 1;
  std::vector<Eigen::Vector2d> rim;
  for (int k = 0; k < 64; ++k)
    rim.emplace_back(radius * std::cos(2 * pi * k / 64), radius * std::sin(2 * pi * k / 64));
  const AirField<2> field = only_field(fan(rim, l0), l0);
  const AirLayer<2> layer({}, field.columns);
  const int n = field.columns.size(), steps = 400;
  AirState<2> air = layer.start(Eigen::VectorXd::Constant(n, h0), Eigen::VectorXd::Constant(n, speed));
  for (int k = 1; k <= steps; ++k)
    layer.advance(air, Eigen::VectorXd::Constant(n, h0 + (h - h0) * k / steps), (h0 - h) / speed / steps);
  const Eigen::VectorXd rise = layer.pressure(air).array() - layer.air().pressure;
  const double middle = 0.375 * layer.air().density * speed * speed * radius * radius / (h * h);
  EXPECT_NEAR(rise.maxCoeff() / middle, 1, 0.05);
  EXPECT_NEAR((layer.mass(air) + air.mass_out) / (layer.air().density * h0 * field.columns.area.sum()), 1,
              1e-2);
}

TEST(NearColumns, FindsThoseWithinASpacingAndTheirWeights) {
  Eigen::Matrix2Xd place(2, 3);
  place << 0, 0.01, 0.05, 0, 0, 0;
  const NearColumns<2> near(place, 0.01);
  std::map<int, double> found;
  near.for_each({0.0025, 0.005}, [&](int c, double w) { found[c] = w; });
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0], 0.75 * 0.5, 1e-12);
  EXPECT_NEAR(found[1], 0.25 * 0.5, 1e-12);
}

// Round-off may put a place that lies a spacing past the columns two cells past them.
TEST(NearColumns, FindsNoneASpacingPastThem) {
  for (const double spacing : {0.01, 0.02, 0.025, 0.03})
    for (int n = 1; n <= 40; ++n) {
      Eigen::Matrix2Xd place(2, n);
      for (int k = 0; k < n; ++k) place.col(k).setConstant((k + 0.5) * spacing - 0.5 * n * spacing);
      const NearColumns<2> near(place, spacing);
      const NearColumns<1> on_line(place.topRows<1>(), spacing);
      double weights = 0;
      const auto add = [&](int, double w) { weights += w; };
      const double past = (n + 0.5) * spacing - 0.5 * n * spacing;
      for (const double x : {past, -past}) {
        near.for_each({x, x}, add);
        near.for_each({0, x}, add);
        on_line.for_each(Eigen::Matrix<double, 1, 1>(x), add);
      }
      EXPECT_LT(weights, 1e-9) << spacing << " " << n;
    }
}

}  // namespace columns_under_triangles_test
}  // namespace strake::fluid
