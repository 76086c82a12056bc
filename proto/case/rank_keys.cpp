#include "proto/case/rank_keys.hpp"

namespace strake {

void read_rank_keys(CaseTable& part, const std::string& help, int& ranks, std::string& launcher) {
  part.integer("ranks", ranks, {.min = 1, .max = 4096, .help = help});
  part.text("launcher", launcher,
            {.help = "line that starts the ranks; {ranks} is their number, as in srun -n {ranks}"});
}

void check_rank_keys(const CaseTable& part, int ranks, const std::string& launcher,
                     const RankRefusal& refusal) {
  if (ranks == 1) return;
  if (!refusal.alone.empty())
    throw part.error("ranks", "1: " + refusal.alone + " is computed on one rank alone", refusal.fix);
  if (launcher.find_first_not_of(' ') == std::string::npos)
    throw part.error("launcher", "the line that starts the ranks", "mpirun -n {ranks}");
}

}  // namespace strake
