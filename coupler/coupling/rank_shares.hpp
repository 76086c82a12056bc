#pragma once

#include <map>
#include <string>
#include <vector>

namespace strake {

/// What one rank of a solver has done so far, from its monitors "ranks.<number>.<what>".
struct RankShare {
  double busy = 0, halo = 0,
         waiting = 0;                // [s] computing; in messages to other ranks; waiting for all of them
  double particles = 0, ghosts = 0;  // own ones, and copies of others' (unknowns of a structure)
  double memory = 0, sent = 0;       // [bytes] most so far; in messages
  double cpu = 0;                          // [s] of processors outside messages, of all threads
};

/// Returns the shares of all ranks in their order; none where a solver has one rank.
std::vector<RankShare> rank_shares(const std::map<std::string, double>& monitor);

/// Returns the largest time of computing over the mean one.
double imbalance(const std::vector<RankShare>&);

/// A table of them, a line each, under a heading.
std::vector<std::string> rank_lines(const std::vector<RankShare>&);

}  // namespace strake
