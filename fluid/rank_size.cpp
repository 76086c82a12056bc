#include "fluid/particles/state.hpp"
#include "fluid/size.hpp"

#include <Eigen/Core>

#include <algorithm>

namespace strake::fluid {

namespace {

/// Width of the ghosts [l0]: two buckets, each a little wider than the search's radius.
constexpr double ghost_width = 2 * 3.15;
/// Bytes of a particle with its neighbours and its equation in the plane and in space, and of a process
/// alone. Measured on still tanks of 1e5 to 5e5 particles, on 1 to 4 ranks.
constexpr double plane = 1500, space = 3000, process = 80e6;
/// Bytes of a ghost, which has no neighbours of its own. Measured: 370 on 8 ranks of 62 000 particles in
/// space, before its owner and the rank that has it noted 48 each of its motion.
constexpr double of_ghost = 500;
/// Bytes that the first rank takes for each particle of the whole to count voids.
constexpr double voids = 35;

struct Box {
  Eigen::Vector3d low, high;
};

/// Share of ghosts of the part with most of them.
double most_ghosts(const Box& part, const Box& whole, int dimension, int ranks) {
  const Eigen::Vector3d size = part.high - part.low;
  if (ranks == 1) {
    double own = 1, with_ghosts = 1;
    for (int d = 0; d < dimension; ++d) {
      own *= size[d];
      with_ghosts *= std::min(part.high[d] + ghost_width, whole.high[d]) -
                     std::max(part.low[d] - ghost_width, whole.low[d]);
    }
    return own > 0 ? with_ghosts / own - 1 : 0;
  }
  Eigen::Index axis = 0;
  size.head(dimension).maxCoeff(&axis);
  const int lower_ranks = ranks / 2;
  Box lower = part, upper = part;
  lower.high[axis] = upper.low[axis] = part.low[axis] + size[axis] * lower_ranks / ranks;
  return std::max(most_ghosts(lower, whole, dimension, lower_ranks),
                  most_ghosts(upper, whole, dimension, ranks - lower_ranks));
}

}  // namespace

RankSize rank_size(const Parameters& p, std::int64_t water, std::int64_t layers) {
  const Box box{p.water.min / p.spacing, p.water.max / p.spacing};
  const double ghosts = most_ghosts(box, box, p.dimension, p.ranks);
  const double each = p.dimension == 2 ? plane : space;
  // A position, a velocity, an acceleration and a wall's velocity, and the other columns of a state.
  const double state = 8.0 * (4 * p.dimension + 6) + 11;
  const auto all = static_cast<double>(water + layers);
  const bool moves = p.motion.moves();
  const double of_rank = all / p.ranks * (each + ghosts * of_ghost) +
                         (moves ? state * static_cast<double>(layers) : 0.0) + process;
  // Where the water is packed or the tank moves, each rank makes the whole once.
  const double start = (moves || p.submerged ? 2 * state * all : 0.0) + process;
  return {ghosts, std::max(of_rank, start), std::max(of_rank + voids * all, start)};
}

}  // namespace strake::fluid
