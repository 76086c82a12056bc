// One of two solvers that solve nothing: each adds 1 to what the other sent. It says in which order preCICE's
// functions ask for its state, and can fail on request.
#include <precice/precice.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

/// What the solver does in its fifth time step.
void fail(const std::string& how, precice::Participant& coupling) {
  if (how == "throw") throw std::runtime_error("the matrix is singular");
  if (how == "leave") coupling.finalize();
  if (how == "leave") std::exit(0);
  if (how == "exit") std::_Exit(3);
  if (how == "abort") std::abort();
  if (how == "misuse") coupling.advance(-1);
}

int run(const std::string& name, const std::string& config, const std::string& how) {
  precice::Participant coupling(name, config, 0, 1);
  const std::string mesh = name + "-Mesh", own = "Data-" + name,
                    other = name == "One" ? "Data-Two" : "Data-One";
  const std::vector<double> positions{0, 0, 0, 1, 0, 0, 2, 0, 0};
  std::vector<int> ids(3);
  std::vector<double> values(9, 0.0);
  coupling.setMeshVertices(mesh, positions, ids);
  coupling.initialize();
  int steps = 0;
  while (coupling.isCouplingOngoing()) {
    if (coupling.requiresWritingCheckpoint()) std::puts("saves");
    const double dt = coupling.getMaxTimeStepSize();
    if (how != "unread") coupling.readData(mesh, other, ids, how == "early" ? 0 : dt, values);
    if (++steps == 5) fail(how, coupling);
    if (how == "slow") std::this_thread::sleep_for(std::chrono::milliseconds(10));
#if defined(STRAKE_NAMES_OF) && STRAKE_NAMES_OF >= 302
    coupling.startProfilingSection("adding");
    for (double& value : values) value += 1;
    coupling.stopLastProfilingSection();
#else
    for (double& value : values) value += 1;
#endif
    if (how != "unwritten" || steps < 5) coupling.writeData(mesh, own, ids, values);
    coupling.advance(dt);
    std::puts(coupling.requiresReadingCheckpoint() ? "goes back" : "goes on");
  }
  coupling.finalize();
  std::printf("%d steps, last value %g\n", steps, values[8]);
  return 0;
}

}  // namespace

/// dummy One|Two CONFIG [throw | leave | exit | abort | misuse | slow | unwritten | unread | early]
int main(int argc, char** argv) {
  if (argc < 3) return 2;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  try {
    return run(argv[1], argv[2], argc > 3 ? argv[3] : "");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
