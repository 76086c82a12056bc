#include "coupler/participant/start_ranks.hpp"
#include "fluid/program.hpp"
#include "fluid/ranks/boomer_amg.hpp"
#include "fluid/ranks/zoltan_partition.hpp"

// strake-fluid-ranks is one rank of a fluid on several. strake-fluid starts it by mpirun.
int main(int argc, char** argv) {
  strake::fluid::FluidProgram fluid;
  return strake::ranks_main(argc, argv, fluid.program(),
                            [&](const strake::Setup& setup, strake::Communicator& ranks) {
                              return fluid.build(setup, {&ranks, strake::fluid::zoltan_partition,
                                                         [&] { return strake::fluid::boomer_amg(ranks); }});
                            });
}
