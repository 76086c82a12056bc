#include "proto/case/case_file.hpp"
#include "proto/case/window_choice.hpp"
#include "proto/files/history.hpp"
#include "proto/mesh_files/mesh_text.hpp"
#include "proto/mesh_files/stl.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

namespace strake {
namespace {

constexpr double degree = std::numbers::pi / 180;  // [rad]
using Corners = std::vector<Eigen::Vector3d>;

double number_at(const CaseFile& file, const std::string& path, double otherwise) {
  const std::vector<double> numbers = file.numbers_at(path);
  return numbers.empty() ? otherwise : numbers.front();
}

/// The vector at a key, [x, y] or [x, y, z]; 0 where it is not given.
Eigen::Vector3d vector_at(const CaseFile& file, const std::string& path) {
  const std::vector<double> numbers = file.numbers_at(path);
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < std::min<std::size_t>(3, numbers.size()); ++k)
    vector[static_cast<Eigen::Index>(k)] = numbers[k];
  return vector;
}

std::filesystem::path file_at(const CaseFile& file, const std::string& path) {
  return file.folder() / file.text_at(path);
}

void add_outline(const CaseFile& file, Corners& corners) {
  for (std::size_t k = 0;; ++k) {
    const std::string path = fmt::format("structure.outline[{}]", k);
    if (file.numbers_at(path).empty()) return;
    corners.push_back(vector_at(file, path));
  }
}

void add_wedge(const CaseFile& file, Corners& corners) {
  const Eigen::Vector3d apex = vector_at(file, "structure.wedge.apex");
  const double slope = std::tan(degree * number_at(file, "structure.wedge.deadrise", 0)),
               draught = number_at(file, "structure.wedge.draught", 0),
               width = number_at(file, "structure.wedge.width", slope > 0 ? 2 * draught / slope : 0),
               height = number_at(file, "structure.wedge.height", 0.5 * width * slope + 0.25 * width);
  corners.push_back(apex);
  for (const double side : {-0.5, 0.5})
    for (const double y : {0.5 * width * slope, height})
      corners.push_back(apex + Eigen::Vector3d(side * width, y, 0));
}

/// Both faces of a plate, turned about the middle of the lower one.
void add_plate(const CaseFile& file, Corners& corners) {
  const Eigen::Vector3d bottom = vector_at(file, "structure.plate.bottom");
  const Eigen::AngleAxisd turn(degree * number_at(file, "structure.plate.angle", 0),
                               Eigen::Vector3d::UnitZ());
  const double length = number_at(file, "structure.plate.length", 0),
               hollow = number_at(file, "structure.plate.hollow", 0);
  for (const double side : {-0.5, 0.5})
    for (const double y : {-hollow, number_at(file, "structure.plate.thickness", 0)})
      corners.emplace_back(bottom + turn * Eigen::Vector3d(side * length, y, 0));
}

void add_boxes(const CaseFile& file, Corners& corners) {
  for (int k = 0; file.has(fmt::format("structure.box[{}].min", k)); ++k) {
    const Eigen::Vector3d low = vector_at(file, fmt::format("structure.box[{}].min", k)),
                          high = vector_at(file, fmt::format("structure.box[{}].max", k));
    for (const double x : {low.x(), high.x()})
      for (const double y : {low.y(), high.y()})
        for (const double z : {low.z(), high.z()}) corners.emplace_back(x, y, z);
  }
}

void add_mesh(const CaseFile& file, Corners& corners) {
  const std::filesystem::path path = file_at(file, "structure.mesh");
  if (is_stl(path)) {
    const Points triangles = read_stl(path);
    for (Eigen::Index k = 0; k < triangles.cols(); ++k) corners.emplace_back(triangles.col(k));
    return;
  }
  for (const auto& [number, node] : read_mesh_text(path).node)
    corners.emplace_back(node[0], node[1], node[2]);
}

/// Half a section on both sides. Without `station` all sections of the table count.
void add_offsets(const CaseFile& file, Corners& corners) {
  constexpr double same_station = 1e-6;  // [m]
  const Table table = read_given_table(file_at(file, "structure.offsets"));
  std::array<const std::vector<double>*, 3> column{};
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    for (std::size_t k = 0; k < 3; ++k)
      if (table.columns[c].name == std::array{"station", "height", "half_breadth"}[k])
        column[k] = &table.value[c];
  if (column[1] == nullptr || column[2] == nullptr) return;
  const std::vector<double> station = file.numbers_at("structure.station");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!station.empty() && column[0] != nullptr &&
        std::abs((*column[0])[row] - station.front()) > same_station)
      continue;
    for (const double side : {-1.0, 1.0})
      corners.emplace_back(side * (*column[2])[row], (*column[1])[row], 0);
  }
}

/// x = s R X + m, as [structure.placed] has it.
void place(const CaseFile& file, Corners& corners) {
  Eigen::Vector3d axis = vector_at(file, "structure.placed.axis");
  if (axis.isZero()) axis = Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(degree * number_at(file, "structure.placed.angle", 0), axis.normalized())
          .toRotationMatrix();
  const double scale = number_at(file, "structure.placed.scale", 1);
  const Eigen::Vector3d move = vector_at(file, "structure.placed.move");
  for (Eigen::Vector3d& corner : corners) corner = scale * (turn * corner) + move;
}

/// Outermost points of a body that is not round; none where the case does not tell them.
Corners corners_of(const CaseFile& file) {
  Corners corners;
  if (file.has("structure.plate")) {
    add_plate(file, corners);
    return corners;
  }
  if (file.has("structure.outline")) add_outline(file, corners);
  if (file.has("structure.wedge")) add_wedge(file, corners);
  if (file.has("structure.box")) add_boxes(file, corners);
  if (file.has("structure.mesh")) add_mesh(file, corners);
  if (file.has("structure.offsets")) add_offsets(file, corners);
  place(file, corners);
  return corners;
}

}  // namespace

double reach_of_body(const CaseFile& file) {
  const char* pivot = file.has("structure.pivot") ? "structure.pivot" : "structure.centre_of_gravity";
  for (const std::string round : {"structure.cylinder", "structure.sphere"})
    if (file.has(round))
      return file.has(pivot) ? (vector_at(file, round + ".centre") - vector_at(file, pivot)).head<2>().norm()
                             : 0;
  Corners corners;
  try {
    corners = corners_of(file);
  } catch (const Error&) {
    return 0;
  }
  if (corners.empty()) return 0;
  Eigen::Vector3d low = corners.front(), high = low;
  for (const Eigen::Vector3d& corner : corners) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const Eigen::Vector3d centre = file.has(pivot) ? vector_at(file, pivot) : 0.5 * (low + high);
  double reach = 0;
  for (const Eigen::Vector3d& corner : corners) reach = std::max(reach, (corner - centre).head<2>().norm());
  return std::isfinite(reach) ? reach : 0;
}

}  // namespace strake
