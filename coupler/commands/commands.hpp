#pragma once

#include "coupler/new_case/questions.hpp"
#include "coupler/run/run_folder.hpp"
#include "proto/error.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace strake {

class StopRequest;

/// The commands of `strake`, one per file. Each returns its exit code or throws an Error that main prints.

struct RunOptions {
  std::filesystem::path case_file;
  std::vector<std::string> sets;
  RunFolderOptions folder;
  std::vector<std::string> by_hand;  // sides that the user starts: "fluid", "structure"
  bool patient = false;              // waits without limit for a program that lives
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

struct ExplainOptions {
  std::string key;            // empty: all; a table ("fluid.scheme") lists its keys
  bool markdown = false;      // the reference of proto/CASE_FILE.md instead
  bool schema = false;        // a JSON Schema of the case file instead
  std::string completion;     // "bash": the completion of that shell instead
  std::filesystem::path man;  // folder that the man pages are written into instead
};
ExitCode explain(const ExplainOptions&);
/// Declares the options of `explain`.
void add_explain_options(CLI::App& command, ExplainOptions&);
/// Writes completion or man pages from the command line of `strake` and of the solver programs.
ExitCode explain_program(const ExplainOptions&, const CLI::App& strake);

/// Writes a commented case file, which `check` accepts. Replaces no file.
ExitCode new_case(NewOptions);
/// Error(command_line) if a file of that name exists: no case file is replaced.
void refuse_existing(const std::filesystem::path& file);

struct ImportOptions {
  std::filesystem::path configuration;  // precice-config.xml
  std::filesystem::path out;            // the case file; empty: <stem of the configuration>.toml
};
/// Writes a case file from a preCICE configuration, with what is left out and what is left to do. Replaces no
/// file.
ExitCode import_case(const ImportOptions&);

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
};
/// The compare blocks of a run's own case.toml against its summary and history, where one run is named, at
/// most with probes and a plot. Else the records against the first of them, metric by metric.
ExitCode compare(const CompareOptions&);
/// The first of these two.
ExitCode compare_run(const CompareOptions&);

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

struct ReportOptions {
  std::vector<std::filesystem::path> what;  // run folders, or one folder of a study
  std::filesystem::path out;                // empty: report.html in the first folder
  std::vector<double> at;                   // [s] of the pictures
};
/// Writes one page about runs, or about a study.
ExitCode write_report(const ReportOptions&);

struct WatchOptions {
  std::filesystem::path run;  // empty: the newest under `runs`
  std::filesystem::path runs = "runs";
  bool web = false;  // a page instead of the terminal's view
  int port = 0;      // of the page; 0: a free one
  std::string bind = "127.0.0.1";
};
/// Shows a running or finished run until it ends, or the reader leaves. Returns the run's own exit code
/// once it has ended; participant_lost for a run that was killed; done where the reader left before.
ExitCode watch_run(const WatchOptions&, const StopRequest&);

/// What `picture` and `film` have in common.
struct PictureOptions {
  std::filesystem::path run, out;  // out: .png or .svg; empty: RUN/<field>.png, of a film RUN/<field>.mp4
  std::optional<double> at;        // [s]; none: the last frame
  std::string field = "pressure";
  std::string size, view, range;  // "1280x720", "x0,y0,x1,y1" [m], "lo,hi"; empty: the run's own
  double scale = 1;
};
/// Draws one frame of a run.
ExitCode draw_picture(const PictureOptions&);

struct FilmOptions {
  PictureOptions picture;
  int frames_per_second = 25;
  std::optional<double> from, to;  // [s]
};
/// Draws all frames between two times in the same colours and view, and has ffmpeg make a film of them.
ExitCode make_film(const FilmOptions&, const StopRequest&);

struct StudyOptions {
  std::filesystem::path file;           // study.toml
  std::filesystem::path runs = "runs";  // the study is runs/<study>
  int jobs = 0;                         // runs at once; 0: as the file says, else one for each core
  bool again = false;                   // also what is done
  bool list = false;                    // say what would be run
  bool strict = false;                  // exit 1 when a check fails
  bool quiet = false;
};

/// Runs a study and writes runs/<study>/study.csv (a line for each run) and study.json (that, checks, orders
/// of convergence, claims). Exit code of the first run that failed, else done (or 1 under `strict`).
ExitCode study_command(const StudyOptions&, const StopRequest&);

/// Converts an exception that our code did not throw. If the system refused an operation on a file it is exit
/// 6, else a bug of ours at that place (exit 70).
Error error_of(const std::exception&, const std::string& where);

}  // namespace strake

namespace strake {

struct RunOptions;
struct PictureOptions;

/// Declares options that several commands have: --set, those of a run, those of a picture. out: help of its
/// -o.
void add_sets(CLI::App& command, std::vector<std::string>& sets);
CLI::App* add_run_options(CLI::App* command, RunOptions&);
void add_picture_options(CLI::App* command, PictureOptions&, const std::string& out);

/// What is wrong with the number of an option, for CLI11: nan and inf are none. Empty: nothing.
std::string no_number(const std::string& text);

}  // namespace strake
