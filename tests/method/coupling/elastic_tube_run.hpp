#pragma once

#include "coupler/coupling/scheme.hpp"
#include "tests/method/coupling/elastic_tube.hpp"

#include <string>

namespace strake::models {

struct TubeRun {
  double iterations = 0;  // mean per window
  int unconverged = 0;
  double area[3] = {}, pressure[3] = {};  // at x = 5 m after 0.24, 0.50 and 1.00 s
};

/// 100 windows, converged when both fields change by no more than `limit` of their own norm in an iteration.
inline TubeRun run_tube(Participant& fluid, Participant& wall, const AcceleratorParameters& accelerator,
                        Predictor predictor, bool parallel, int most, double limit = 1e-5) {
  SchemeParameters parameters;
  parameters.parallel = parallel;
  parameters.convergence = {limit, 0, Measure::value, 1, most, Unconverged::accept};
  parameters.predictor = predictor;
  parameters.accelerator = accelerator;
  Scheme scheme(fluid, wall,
                FieldTransfer(nearest_neighbour(wall.mesh(), fluid.mesh()),
                              nearest_neighbour(fluid.mesh(), wall.mesh())),
                parameters);
  TubeRun run;
  constexpr int windows = 100, seen[] = {24, 50, 100};
  for (int w = 0; w < windows; ++w) {
    const WindowReport report = scheme.advance({w * Tube::dt, Tube::dt});
    scheme.commit(false);
    run.iterations += report.iterations / static_cast<double>(windows);
    if (!report.converged) ++run.unconverged;
    for (int k = 0; k < 3; ++k)
      if (w + 1 == seen[k]) {
        run.area[k] = find(scheme.state().structure.back().others, "area")->value(0, 50);
        run.pressure[k] = find(report.from_fluid, "pressure")->value(0, 50);
      }
  }
  return run;
}

inline AcceleratorParameters quasi_newton(int reused_windows, const std::string& kind = "iqn-ils") {
  AcceleratorParameters parameters;
  parameters.kind = kind;
  parameters.initial_relaxation = 0.01;
  parameters.reused_windows = reused_windows;
  parameters.filter = 1e-3;
  return parameters;
}

}  // namespace strake::models
