#pragma once

#include "coupler/participant/participant_main.hpp"

#include <string>

namespace CLI {
class App;
}

namespace strake {

/// What a participant's command line has beside ParticipantOptions while it is parsed.
struct ParticipantFlags {
  bool check = false, properties = false, picture = false, echo = false, keys = false, version = false,
       interface = false, values = false, table = false;
  std::string hash;  // hexadecimal
};

/// Declares the options of every solver program.
void add_participant_options(CLI::App& app, ParticipantOptions&, ParticipantFlags&);

}  // namespace strake
