#include "structure/solver/solver.hpp"

#include "proto/error.hpp"

#include <utility>

namespace strake::structure {
namespace {

Points on_points(const Eigen::MatrixXd& force, Eigen::Index n_points) {
  Points value = Points::Zero(3, n_points);
  if (force.size() > 0) value.topRows(force.rows()) = force;
  return value;
}

}  // namespace

Load::Load(std::vector<Sample> samples, Interpolation interpolation)
    : interpolation_(interpolation), samples_(std::move(samples)) {}

Points Load::at(double time, Eigen::Index n_points) const {
  return on_points(value_at(samples_, "force", time, interpolation_), n_points);
}

Points Load::mean(double begin, double end, Eigen::Index n_points) const {
  return on_points(mean_over(samples_, "force", begin, end, interpolation_), n_points);
}

void Solver::solve_static() {
  throw Error(ExitCode::case_file, "structure.analysis = \"static\"", "this solver has no static solution",
              "structure.solver = \"fem\" or \"particle\"");
}

std::vector<double> Solver::frequencies(int) {
  throw Error(ExitCode::case_file, "structure.analysis = \"modal\"", "this solver has no natural frequencies",
              "structure.solver = \"fem\" or \"particle\"");
}

Stress Solver::stress_at(const Eigen::Vector3d&) const {
  throw Error(ExitCode::case_file, "output.probe, quantity = \"stress\" or \"von_mises\"",
              "this structure has no stress", "structure.solver = \"fem\" or \"particle\"");
}

}  // namespace strake::structure
