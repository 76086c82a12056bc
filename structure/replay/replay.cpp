#include "structure/replay/replay.hpp"

#include "proto/error.hpp"
#include "proto/geometry/triangle.hpp"
#include "structure/body/surface.hpp"
#include "structure/rigid/rigid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace strake::structure {
namespace {

/// Interpolates a value at X from the corners of the nearest face. The record has values on the surface only.
Eigen::Vector3d on_surface(const InterfaceMesh& mesh, const Points& value, const Eigen::Vector3d& X) {
  double nearest = std::numeric_limits<double>::infinity();
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  const auto corners = mesh.faces.rows();
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    Eigen::Matrix3d place = Eigen::Matrix3d::Zero(), here = Eigen::Matrix3d::Zero();
    for (Eigen::Index k = 0; k < corners; ++k) {
      place.col(k) = mesh.position.col(mesh.faces(k, f));
      here.col(k) = value.col(mesh.faces(k, f));
    }
    Eigen::Vector3d weight = Eigen::Vector3d::Zero();
    if (corners == 2) {
      const Eigen::Vector3d along = place.col(1) - place.col(0);
      weight[1] = std::clamp((X - place.col(0)).dot(along) / along.squaredNorm(), 0.0, 1.0);
      weight[0] = 1 - weight[1];
    } else {
      weight = nearest_in_triangle(place, X);
    }
    const double distance = (X - place * weight).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    result = here * weight;
  }
  return result;
}

}  // namespace

void require_same_mesh(const InterfaceMesh& recorded, const InterfaceMesh& wanted,
                       const std::string& source) {
  const bool same_count = recorded.position.cols() == wanted.position.cols();
  const double size = (wanted.position.rowwise().maxCoeff() - wanted.position.rowwise().minCoeff()).norm();
  if (same_count && (recorded.position - wanted.position).cwiseAbs().maxCoeff() <= 1e-9 * size) return;
  throw Error(ExitCode::case_file, source,
              same_count ? "was recorded on interface points at other places"
                         : fmt::format("was recorded on {} interface points, the case has {}",
                                       recorded.position.cols(), wanted.position.cols()),
              "the same shape and structure.surface_spacing as in the recorded run, surface "
              "coupling in both");
}

Replay::Replay(const Parameters& p, InterfaceRecord record)
    : source_(p.replay_run.string()), record_(std::move(record)) {
  const InterfaceMesh wanted = surface(p);
  require_same_mesh(record_.mesh, wanted, source_);
  record_.mesh = wanted;
  require_end(record_, p.end_time, source_);
}

void Replay::advance(double t, double dt, const Load&) {
  state_.time = t + dt;
  ++state_.steps;
  if (state_.time > record_.end() * (1 + 1e-9))
    throw Error(ExitCode::case_file, source_,
                fmt::format("is over: the record ends at {:.6g} s, the window at {:.6g} s", record_.end(),
                            state_.time),
                fmt::format("end_time = {:.6g}", record_.end()));
}

Points Replay::displacement() const {
  return record_.displacement_at(state_.time);
}

Points Replay::velocity() const {
  return record_.velocity_at(state_.time);
}

Eigen::Vector3d Replay::displacement_at(const Eigen::Vector3d& X) const {
  return on_surface(record_.mesh, displacement(), X);
}

Eigen::Vector3d Replay::velocity_at(const Eigen::Vector3d& X) const {
  return on_surface(record_.mesh, velocity(), X);
}

void Replay::write(Archive& archive) const {
  archive.real["replay.time"] = Eigen::MatrixXd::Constant(1, 1, saved_.time);
  archive.integer["replay.steps"] = {saved_.steps};
}

void Replay::read(const Archive& archive) {
  state_.time = archive.real.at("replay.time")(0, 0);
  state_.steps = static_cast<int>(archive.integer.at("replay.steps").at(0));
  saved_ = state_;
}

Frame Replay::frame() const {
  return outline_frame(state_.time, record_.mesh, displacement(), velocity());
}

std::vector<std::string> Replay::lines() const {
  return {fmt::format("replay of {}   {} interface points   {} windows to {:.6g} s", source_,
                      record_.mesh.position.cols(), record_.windows.size(), record_.end())};
}

}  // namespace strake::structure
