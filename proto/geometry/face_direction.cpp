#include "proto/geometry/face_direction.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Where two faces may meet: a point of a segment, an edge of a triangle (two points, the smaller first).
using Ridge = std::pair<int, int>;
/// A ridge with the sense in which its face passes it; neighbours of one direction pass it in two senses.
struct Passed {
  Ridge ridge;
  bool forward;
};

std::vector<Passed> ridges_of(const Eigen::MatrixXi& faces, Index f) {
  std::vector<Passed> passed;
  if (faces.rows() == 2) return {{{faces(0, f), -1}, false}, {{faces(1, f), -1}, true}};
  for (int k = 0; k < 3; ++k) {
    const int a = faces(k, f), b = faces((k + 1) % 3, f);
    passed.push_back({{std::min(a, b), std::max(a, b)}, a < b});
  }
  return passed;
}

void turn(Eigen::MatrixXi& faces, Index f) {
  std::swap(faces(0, f), faces(1, f));
}

/// Twice the area, or six times the volume, that a face adds to what its piece encloses.
double enclosed(const Eigen::MatrixXi& faces, Index f, const Eigen::Matrix3Xd& position,
                const Vector3d& origin) {
  const auto at = [&](int k) -> Vector3d { return position.col(faces(k, f)) - origin; };
  const Vector3d normal = at(0).cross(at(1));
  return faces.rows() == 2 ? normal.z() : normal.dot(at(2));
}

/// Faces that share a ridge; at most two may.
std::map<Ridge, std::vector<Index>> neighbours(const Eigen::MatrixXi& faces) {
  std::map<Ridge, std::vector<Index>> meet;
  for (Index f = 0; f < faces.cols(); ++f)
    for (const Passed& passed : ridges_of(faces, f)) meet[passed.ridge].push_back(f);
  return meet;
}

bool passes_forward(const Eigen::MatrixXi& faces, Index f, const Ridge& ridge) {
  for (const Passed& passed : ridges_of(faces, f))
    if (passed.ridge == ridge) return passed.forward;
  return false;
}

}  // namespace

bool orient(Eigen::MatrixXi& faces, const Eigen::Matrix3Xd& position) {
  const auto meet = neighbours(faces);
  for (const auto& [ridge, sharing] : meet)
    if (sharing.size() > 2) return false;
  std::vector<char> seen(static_cast<std::size_t>(faces.cols()), 0);
  for (Index first = 0; first < faces.cols(); ++first) {
    if (seen[static_cast<std::size_t>(first)] != 0) continue;
    std::vector<Index> piece = {first};
    seen[static_cast<std::size_t>(first)] = 1;
    bool closed = true;
    for (std::size_t k = 0; k < piece.size(); ++k)
      for (const Passed& passed : ridges_of(faces, piece[k])) {
        const std::vector<Index>& sharing = meet.at(passed.ridge);
        if (sharing.size() < 2) {
          closed = false;
          continue;
        }
        const Index other = sharing[0] == piece[k] ? sharing[1] : sharing[0];
        const bool alike = passes_forward(faces, other, passed.ridge) != passed.forward;
        if (seen[static_cast<std::size_t>(other)] != 0) {
          if (!alike) return false;
          continue;
        }
        if (!alike) turn(faces, other);
        seen[static_cast<std::size_t>(other)] = 1;
        piece.push_back(other);
      }
    double inside = 0;
    for (const Index f : piece) inside += enclosed(faces, f, position, position.col(faces(0, first)));
    if (closed && inside < 0)
      for (const Index f : piece) turn(faces, f);
  }
  return true;
}

// The origin is a point of the body, so that round-off stays small.
double enclosed_volume(const Eigen::MatrixXi& faces, const Eigen::Matrix3Xd& position) {
  double sum = 0;
  for (Index f = 0; f < faces.cols(); ++f) sum += enclosed(faces, f, position, position.col(0));
  return sum / (faces.rows() == 2 ? 2 : 6);
}

}  // namespace strake
