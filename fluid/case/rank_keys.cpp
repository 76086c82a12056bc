#include "proto/case/rank_keys.hpp"

#include "fluid/case/tank_keys.hpp"

#include <fmt/format.h>

#include <cmath>

namespace strake::fluid {

namespace {

/// Particles of water for each rank, below which its ghosts are several times as many.
constexpr double fewest_particles = 1000;

/// The first thing of a case that one rank alone computes; empty: nothing.
std::string only_on_one_rank(const Parameters& p) {
  if (p.scheme.gradient != Gradient::least_squares) return "a scheme other than least-squares";
  if (p.interface == "volume") return "volume coupling";
  if (p.air.layer) return "the air under a body";
  return {};
}

}  // namespace

void read_ranks(CaseTable fluid, Parameters& p) {
  read_rank_keys(fluid,
                 "processes that compute the water together, each with run.threads threads; the "
                 "results are those of one rank to the tolerance of the pressure",
                 p.ranks, p.launcher);
}

void check_ranks(const CaseTable& fluid, const Parameters& p) {
  check_rank_keys(fluid, p.ranks, p.launcher, {only_on_one_rank(p), "ranks = 1, and run.threads"});
  if (p.ranks == 1) return;
  const double volume = (p.water.max - p.water.min).head(p.dimension).prod();
  const double particles = volume / std::pow(p.spacing, p.dimension);
  if (particles < fewest_particles * p.ranks)
    throw fluid.error("ranks",
                      fmt::format("at least {:g} water particles for each rank, these are about {:.0f}",
                                  fewest_particles, particles / p.ranks),
                      fmt::format("ranks = {}, and run.threads",
                                  std::max(1, static_cast<int>(particles / fewest_particles))));
}

}  // namespace strake::fluid
