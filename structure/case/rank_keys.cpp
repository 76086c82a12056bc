#include "proto/case/rank_keys.hpp"

#include "structure/case/keys.hpp"

#include <fmt/format.h>

namespace strake::structure {
namespace {

/// The first thing of a case that one rank alone computes; empty: nothing.
std::string only_on_one_rank(const Parameters& p) {
  return p.kind == "fem" ? "" : fmt::format("a {} structure", p.kind);
}

}  // namespace

void read_ranks(CaseTable structure, Parameters& p) {
  read_rank_keys(
      structure,
      "processes that compute a fem structure together, by conjugate gradients unless "
      "structure.fem.linear_solver asks for factors; from about 100000 unknowns on, for bodies that "
      "one is too slow or too small for",
      p.ranks, p.launcher);
}

void check_ranks(const CaseTable& structure, const Parameters& p) {
  check_rank_keys(structure, p.ranks, p.launcher, {only_on_one_rank(p), "ranks = 1"});
}

}  // namespace strake::structure
