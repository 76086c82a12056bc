// One of two masses of 1 kg between springs: wall, k = 4π², mass, k12 = 16π², mass, k = 4π², wall. Each is a
// participant that sends its displacement and takes the other's, in four time steps a window. It knows
// preCICE's functions alone.
#include <precice/precice.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

constexpr double pi = 3.14159265358979323846, k = 4 * pi * pi, k12 = 16 * pi * pi;
constexpr int steps_per_window = 4;

struct State {
  double t = 0, u = 0, v = 0, a = 0;
};

/// One step of Newmark's method with the mean acceleration: u'' = k12 u_other − (k + k12) u.
State step(const State& from, double dt, double other) {
  const double stiffness = k + k12;
  const double guess = from.u + dt * from.v + dt * dt / 4 * from.a;
  State to = from;
  to.t += dt;
  to.u = (guess + dt * dt / 4 * k12 * other) / (1 + dt * dt / 4 * stiffness);
  to.a = k12 * other - stiffness * to.u;
  to.v += dt / 2 * (from.a + to.a);
  return to;
}

/// Left begins at u = 1, right at 0, both at rest: half of each of the two modes.
double exact(bool left, double t) {
  const double together = std::cos(std::sqrt(k) * t), against = std::cos(std::sqrt(k + 2 * k12) * t);
  return left ? (together + against) / 2 : (together - against) / 2;
}

}  // namespace

/// oscillator Left|Right CONFIG: prints the largest error at the windows' ends.
int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string side = argv[1], other = side == "Left" ? "Right" : "Left";
  const bool left = side == "Left";
  const std::string mesh = side + "-Mesh", own_data = "Displacement-" + side,
                    other_data = "Displacement-" + other;
  precice::Participant coupling(side, argv[2], 0, 1);
  const std::vector<double> place(static_cast<std::size_t>(coupling.getMeshDimensions(mesh)), 0.0);
  const std::vector<int> ids{coupling.setMeshVertex(mesh, place)};
  State now;
  now.u = left ? 1 : 0;
  now.a = left ? -(k + k12) : k12;
  std::vector<double> mine{now.u, 0}, theirs{0, 0};
  if (coupling.requiresInitialData()) coupling.writeData(mesh, own_data, ids, mine);
  coupling.initialize();
  State saved = now;
  double window = coupling.getMaxTimeStepSize(), largest = 0;
  while (coupling.isCouplingOngoing()) {
    if (coupling.requiresWritingCheckpoint()) saved = now, window = coupling.getMaxTimeStepSize();
    const double dt = std::min(window / steps_per_window, coupling.getMaxTimeStepSize());
    coupling.readData(mesh, other_data, ids, dt, theirs);
    now = step(now, dt, theirs[0]);
    mine[0] = now.u;
    coupling.writeData(mesh, own_data, ids, mine);
    coupling.advance(dt);
    if (coupling.requiresReadingCheckpoint()) now = saved;
    if (coupling.isTimeWindowComplete()) largest = std::max(largest, std::abs(now.u - exact(left, now.t)));
  }
  std::printf("error %.6f\n", largest);
  coupling.finalize();
}
