#pragma once

#include "coupler/compare/compare.hpp"
#include "coupler/coupling/window_loop.hpp"
#include "coupler/processes/remote.hpp"
#include "coupler/summary/summary.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/error.hpp"
#include "proto/files/history.hpp"

#include <Eigen/Core>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

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
  bool mechanical = true;  // displacement and force cross the interface
  int dimension = 2;
  std::vector<Column> columns;           // of the participants
  std::vector<ProbeKeys> probes;         // their columns come first
  std::vector<std::string> judged = {};  // what [[compare]] blocks look at: "tip.x"
  char thin_axis = 'y';                  // along which the body is thinnest: a wall bends along x
  std::vector<Column> history;           // of history.csv
  double end_time = 0;                   // [s] simulated
  long windows = 0;                      // of the whole run, if no solver requests shorter ones
  LoopState from = {};                   // of a resumed run
};

/// One committed window as the console sees it.
struct RunRow {
  const CommittedWindow* window = nullptr;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // [N] on the structure
  double elapsed = 0;                               // [s] since the run began
  const Table* history = nullptr;                   // its last line is this window; may be null
};

/// How a run ended.
struct RunEnd {
  const Summary* summary = nullptr;
  std::filesystem::path folder;
  std::vector<std::string> fields = {};  // "fluid.xdmf", "structure.xdmf"
  std::string stopped = {};              // empty: ran to its end; else "interrupted", "failed"
  const Profile* profile = nullptr;      // with --profile
};

/// Where the news of a run goes. Results and their printing are apart: this sees only what is recorded as
/// well.
class Reporter {
 public:
  virtual ~Reporter() = default;
  virtual void start(const RunHeader&) = 0;
  virtual void window(const RunRow&) = 0;
  /// An answer is awaited, several times a second; elapsed: [s] since the run began.
  virtual void wait(const Awaited&, double /*elapsed*/) {}
  virtual void verdict(const Verdict&) = 0;
  virtual void note(const std::string& line) = 0;     // what has happened
  virtual void alarm(const std::string& line) = 0;    // a value that the case cannot have (summary/notes.hpp)
  virtual void warning(const std::string& line) = 0;  // notes for the user: facts to know, or steps to take
  virtual void error(const Error&) {}                 // that ends the run; main prints it
  virtual void end(const RunEnd&) = 0;
};

/// How to write to a stream: in place and in colour on a terminal, plain lines elsewhere.
struct Style {
  bool terminal = false, colour = false;
  int width = 0;         // [characters] of the terminal; 0: unknown
  bool unicode = false;  // the terminal's characters are UTF-8
};
/// Of a stream, as NO_COLOR and the terminal have it.
Style style_of(std::FILE*);

/// Writes a text to a console, at once. A failed write is ignored: the run matters more than its messages.
void put(std::FILE*, const std::string&);
/// errno of the first text that `put` could not write to the standard output; 0: all were.
int console_failure();
/// Opens the three standard streams if they are closed. Else a file of the run would get the number of a
/// closed one. Writes to a closed standard output still fail, as they should.
void hold_streams();

/// Characters in a line of the stream's terminal at this moment. If it cannot be found out, the style's
/// width, else 80.
int width_of(std::FILE*, const Style&);

/// The table: header, one line per output frame, results of comparisons, the end. On a terminal a progress
/// bar stands below the lines, drawn again at most five times a second; in a pipe there is a line at least
/// every 10 s.
std::unique_ptr<Reporter> table_reporter(std::FILE*, const Style&);
/// One JSON object per line, with its "kind" (proto/RESULTS.md).
std::unique_ptr<Reporter> json_reporter(std::FILE*);
/// Warnings and verdicts alone; with --profile its lines.
std::unique_ptr<Reporter> quiet_reporter(std::FILE*, const Style&);

/// Chooses the columns of a run to show: of each probe the scalar, or the components that a [[compare]] block
/// looks at, or the one along the body's thin axis; then the others.
std::vector<Column> telling_columns(const RunHeader&, std::size_t most);
/// Lines on how a run ended: windows, time, probes, checks, files, the next commands. No newline at their
/// ends.
std::vector<std::string> closing_lines(const RunEnd&, const RunHeader&, const Style&);
/// In that colour (SGR code) where the style has colours.
std::string painted(const Style&, const char* code, const std::string&);

/// The lines of one header block, the name in front of the first: "  fluid      headline". Lines come from
/// participants: they are made visible.
std::string block_text(const std::string& name, const std::vector<std::string>& lines);
std::string verdict_text(const Verdict&, const Style&);
/// 760 → "12 min 40 s".
std::string duration_text(double seconds);

}  // namespace strake
