#include "structure/rigid/support_frame.hpp"

#include "structure/body/mechanism.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>

namespace strake::structure {

SupportFrame::SupportFrame(const Parameters& p)
    : holds_(has_supports(elastic_solid(p))),
      free_{p.free.x, p.free.y, p.free.z},
      mass_(p.body.lumped_mass),
      velocity_(p.velocity),
      pivot_(p.pivot.value_or(Eigen::Vector3d::Zero())),
      motion_(p.motion) {
  if (!holds_) free_ = {};
}

FrameState SupportFrame::start() const {
  FrameState state = prescribed(0);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (is_free(axis)) state.acceleration[axis] = 0;
  return state;
}

// The prescribed motion at a time. A table is relative to its place at t = 0; a direction that it does not
// give has the constant speed.
FrameState SupportFrame::prescribed(double time) const {
  FrameState state{.displacement = velocity_ * time, .velocity = velocity_, .acceleration = {0, 0, 0}};
  if (!motion_) return state;
  const RigidMotion now = motion_->at(time), first = motion_->at(0);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!motion_->gives(static_cast<std::size_t>(axis))) continue;
    state.displacement[axis] = now.displacement[axis] - first.displacement[axis];
    state.velocity[axis] = now.velocity[axis];
    state.acceleration[axis] = now.acceleration[axis];
  }
  state.angle = now.angle - first.angle;
  state.angular_velocity = now.angular_velocity;
  return state;
}

Eigen::Vector3d SupportFrame::turned(const FrameState& state, const Eigen::Vector3d& X) const {
  const Eigen::Vector3d arm = X - pivot_;
  return Eigen::AngleAxisd(state.angle, Eigen::Vector3d::UnitZ()) * arm - arm;
}

Eigen::Vector3d SupportFrame::turning(const FrameState& state, const Eigen::Vector3d& X) const {
  const Eigen::Vector3d arm = X - pivot_ + turned(state, X);
  return state.angular_velocity * Eigen::Vector3d::UnitZ().cross(arm);
}

namespace {

bool tells(const SupportFrame& frame) {
  return frame.is_free() || frame.by_table();
}

}  // namespace

std::vector<Column> frame_columns(const SupportFrame& frame, int dimension) {
  std::vector<Column> columns;
  if (!tells(frame)) return columns;
  for (const auto& [name, unit] : {std::pair{"support.", "m"}, {"support.v", "m/s"}, {"support.f", "N"}})
    for (int axis = 0; axis < dimension; ++axis) columns.push_back({std::string(name) + "xyz"[axis], unit});
  return columns;
}

std::map<std::string, double> frame_monitor(const SupportFrame& frame, int dimension, const FrameState& state,
                                            const Eigen::Vector3d& reaction) {
  std::map<std::string, double> monitor;
  const std::vector<Column> columns = frame_columns(frame, dimension);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto axis = static_cast<Eigen::Index>(k) % dimension;
    const Eigen::Index what = static_cast<Eigen::Index>(k) / dimension;
    monitor[columns[k].name] = what == 0   ? state.displacement[axis]
                               : what == 1 ? state.velocity[axis]
                                           : reaction[axis];
  }
  return monitor;
}

std::string frame_line(const SupportFrame& frame, int dimension) {
  if (!frame.holds()) return nothing_holds;
  if (!tells(frame)) return {};
  std::string free;
  for (int axis = 0; axis < dimension; ++axis)
    if (frame.is_free(axis)) free += std::string(free.empty() ? "" : ", ") + "xyz"[axis];
  std::string line = "supports";
  if (!free.empty())
    line += fmt::format("   free in {}, lumped mass {:.6g} {}", free, frame.mass(),
                        dimension == 2 ? "kg/m" : "kg");
  if (frame.by_table()) line += frame.turns() ? "   driven and turned by a table" : "   driven by a table";
  return line;
}

// Profiles are interpolated by the cubic spline of motion tables; beyond their ends they continue likewise.
Eigen::Vector3d velocity_at_start(const InitialVelocity& initial, int part, const Eigen::Vector3d& X) {
  Eigen::Vector3d velocity = initial.value;
  if (!initial.of_part.empty()) velocity += initial.of_part.at(static_cast<std::size_t>(part));
  if (initial.profile) {
    const MotionTable& profile = *initial.profile;
    const double place = std::clamp(X[initial.along], profile.start(), profile.end());
    velocity += profile.at(place).displacement;
  }
  return velocity;
}

}  // namespace strake::structure
