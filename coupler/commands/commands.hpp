#pragma once

#include "coupler/run/run_folder.hpp"
#include "proto/error.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace strake {

class StopRequest;

/// The commands of `strake`, one per file. Each returns its exit code or throws an Error that main prints.

struct RunOptions {
  std::filesystem::path case_file;
  std::vector<std::string> sets;
  RunFolderOptions folder;
  std::vector<std::string> by_hand;  // sides that the user starts: "fluid", "structure"
  bool patient = false;              // no deadline but death
  bool strict = false;               // exit 1 when a compare block fails or an alarm was raised
  bool quiet = false, json = false;
  bool trace = true;     // write trace.json
  bool profile = false;  // say where the time went
  std::vector<std::string> command_line;
};
ExitCode run(const RunOptions&, const StopRequest&);

struct CheckOptions {
  std::filesystem::path case_file;
  std::vector<std::string> sets;
  std::filesystem::path picture;  // SVG to write; empty: none
  bool all = false;               // also every value and its origin
  bool patient = false;
};
ExitCode check(const CheckOptions&, const StopRequest&);

/// key: empty for all; a table ("fluid.scheme") lists its keys. markdown: the reference of
/// proto/CASE_FILE.md.
ExitCode explain(const std::string& key, bool markdown);

struct CompareOptions {
  std::vector<std::string> operands;  // run folders, CSV files, FILE:COLUMN; the first is the reference
  std::vector<std::string> probes;    // empty: the probes and forces that they share
  bool all = false;                   // empty probes mean every column that they share
  std::optional<double> from, to;     // [s] after `after`
  std::string after = "start";        // "start" | "contact"
  std::vector<std::string> shifts;    // of those after the first: a time in s, "contact", "peak"
  std::vector<std::string> within;    // "METRIC=PART": the verdict
  std::filesystem::path csv;          // overlay to write; empty: none
  std::filesystem::path plot;         // .png or .svg to draw; empty: none
  bool of_one_run() const;            // one run, at most with probes and a plot: its case's references
};
/// The compare blocks of a run's own case.toml against its summary and history.
ExitCode compare_run(const CompareOptions&);
/// Two records or more against the first, metric by metric.
ExitCode compare_several(const CompareOptions&);

struct KeysOptions {
  std::filesystem::path folder = "keys";
  std::vector<std::string> participants = {"fluid", "structure"};
};
ExitCode keys(const KeysOptions&);

/// Prints where the manual is: the HTML one, else the pages of the source tree and how to build it. Opens
/// nothing.
ExitCode manual();

struct ExportOptions {
  std::filesystem::path recorded;  // a run folder
  std::string to;                  // "ccx" | "ansys"
  std::filesystem::path folder;    // empty: RUN/export
  std::vector<std::string> sets;
};
ExitCode export_run(const ExportOptions&, const StopRequest&);

struct ReplayOptions {
  std::filesystem::path recorded;  // a run folder
  std::string
      side;  // which side plays the record: "fluid" | "structure"; empty: the one that the case leaves open
  RunOptions run;
};
ExitCode replay(const ReplayOptions&, const StopRequest&);

}  // namespace strake
