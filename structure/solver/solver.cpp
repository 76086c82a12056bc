#include "structure/solver/solver.hpp"

#include "proto/error.hpp"

namespace strake::structure {

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
