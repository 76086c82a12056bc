#pragma once

#include "coupler/participant/participant_main.hpp"
#include "structure/deck/model.hpp"

#include <string>

namespace strake::structure {

/// Writes a body, its supports and the recorded loads of a run as ccx.inp or ansys.inp, with probes.csv.
/// Makes the wanted folder. Returns the text for the user. title: of the case; empty: the run's name. Throws
/// Error(case_file) for a run without recorded loads, or with those of another body.
std::string export_deck(const deck::Model&, const std::string& title, const DeckRequest&);

}  // namespace strake::structure
