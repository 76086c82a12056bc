#include "structure/rigid.hpp"

#include "structure/surface.hpp"

#include <fmt/format.h>

namespace strake::structure {

Rigid::Rigid(const Parameters& p)
    : velocity_(p.velocity),
      mass_(p.material.density * p.plate.length * p.plate.thickness),
      mesh_(surface(p)) {}

void Rigid::advance(double t, double dt, const Load&) {
  state_.time = t + dt;
  ++state_.steps;
}

Points Rigid::displacement() const {
  return (velocity_ * state_.time).replicate(1, mesh_.position.cols());
}

Points Rigid::velocity() const {
  return velocity_.replicate(1, mesh_.position.cols());
}

Energy Rigid::energy() const {
  return {.kinetic = 0.5 * mass_ * velocity_.squaredNorm(), .strain = 0, .external = 0};
}

void Rigid::write(Archive& archive) const {
  archive.real["rigid.time"] = Eigen::MatrixXd::Constant(1, 1, saved_.time);
  archive.integer["rigid.steps"] = {saved_.steps};
}

void Rigid::read(const Archive& archive) {
  state_.time = archive.real.at("rigid.time")(0, 0);
  state_.steps = static_cast<int>(archive.integer.at("rigid.steps").at(0));
  saved_ = state_;
}

Frame Rigid::frame() const {
  return outline_frame(state_.time, mesh_, displacement(), velocity());
}

std::vector<std::string> Rigid::lines() const {
  return {
      fmt::format("rigid   {} interface points   speed {:.4g} m/s", mesh_.position.cols(), velocity_.norm())};
}

Frame outline_frame(double time, const InterfaceMesh& mesh, const Points& displacement,
                    const Points& velocity) {
  Frame frame;
  frame.time = time;
  frame.position = mesh.position + displacement;
  frame.cells = mesh.faces;
  frame.point_data = {{"displacement", "m", displacement}, {"velocity", "m/s", velocity}};
  return frame;
}

}  // namespace strake::structure
