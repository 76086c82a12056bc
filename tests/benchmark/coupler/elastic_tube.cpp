// The elastic tube of tests/method/coupling/elastic_tube.hpp as two processes through ZeroMQ. Measures
// iterations per window and time per iteration. Figures of preCICE 3.4.1 for the same work are quoted beside
// (constant first guess). Called with --connect this program is one of the two processes.

#include "coupler/participant/serve.hpp"
#include "coupler/processes/remote.hpp"
#include "proto/error.hpp"
#include "tests/method/coupling/elastic_tube_run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

namespace {

using namespace strake;

int serve_one(int argc, char** argv) {
  ServeOptions options;
  options.solver = "tube";
  options.version = "1";
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i];
    if (key == "--connect") options.endpoint = argv[i + 1];
    if (key == "--name") options.name = argv[i + 1];
  }
  const char* token = std::getenv("STRAKE_TOKEN");
  options.token = token ? token : "";
  return serve(options, [&](const Setup&) -> std::unique_ptr<Participant> {
    if (options.name == "fluid") return std::make_unique<models::TubeFluid>();
    return std::make_unique<models::TubeWall>();
  });
}

struct Row {
  const char* name;
  AcceleratorParameters accelerator;
  Predictor predictor;
  bool parallel;
  int most;
  const char* peer;
};

void measure(const std::filesystem::path& program, const Row& row) {
  Participants participants(Participants::Options{});
  for (const char* name : {"structure", "fluid"}) participants.launch(name, {program, {}, {}, 1, {}});
  RemoteParticipant& wall = participants.connect("structure", {});
  RemoteParticipant& fluid = participants.connect("fluid", {});
  const auto begin = std::chrono::steady_clock::now();
  try {
    const models::TubeRun run =
        models::run_tube(fluid, wall, row.accelerator, row.predictor, row.parallel, row.most);
    const std::chrono::duration<double> wall_time = std::chrono::steady_clock::now() - begin;
    fmt::print("{:44} {:8.2f} {:6} {:10.3f}   {:12}", row.name, run.iterations, run.unconverged,
               1e3 * wall_time.count() / (100 * run.iterations), row.peer);
    for (int k = 0; k < 3; ++k) fmt::print("  {:.6f} {:9.3f}", run.area[k], run.pressure[k]);
    fmt::print("\n");
    participants.finish();
  } catch (const Error& error) {
    fmt::print("{:44} {}\n{:44} preCICE: {}\n", row.name, error.problem(), "", row.peer);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) return serve_one(argc, argv);
  const auto program = std::filesystem::canonical("/proc/self/exe");
  const AcceleratorParameters eight = models::quasi_newton(8), two = models::quasi_newton(2),
                              imvj = models::quasi_newton(8, "iqn-imvj");
  const auto aitken = [](double relaxation) { return AcceleratorParameters{"aitken", relaxation, 0, 0}; };
  const auto constant = [](double relaxation) { return AcceleratorParameters{"constant", relaxation, 0, 0}; };
  fmt::print("{:44} {:>8} {:>6} {:>10}   {:12}  a and p at x = 5 m after 0.24, 0.50, 1.00 s\n", "",
             "per win.", "unconv", "ms/iter.", "preCICE");
  for (const Row& row : {
           Row{"IQN-ILS, 8 windows", eight, Predictor::quadratic, false, 40, "8.59"},
           Row{"IQN-ILS, 8 windows, constant guess", eight, Predictor::constant, false, 40, "8.59"},
           Row{"IQN-ILS, 2 windows", two, Predictor::quadratic, false, 40, "9.82"},
           Row{"IQN-IMVJ", imvj, Predictor::quadratic, false, 40, "-"},
           Row{"parallel IQN-ILS on a and p, 8 windows", eight, Predictor::quadratic, true, 100, "28.7"},
           Row{"Aitken from 0.5", aitken(0.5), Predictor::quadratic, false, 200, "75, 8 unc."},
           Row{"Aitken from 0.01", aitken(0.01), Predictor::quadratic, false, 200, "62.7, 2 unc."},
           Row{"Aitken from 0.01, constant guess", aitken(0.01), Predictor::constant, false, 200,
               "62.7, 2 unc."},
           Row{"constant 0.01", constant(0.01), Predictor::quadratic, false, 1000, "303"},
           Row{"constant 0.05", constant(0.05), Predictor::quadratic, false, 1000, "diverges"},
       })
    measure(program, row);
}
