#include "structure/case/rank_keys.hpp"

#include "proto/case/rank_keys.hpp"

#include <fmt/format.h>

namespace strake::structure {
namespace {

/// The first thing of a case that one rank alone computes; empty: nothing.
std::string only_on_one_rank(const Parameters& p) {
  if (p.kind != "fem") return fmt::format("a {} structure", p.kind);
  if (p.failure.criterion != FailureCriterion::none) return "failure";
  if (p.fem.strain == StrainField::solid_shell) return "a body of solid shells";
  if (p.fem.linear_solver == LinearMethod::direct) return "the direct solver of linear systems";
  return {};
}

}  // namespace

void read_ranks(CaseTable structure, Parameters& p) {
  read_rank_keys(structure,
                 "processes that compute a fem structure together, by conjugate gradients; from about 100000 "
                 "unknowns on, for bodies that one is too slow or too small for",
                 p.ranks, p.launcher);
}

void check_ranks(const CaseTable& structure, const Parameters& p) {
  check_rank_keys(structure, p.ranks, p.launcher, {only_on_one_rank(p), "ranks = 1"});
}

}  // namespace strake::structure
