#pragma once

#include "coupler/participant/serve.hpp"
#include "proto/case/size_limit.hpp"
#include "proto/participant.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace strake {

class CaseFile;

/// --export FORMAT: an input file for another finite-element program.
struct DeckRequest {
  std::string format;            // "ccx" | "ansys"
  std::filesystem::path run;     // --run: the run whose recorded loads it takes
  std::filesystem::path folder;  // --into: where the files go; of --precice its frames and history
  std::string origin;            // --origin: which run and which program, for the heading
};

/// --precice CONFIG: the solver takes part in a preCICE run.
struct PreciceRequest {
  std::string config;             // precice-config.xml
  std::string participant;        // --participant: its name there
  std::filesystem::path library;  // --precice-library; empty: libprecice.so.3 where the loader finds it
};

/// The line of --check --values before the tables with every key resolved. One start of a program answers
/// both: the loader alone needs 0.35 s for deal.II and the libraries below it.
inline constexpr const char* values_line = "every value:\n";
/// The line of --check --values --table before what --properties prints; the values come after.
inline constexpr const char* table_line = "by discretisation:\n";

/// The command line of a participant: --connect ENDPOINT --name N --case FILE [--set K=V]… [--case-hash HEX].
/// Other modes: --precice CONFIG, --interface, --check [--values [--table]], --properties, --picture, --echo,
/// --export FORMAT, --keys, --version.
struct ParticipantOptions {
  enum class Mode { serve, precice, interface, check, properties, picture, echo, export_deck, keys, version };
  Mode mode = Mode::serve;
  std::string endpoint, name, case_file;
  std::string body;  // of several in the case; empty: it has one [structure], or this is the fluid
  DeckRequest deck;
  PreciceRequest precice;
  std::vector<std::string> sets;
  std::optional<std::array<std::uint8_t, 32>>
      case_hash;        // as the coupler gave it; our programs compute their own
  bool values = false;  // --check prints what --echo prints as well
  bool table = false;   // --check --values prints what --properties prints as well
};
/// Error(command_line) for what it refuses. --help prints and exits 0.
ParticipantOptions parse_participant_options(int argc, char** argv);

/// What distinguishes one solver program from another.
struct Program {
  std::string program;  // "strake-fluid"
  std::string solver;   // "mps", "fem", …
  std::string version;
  std::string prefix;  // its part of the case file: "fluid" or "structure"
  /// Reads (so declares) all of its keys, the common ones too, and refuses what does not go together.
  std::function<void(CaseFile&)> declare;
  /// Optional, for --check: derived numbers, one line each; more refusals (a body outside the tank, …).
  std::function<std::vector<std::string>(CaseFile&)> check;
  /// Builds the participant. `declare` has run on the same file.
  std::function<std::unique_ptr<Participant>(CaseFile&, const ParticipantOptions&, const Setup&)> build;
  /// Optional, for --properties: one line of a table that compares discretisations; for --picture: an SVG.
  std::function<std::string(CaseFile&)> properties = {}, picture = {};
  /// Optional, for --export: writes the input file; returns the text for the user.
  std::function<std::string(const DeckRequest&)> export_deck = nullptr;
  /// Optional: estimates the size of the case from its keys; every mode refuses what this machine's memory
  /// cannot take. `declare` has run on the same file.
  std::function<SizeEstimates()> sizes = {};
  double properties_cost = 1;   // how many times as long as to build it the line of --properties takes
  std::string built_from = {};  // lines that --version adds: commit and libraries
};

/// The whole of a solver's main: parses, does the mode or serves, prints errors, returns the exit code.
int participant_main(int argc, char** argv, const Program&);

}  // namespace strake
