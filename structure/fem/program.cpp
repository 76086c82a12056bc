#include "structure/solver/program.hpp"

#include "structure/deck_export/deck_export.hpp"
#include "structure/fem/fem.hpp"

namespace strake::structure {

SolverProgram this_program() {
  return {
      .kind = "fem",
      .build = [](const Parameters& p) { return fem::make_solver(p); },
      .sizes = &fem::sizes,
      .properties_cost = 1,
      .export_deck =
          [](const Parameters& p, const CommonKeys& common, const DeckRequest& wanted) {
            return export_deck(fem::model(p, common.probes), common.title, wanted);
          },
      .build_on_ranks = [](const Parameters& p, Communicator& ranks) { return fem::make_solver(p, &ranks); }};
}

}  // namespace strake::structure
