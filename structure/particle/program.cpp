#include "structure/solver/program.hpp"

#include "structure/body/size.hpp"
#include "structure/particle/solver.hpp"

#include <omp.h>

namespace strake::structure {

SolverProgram this_program() {
  return {"particle",
          [](const Parameters& p) {
            omp_set_num_threads(p.threads);
            return make_particle_solver(p);
          },
          &particle_sizes, 4};
}

}  // namespace strake::structure
