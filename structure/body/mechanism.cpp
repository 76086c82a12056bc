#include "structure/body/mechanism.hpp"

#include "proto/visible.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// A place that supports hold, and the directions in which they do.
struct Held {
  Vector3d place;
  std::vector<Vector3d> direction;
};

std::vector<Vector3d> all_directions(const Solid& solid) {
  std::vector<Vector3d> all;
  for (Index axis = 0; axis < solid.dimension; ++axis) all.push_back(Vector3d::Unit(axis));
  return all;
}

/// The ends of the line at a face's middle that a pinned or rolling face is held by; in the plane the middle.
std::vector<Vector3d> ends_of_line(const Solid& solid, const SupportedFace& face) {
  const Vector3d middle = middle_of(solid, face);
  if (solid.dimension == 2) return {middle};
  const Vector3d along = normal_of(solid, face).cross(shorter_direction(solid, face));
  double low = 0, high = 0;
  for (const int f : face.facet)
    for (Index k = 0; k < solid.facet.rows(); ++k) {
      const double reach = along.dot(Vector3d(solid.node.col(solid.facet(k, f))) - middle);
      low = std::min(low, reach);
      high = std::max(high, reach);
    }
  return {middle + low * along, middle + high * along};
}

void hold_face(const Solid& solid, const SupportedFace& face, std::vector<Held>& held) {
  if (face.support == Support::free || face.facet.empty()) return;
  std::vector<Vector3d> directions = all_directions(solid);
  if (face.support == Support::symmetry) directions = {Vector3d::Unit(axis_of(solid, face))};
  if (face.support == Support::roller) {
    Index across = 0;
    shorter_direction(solid, face).cwiseAbs().maxCoeff(&across);
    directions = {Vector3d::Unit(across)};
  }
  if (face.support == Support::pinned || face.support == Support::roller) {
    for (const Vector3d& end : ends_of_line(solid, face)) held.push_back({end, directions});
    return;
  }
  for (const int f : face.facet)
    for (Index k = 0; k < solid.facet.rows(); ++k)
      held.push_back({solid.node.col(solid.facet(k, f)), directions});
}

std::vector<Held> held_places(const Solid& solid) {
  std::vector<Held> held;
  for (const SupportedFace& face : solid.supported) hold_face(solid, face, held);
  for (Index c = 0; c < solid.cell.cols(); ++c)
    if (solid.part(c).constrained)
      for (Index k = 0; k < solid.cell.rows(); ++k)
        held.push_back({solid.node.col(solid.cell(k, c)), all_directions(solid)});
  return held;
}

/// Directions d in which u = a + ω × r, ω = turn/L, moves no held place: a basis of (a, turn), one per
/// column. In the plane these are a_x, a_y and the turn about z; in space three and three.
MatrixXd kernel_of(const std::vector<Held>& held, const Vector3d& middle, double length, int dimension) {
  const Index n = dimension == 2 ? 3 : 6;
  MatrixXd square = MatrixXd::Zero(n, n);
  for (const Held& one : held)
    for (const Vector3d& d : one.direction) {
      const Vector3d moment = (one.place - middle).cross(d) / length;  // d·(ω × r) = ω·(r × d)
      Eigen::VectorXd row(n);
      if (dimension == 2)
        row << d.x(), d.y(), moment.z();
      else
        row << d, moment;
      square += row * row.transpose();
    }
  constexpr double stopped = 1e-10;  // of the largest pivot: the square of what round-off leaves of a rank
  Eigen::FullPivLU<MatrixXd> factors;
  factors.setThreshold(stopped).compute(square);
  return factors.dimensionOfKernel() == 0 ? MatrixXd(n, 0) : MatrixXd(factors.kernel());
}

/// The axes along which all of a space's vectors lie, as "x and z"; where they do not lie along axes, none.
std::string axes_of(const MatrixXd& vectors) {
  constexpr double round_off = 1e-6;
  std::vector<std::string> names;
  for (Index axis = 0; axis < vectors.rows(); ++axis)
    if (vectors.row(axis).norm() > round_off * vectors.norm()) names.emplace_back(1, "xyz"[axis]);
  return static_cast<Index>(names.size()) == vectors.cols() ? joined(names, " and ") : "";
}

/// A basis of the space that the columns span.
MatrixXd image_of(const MatrixXd& columns) {
  if (columns.cols() == 0 || columns.norm() < 1e-9) return MatrixXd(columns.rows(), 0);
  Eigen::FullPivLU<MatrixXd> factors;
  factors.setThreshold(1e-9).compute(columns);
  return factors.image(columns);
}

/// The translations among the motions: combinations that do not turn.
MatrixXd translations_of(const MatrixXd& motions, int dimension) {
  const Index turns = motions.rows() - dimension;
  Eigen::FullPivLU<MatrixXd> factors;
  factors.setThreshold(1e-9).compute(motions.bottomRows(turns));
  if (factors.dimensionOfKernel() == 0) return MatrixXd(dimension, 0);
  return (motions * factors.kernel()).topRows(dimension);
}

}  // namespace

std::string motions_left(const Solid& solid) {
  if (solid.empty() || !has_supports(solid)) return {};
  const Vector3d low = solid.node.rowwise().minCoeff(), high = solid.node.rowwise().maxCoeff(),
                 middle = 0.5 * (low + high);
  const double length = 0.5 * (high - low).head(solid.dimension).maxCoeff();
  const MatrixXd motions = kernel_of(held_places(solid), middle, length, solid.dimension);
  if (motions.cols() == 0) return {};
  const MatrixXd moves = translations_of(motions, solid.dimension),
                 turns = image_of(motions.bottomRows(motions.rows() - solid.dimension));
  std::vector<std::string> words;
  if (moves.cols() > 0) {
    const std::string axes = axes_of(moves);
    words.push_back(axes.empty() ? fmt::format("moves as a whole in {} directions", moves.cols())
                                 : "moves along " + axes);
  }
  if (turns.cols() > 0 && solid.dimension == 2 && moves.cols() == 0) {
    const Eigen::VectorXd u = motions.col(0) / motions(2, 0);
    const double slack = 1e-9 * length;
    Vector3d centre = middle + length * Vector3d(-u[1], u[0], 0);
    centre = (centre.array().abs() < slack).select(0, centre);
    words.push_back(fmt::format("turns about ({:.4g}, {:.4g}) m", centre.x(), centre.y()));
  } else if (turns.cols() > 0) {
    const std::string axes = solid.dimension == 2 ? "z" : axes_of(turns);
    words.push_back(axes.empty() ? "turns" : "turns about " + axes);
  }
  return fmt::format("{} motion{} of the whole body that strain{} nothing: it {}", motions.cols(),
                     motions.cols() == 1 ? "" : "s", motions.cols() == 1 ? "s" : "", joined(words, " and "));
}

std::vector<std::string> notes_on_unheld(const Parameters& p) {
  std::vector<std::string> notes;
  if (p.kind == "rigid" || p.kind == "replay" || has_supports(elastic_solid(p))) return notes;
  if (p.kind == "ccx") notes.emplace_back(nothing_holds);
  if (p.free.any())
    notes.emplace_back(
        "note: structure.free has no effect: a body without supports moves and turns in every direction");
  return notes;
}

}  // namespace strake::structure
