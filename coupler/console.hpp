#pragma once

#include <Eigen/Core>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coupler/compare.hpp"
#include "coupler/run_loop.hpp"
#include "coupler/summary.hpp"
#include "proto/case_keys.hpp"

namespace strake {

class Profile;

/// What a run understood, before its first window.
struct RunHeader {
  std::string title;
  std::filesystem::path folder;
  std::vector<std::pair<std::string, std::vector<std::string>>>
      blocks;  // "fluid" → lines, the first is the headline
  std::vector<std::string> warnings;
  bool coupled = true;
  int dimension = 2;
  std::vector<Column> columns;    // of the participants
  std::vector<ProbeKeys> probes;  // their columns come first
};

/// One committed window as the console sees it.
struct RunRow {
  const CommittedWindow* window = nullptr;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // [N] on the structure
  double elapsed = 0;                               // [s] since the run began
};

/// How a run ended.
struct RunEnd {
  const Summary* summary = nullptr;
  std::filesystem::path folder;
  std::vector<std::string> fields;   // "fluid.xdmf", "structure.xdmf"
  std::string stopped;               // empty: ran to its end; else "interrupted", "failed"
  const Profile* profile = nullptr;  // with --profile
};

/// Where the news of a run goes. Results and their printing are apart: this sees only what is recorded as
/// well.
class Reporter {
 public:
  virtual ~Reporter() = default;
  virtual void start(const RunHeader&) = 0;
  virtual void window(const RunRow&) = 0;
  virtual void verdict(const Verdict&) = 0;
  virtual void note(const std::string& line) = 0;  // waiting, warnings
  virtual void end(const RunEnd&) = 0;
};

/// How to write to a stream: in place and in colour on a terminal, plain lines elsewhere.
struct Style {
  bool terminal = false, colour = false;
  int width = 0;  // [characters] of the terminal; 0: unknown
};
/// Of a stream, as NO_COLOR and the terminal have it.
Style style_of(std::FILE*);

/// The table: header, one line per window (on a terminal the last one is renewed in place between field
/// frames; in a pipe one line per field frame and at least every 10 s), verdicts, paths.
std::unique_ptr<Reporter> table_reporter(std::FILE*, const Style&);
/// One JSON object per line: start, window, verdict, note, end.
std::unique_ptr<Reporter> json_reporter(std::FILE*);
/// Nothing but verdicts that fail.
std::unique_ptr<Reporter> quiet_reporter(std::FILE*, const Style&);

/// The lines of one header block, the name in front of the first: "  fluid      headline".
std::string block_text(const std::string& name, const std::vector<std::string>& lines);
std::string verdict_text(const Verdict&, const Style&);
/// 3000 → "3 000".
std::string grouped(long long number);
/// 760 → "12 min 40 s".
std::string duration_text(double seconds);

}  // namespace strake
