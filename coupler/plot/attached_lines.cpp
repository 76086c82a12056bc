#include "coupler/attachments/catenary.hpp"
#include "coupler/case/case_view.hpp"
#include "coupler/plot/scene.hpp"
#include "proto/lookup.hpp"

#include <cstdlib>

namespace strake::picture {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Keys = std::map<std::string, std::string>;

constexpr int places = 60;  // along a catenary

double number(const Keys& keys, const std::string& key) {
  return std::strtod(at_or(keys, key, "0").c_str(), nullptr);
}

/// "[[-0.2, -0.2, 0], [0.2, -0.2, 0]]"
std::vector<Vector3d> list(const Keys& keys, const std::string& key) {
  const std::vector<double> numbers = numbers_in(at_or(keys, key));
  std::vector<Vector3d> points;
  for (std::size_t k = 0; k + 2 < numbers.size(); k += 3)
    points.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
  return points;
}

/// How far the point of the frame that was nearest to a place at the start has moved since.
Vector3d moved(const Frame& frame, const Vector3d& at) {
  for (const Frame::Array& array : frame.point_data) {
    if (array.name != "displacement" || array.value.rows() != 3 || array.value.cols() == 0) continue;
    Index nearest = 0;
    (frame.position - array.value).colwise().operator-(at).colwise().squaredNorm().minCoeff(&nearest);
    return array.value.col(nearest);
  }
  return Vector3d::Zero();
}

Points catenary_between(const Keys& keys, const std::string& table, const Vector3d& anchor,
                        const Vector3d& end) {
  CatenaryParameters line;
  line.length = number(keys, table + ".length");
  line.weight = number(keys, table + ".weight");
  line.axial_stiffness = number(keys, table + ".axial_stiffness");
  line.bottom = at_or(keys, table + ".bottom", "true") == "true";
  const std::vector<Vector3d> gravity = list(keys, "fluid.gravity");
  if (gravity.empty() || gravity.front().norm() == 0 || line.length <= 0 || line.axial_stiffness <= 0)
    return {};
  const Vector3d up = -gravity.front().normalized(), across = end - anchor;
  const double z = across.dot(up);
  const Vector3d level = across - z * up;
  const double x = level.norm();
  const Vector3d out = x > 0 ? Vector3d(level / x) : Vector3d(0, 0, 0);
  const Eigen::Matrix2Xd shape = catenary_shape(line, x, z, places);
  Points curve(3, places);
  for (Index k = 0; k < places; ++k) curve.col(k) = anchor + shape(0, k) * out + shape(1, k) * up;
  return curve;
}

}  // namespace

std::vector<Points> attached_lines(const Keys& keys, const Frame& structure, const std::string& body) {
  std::vector<Points> lines;
  for (const auto& [key, name] : keys) {
    const std::string table = "attachments." + name;
    if (key != table + ".name" || at_or(keys, table + ".body") != body) continue;
    const std::string solver = at_or(keys, table + ".solver");
    const std::vector<Vector3d> at = list(keys, table + ".at"),
                                anchor = list(keys, table + "." + solver + ".anchor");
    for (std::size_t k = 0; k < at.size() && k < anchor.size(); ++k) {
      const Vector3d end = at[k] + moved(structure, at[k]);
      Points line(3, 2);
      line << anchor[k], end;
      if (solver == "catenary") line = catenary_between(keys, table + ".catenary", anchor[k], end);
      if (line.cols() > 1) lines.push_back(std::move(line));
    }
  }
  return lines;
}

}  // namespace strake::picture
