#include "fluid/program.hpp"

// strake-fluid reads its keys, builds the particle method and answers the coupler. With fluid.ranks above 1
// it becomes the launcher of that many ranks.
int main(int argc, char** argv) {
  strake::fluid::FluidProgram fluid;
  return strake::main_or_ranks(argc, argv, fluid.program());
}
