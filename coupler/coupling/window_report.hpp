#pragma once

#include "coupler/coupling/convergence.hpp"
#include "proto/interface.hpp"

#include <limits>
#include <map>
#include <string>
#include <vector>

namespace strake {

/// One coupling iteration: a line of iterations.csv.
struct IterationReport {
  int iteration = 0;
  double residual = 0, threshold = 0;               // of the structure's first field, [m] for a displacement
  std::vector<FieldResidual> fields;                // all that is measured; the first one as above
  double relaxation = 0;                            // ω of the step to the next iterate, where one was used
  int columns = 0, dropped = 0;                     // of IQN-ILS in that step
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // [N] whole load on the structure
  bool settled() const;
};

/// Work of the committed increment Δu on each side of the mapping.
struct InterfaceWork {
  double fluid = 0, structure = 0;  // [J] f·Δu
  double unconverged = 0;           // [J] f·(hx − x): what the accepted residual gave to the structure
  double gap() const;               // |W_f − W_s| / max(|W_f|, |W_s|); 0 when both are
};

struct WindowReport {
  Window window;
  int number = 0;  // of this window, from 1
  int iterations = 0;
  double residual = 0, threshold = 0;  // of the structure's first field, [m] for a displacement
  bool converged = false;              // every measured field settled; volume coupling has none: true
  /// A solver, or Unconverged::halve, requests a shorter window. Both solvers have been rewound; call
  /// `advance` again with at most `dt_limit`. Everything below is empty then.
  bool retry = false;
  std::string why, fix;  // a retry: who wants it and why, and what a user may change
  double dt_limit =
      std::numeric_limits<double>::infinity();  // [s] longest next window that both solvers accept
  InterfaceWork work;
  /// 3×n on the structure's mesh. velocity is 3×0 if the structure sends none; all are 3×0 if other fields
  /// are exchanged.
  Values displacement = Points(), velocity = Points(), force = Points();
  std::vector<Field> from_structure, from_fluid;   // all else that is exchanged, on the structure's mesh
  std::vector<Field> from_attachments;             // the sum of their forces; none without any
  std::map<std::string, double> fluid, structure;  // Advanced::monitor of each
  std::map<std::string, double> attachments;       // of all of them, each name behind the attachment's
  /// All monitors in one, without the reserved prefixes (seconds., count., check., memory., alarm., ranks.).
  std::map<std::string, double> monitor() const;
  std::vector<IterationReport> log;
  Eigen::Vector3d total_force() const;  // [N] Σ force, as the last iteration has it; 0 without one
};

/// What one rank of a solver has done so far, from its monitors "ranks.<number>.<what>".
struct RankShare {
  double busy = 0, halo = 0,
         waiting = 0;                // [s] computing; in messages to other ranks; waiting for all of them
  double particles = 0, ghosts = 0;  // own ones, and copies of others' (unknowns of a structure)
  double memory = 0, sent = 0;       // [bytes] most so far; in messages
  double cpu = 0;                    // [s] of processors outside messages, of all threads
};

/// Returns the shares of all ranks in their order; none where a solver has one rank.
/// body: whose ranks, of several bodies in one monitor ("left.ranks.0.busy"); empty: the solver's own.
std::vector<RankShare> rank_shares(const std::map<std::string, double>& monitor,
                                   const std::string& body = "");

/// Returns the largest time of computing over the mean one.
double imbalance(const std::vector<RankShare>&);

/// A table of them, a line each, under a heading.
std::vector<std::string> rank_lines(const std::vector<RankShare>&);

}  // namespace strake
