#include "structure/program.hpp"

// strake-structure-<kind>: reads its keys, builds its solver, serves the coupler. With structure.ranks above
// 1 it becomes the launcher of that many ranks.
int main(int argc, char** argv) {
  strake::structure::StructureProgram structure(strake::structure::this_program());
  return strake::main_or_ranks(argc, argv, structure.program());
}
