#include "coupler/participant/start_ranks.hpp"
#include "structure/program.hpp"

// strake-structure-<kind>-ranks is one rank of a structure on several. strake-structure-<kind> starts it by
// mpirun.
int main(int argc, char** argv) {
  strake::structure::StructureProgram structure(strake::structure::this_program());
  return strake::ranks_main(argc, argv, structure.program(),
                            [&](const strake::Setup& setup, strake::Communicator& ranks) {
                              strake::Setup own = setup;
                              if (ranks.rank() > 0) own.run_folder.clear();  // the first rank alone writes
                              return structure.build(own, &ranks);
                            });
}
