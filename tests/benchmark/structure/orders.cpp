#include "structure/particle/solver.hpp"
#include "tests/method/structure/locking_bodies.hpp"
#include "tests/method/structure/smooth_solution.hpp"
#include "tests/structure/paper_plate.hpp"

#include <cmath>
#include <cstdio>

// Measures how errors fall with the distance of nodes and particles. Each output line is "series,size,error",
// where size is the number of cells or layers through the body. orders.py draws them.

namespace {

using namespace strake::structure;

void print(const char* series, int size, double error) {
  std::printf("%s,%d,%.6e\n", series, size, error);
  std::fflush(stdout);
}

/// cases/VALIDATION.md, "Strips: deflection and frequencies": the clamped strip's deflection against its
/// reference in two dimensions.
double error_of_layers(int layers, double hourglass) {
  Parameters p = paper_plate(layers);
  p.particle.hourglass = hourglass;
  p.load = {.kind = LoadKind::traction, .value = {0, -1e5, 0}, .face = "top", .at = {}, .ramp = 0};
  ParticleSolver<2> solver(p);
  solver.solve_static();
  return std::abs(-solver.displacement_at({0, 0.01, 0}).y() / 4.462e-5 - 1);
}

/// First frequency of the free strip against that of Q2 cells, 8 through it.
double error_of_free_strip(int layers, double hourglass, double reference) {
  Parameters p = paper_plate(layers);
  p.particle.hourglass = hourglass;
  p.plate.left = p.plate.right = Support::free;
  return std::abs(ParticleSolver<2>(p).frequencies(1).front() / reference - 1);
}

double free_strip() {
  Parameters p = paper_plate(2);
  p.kind = "fem";
  p.plate.left = p.plate.right = Support::free;
  return fem::FemSolver<2>(p).frequencies(1).front();
}

}  // namespace

int main() {
  for (const int refinement : {1, 2, 3, 4}) {
    print("fem Q1 smooth", 1 << refinement, fem::error_of_smooth_solution(1, refinement));
    print("fem Q2 smooth", 1 << refinement, fem::error_of_smooth_solution(2, refinement));
  }
  for (const int refinement : {0, 1, 2, 3}) {
    print("fem Q1 clamped strip", 1 << refinement,
          std::abs(fem::strip_deflection(fem::q1_cured, refinement, false) / 4.462e-5 - 1));
    print("fem Q2 clamped strip", 1 << refinement,
          std::abs(fem::strip_deflection(fem::q2_plain, refinement, false) / 4.462e-5 - 1));
  }
  const double reference = free_strip();
  for (const double hourglass : {1.0, 0.1})
    for (const int layers : {2, 4, 8, 16}) {
      const char* free = hourglass == 1 ? "particles free f1 alpha 1" : "particles free f1 alpha 0.1";
      const char* clamped =
          hourglass == 1 ? "particles clamped strip alpha 1" : "particles clamped strip alpha 0.1";
      print(free, layers, error_of_free_strip(layers, hourglass, reference));
      print(clamped, layers, error_of_layers(layers, hourglass));
    }
}
