#include "proto/error.hpp"
#include "tests/method/structure/locking_bodies.hpp"

#include <cstdio>

// Tables of the locking of finite elements: fem_locking_benchmark. Tests check the important figures.

namespace {

using namespace strake::structure;
using namespace strake::structure::fem;

constexpr struct {
  const char* name;
  Kind kind;
} kinds[] = {{"Q1", q1_plain}, {"Q1 enhanced", q1_cured}, {"Q2", q2_plain}, {"Q2 enhanced", q2_cured}};

void cook(const char* title, const Material& material, double force) {
  std::printf("\n%s\n%-12s", title, "cells");
  for (const int n : {2, 4, 8, 16, 32}) std::printf("%10dx%-3d", n, n);
  for (const auto& [name, kind] : kinds) {
    std::printf("\n%-12s", name);
    for (const int n : {2, 4, 8, 16, 32}) {
      try {
        std::printf("%14.5g", cooks_rise(n, material, kind, force));
      } catch (const strake::Error&) {
        std::printf("%14s", "none found");
      }
      std::fflush(stdout);
    }
  }
  std::printf("\n");
}

}  // namespace

int main() {
  const auto linear = MaterialModel::linear;
  cook("Cook's panel, plane stress, nu = 1/3, rise of the right side's middle (23.96)",
       {.model = linear, .density = 1, .young = 1, .poisson = 1 / 3.0, .plane_stress = true}, 1);
  cook("Cook's panel, plane strain, nu = 0.499",
       {.model = linear, .density = 1, .young = 1, .poisson = 0.499}, 1);
  cook("Cook's panel, plane strain, nu = 0.4999",
       {.model = linear, .density = 1, .young = 1, .poisson = 0.4999}, 1);
  cook("Cook's panel, neo-Hookean, plane strain, mu = 80.194, kappa/mu = 5000, force 100",
       {.model = MaterialModel::neo_hookean, .density = 1, .young = 240.566, .poisson = 0.4999}, 100);

  std::printf("\nclamped strip over its reference, cells through the thickness\n%-24s", "");
  for (const int r : {0, 1, 2, 3}) std::printf("%10d", 1 << r);
  for (const bool cantilever : {false, true})
    for (const auto& [name, kind] : kinds) {
      std::printf("\n%-12s%-12s", cantilever ? "cantilever" : "clamped", name);
      for (const int r : {0, 1, 2, 3})
        std::printf("%10.4f", strip_deflection(kind, r, cantilever) / (cantilever ? 2.0822e-3 : 4.462e-5));
      std::fflush(stdout);
    }

  std::printf("\n\nbar of three dimensions, length 4, over Timoshenko's beam\n%-36s", "cells through it");
  for (const int n : {1, 2, 4}) std::printf("%10d", n);
  for (const double nu : {0.3, 0.499})
    for (const double distortion : {0.0, 0.2})
      for (const auto& [name, kind] : kinds) {
        std::printf("\n%-12s nu %-6g %-14s", name, nu, distortion > 0 ? "distorted" : "");
        for (const int n : {1, 2, 4}) {
          if (kind.degree == 2 && n == 4) continue;
          std::printf("%10.4f",
                      bar_over_beam(4, n, {.model = linear, .density = 1, .young = 1, .poisson = nu}, kind,
                                    distortion));
        }
        std::fflush(stdout);
      }
  std::printf("\n");
}
