// cases/VALIDATION.md, "Piston and column" as two processes over ipc. The column is up to a hundred times as
// heavy as the piston.

#include "coupler/coupling/scheme.hpp"
#include "coupler/processes/remote.hpp"
#include "tests/method/coupling/piston_models.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <vector>

namespace strake {
namespace {

SchemeParameters parameters_of(const std::string& accelerator, bool parallel) {
  SchemeParameters parameters;
  parameters.parallel = parallel;
  parameters.convergence = {1e-9, 1e-16, Measure::increment, 1, 20, Unconverged::accept};
  parameters.accelerator.kind = accelerator;
  return parameters;
}

struct Result {
  std::vector<double> place;  // [m] at the ends of the windows
  int most_iterations = 0, unconverged = 0;
  double iterations = 0;  // mean
};

/// Two periods with dt = T/100.
Result two_periods(Participant& fluid, Participant& structure, double mu,
                   const SchemeParameters& parameters) {
  constexpr int windows = 200;
  const double dt = models::piston_period(mu) / 100;
  Scheme scheme(fluid, structure, nearest_neighbour(structure.mesh(), fluid.mesh()), parameters);
  Result run;
  for (int w = 0; w < windows; ++w) {
    const WindowReport report = scheme.advance({w * dt, dt});
    scheme.commit(false);
    run.place.push_back(report.displacement(1, 0));
    run.most_iterations = std::max(run.most_iterations, report.iterations);
    run.unconverged += report.converged ? 0 : 1;
    run.iterations += report.iterations / static_cast<double>(windows);
  }
  return run;
}

Result as_processes(double mu, const SchemeParameters& parameters) {
  Participants participants(Participants::Options{});
  for (const char* name : {"structure", "fluid"})
    participants.launch(
        name,
        {std::filesystem::path(STRAKE_TOYS) / "toy_piston", {"--mu", fmt::format("{}", mu)}, {}, 1, {}});
  RemoteParticipant& structure = participants.connect("structure", {});
  RemoteParticipant& fluid = participants.connect("fluid", {});
  Result run = two_periods(fluid, structure, mu, parameters);
  participants.finish();
  return run;
}

TEST(PistonAsProcesses, ConvergesInFourIterationsWhateverTheMassRatio) {
  for (const double mu : {0.5, 1.0, 2.0, 10.0, 100.0})
    for (const char* accelerator : {"aitken", "iqn-ils"}) {
      const SchemeParameters parameters = parameters_of(accelerator, false);
      const Result run = as_processes(mu, parameters);
      fmt::print("mu {:5}  {:7}  iterations mean {:.2f} max {}\n", mu, accelerator, run.iterations,
                 run.most_iterations);
      EXPECT_LE(run.most_iterations, 4);
      EXPECT_EQ(run.unconverged, 0);
      models::AddedMass column = models::piston_column(mu);
      models::Oscillators spring = models::piston_spring();
      EXPECT_EQ(run.place, two_periods(column, spring, mu, parameters).place);  // to the bit
    }
}

TEST(PistonAsProcesses, ConvergesWhenBothComputeAtOnce) {
  for (const double mu : {0.5, 10.0, 100.0}) {
    const SchemeParameters parameters = parameters_of("iqn-ils", true);
    const Result run = as_processes(mu, parameters);
    fmt::print("mu {:5}  parallel iqn-ils  iterations mean {:.2f} max {}\n", mu, run.iterations,
               run.most_iterations);
    EXPECT_EQ(run.unconverged, 0);
    EXPECT_LE(run.most_iterations, 4);
    models::AddedMass column = models::piston_column(mu);
    models::Oscillators spring = models::piston_spring();
    EXPECT_EQ(run.place, two_periods(column, spring, mu, parameters).place);
  }
}

}  // namespace
}  // namespace strake
