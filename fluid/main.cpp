#include "fluid/program.hpp"
#include "fluid/start_ranks.hpp"

// strake-fluid reads its keys, builds the particle method and answers the coupler. With fluid.ranks above 1
// it becomes the launcher of that many ranks.
int main(int argc, char** argv) {
  strake::fluid::FluidProgram fluid;
  if (const int code = strake::fluid::start_ranks(argc, argv, fluid); code != 0) return code;
  return strake::participant_main(argc, argv, fluid.program());
}
