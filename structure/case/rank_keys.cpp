#include "structure/case/rank_keys.hpp"

#include <fmt/format.h>

namespace strake::structure {
namespace {

/// The first thing of a case that one rank alone computes; empty: nothing.
std::string only_on_one_rank(const Parameters& p) {
  return p.kind == "fem" ? "" : fmt::format("a {} structure", p.kind);
}

}  // namespace

void read_ranks(CaseTable structure, Parameters& p) {
  structure.integer("ranks", p.ranks,
                    {.min = 1,
                     .max = 4096,
                     .help = "processes that compute a fem structure together, by conjugate gradients unless "
                             "structure.fem.linear_solver asks for factors; from about 100000 unknowns on, "
                             "for bodies that one is too slow or too small for"});
  structure.text("launcher", p.launcher,
                 {.help = "line that starts the ranks; {ranks} is their number, as in srun -n {ranks}"});
}

void check_ranks(const CaseTable& structure, const Parameters& p) {
  if (p.ranks == 1) return;
  if (const std::string what = only_on_one_rank(p); !what.empty())
    throw structure.error("ranks", "1: " + what + " is computed on one rank alone", "ranks = 1");
  if (p.launcher.find_first_not_of(' ') == std::string::npos)
    throw structure.error("launcher", "the line that starts the ranks", "mpirun -n {ranks}");
}

}  // namespace strake::structure
