// strake: the commands, their options, and the one place where errors are printed.
#include "coupler/case/find_case.hpp"
#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/new_case/questions.hpp"
#include "coupler/participant/stop_request.hpp"
#include "proto/error.hpp"
#include "proto/version.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <functional>
#include <system_error>
#include <utility>

namespace {

using strake::add_picture_options;
using strake::add_run_options;
using strake::add_sets;
using strake::console_failure;
using strake::Error;
using strake::error_of;
using strake::ExitCode;
using strake::find_case;
using strake::no_number;
using strake::put;
using strake::StopRequest;
using Action = std::function<ExitCode()>;

constexpr const char* case_help = "case file, or the name of one of Strake's cases";

/// The first word that is no command (or kind of case) where one is chosen, else no option, and the one that
/// was probably meant. Both are empty where all words are known.
std::pair<std::string, std::string> mistaken_word(const CLI::App& command) {
  const auto below = command.get_subcommands([](const CLI::App*) { return true; });
  const bool chooses = !below.empty();
  std::vector<std::string> known;
  if (chooses)
    for (const CLI::App* one : below) known.push_back(one->get_name());
  else
    for (const CLI::Option* option : command.get_options())
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  for (const std::string& word : command.remaining()) {
    const bool option = word.starts_with("--");
    if (option == chooses) continue;
    return {word, strake::did_you_mean(word.substr(0, word.find('=')), known)};
  }
  return {};
}

/// CLI11's words in the form of ours.
ExitCode refuse(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  std::string name = "strake";
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    name += " " + command->get_name();
  }
  std::string problem = error.what();
  if (const auto [word, meant] = mistaken_word(*command); !word.empty()) {
    const std::string what = word.starts_with("--") ? "option" : command == &app ? "command" : "kind of case";
    std::string fix = meant.empty() ? name + " --help lists what there is"
                                    : fmt::format("did you mean {}?  ({} --help)", meant, name);
    for (const char* ending : {".stl", ".msh", ".inp"})
      if (name == "strake new" && word.ends_with(ending)) fix = "strake new mesh " + word;
    if (name == "strake" && word.ends_with(".toml")) fix = "strake run " + word;
    if (name == "strake" && word == "resume") fix = "strake run CASE --resume";
    put(stderr,
        to_text(Error(ExitCode::command_line, name, fmt::format("\"{}\" is no {}", word, what), fix)));
    return ExitCode::command_line;
  }
  if (problem.ends_with('\n')) problem.pop_back();
  const std::string twice = ": At Most 1 required but received ";  // --tag: …
  if (const std::size_t at = problem.find(twice); at != std::string::npos) {
    put(stderr, to_text(Error(ExitCode::command_line, name,
                              fmt::format("{} is given {} times", problem.substr(0, at),
                                          problem.substr(at + twice.size())),
                              "give it once")));
    return ExitCode::command_line;
  }
  const bool comma = problem.starts_with("Could not convert") && problem.find(',') != std::string::npos;
  put(stderr, to_text(Error(ExitCode::command_line, name, problem,
                            comma ? "a number has a decimal point, not a comma" : name + " --help")));
  return ExitCode::command_line;
}

int report(const Error& error) {
  std::fflush(stdout);
  put(stderr, to_text(error));
  return static_cast<int>(error.code());
}

/// What a command printed is out, or why not. failure: errno of a write that failed before; 0: none.
int end_of_output(int code, int failure) {
  const bool out = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (failure == 0) failure = console_failure() != 0 ? console_failure() : errno;
  if (out || code != 0 || failure == EPIPE) return code;  // whoever closed the pipe has what he wanted
  return report(Error(ExitCode::cannot_write, "standard output",
                      "cannot be written: " + std::generic_category().message(failure),
                      "free space there, or write to another place; files of a run are not touched by this"));
}

void add_run(CLI::App& app, strake::RunOptions& options, const StopRequest& stop, Action& action) {
  CLI::App* command =
      add_run_options(app.add_subcommand("run", "run a case into runs/<case>[-tag]"), options);
  command->add_option("CASE", options.case_file, case_help)->required();
  command->callback([&] {
    action = [&] {
      options.case_file = find_case(options.case_file);
      return strake::run(options, stop);
    };
  });
}

void add_check(CLI::App& app, strake::CheckOptions& options, const StopRequest& stop, Action& action) {
  CLI::App* command =
      app.add_subcommand("check", "all that run would refuse, plus derived numbers; starts no time step");
  command->add_option("CASE", options.case_file, case_help)->required();
  add_sets(*command, options.sets);
  command->add_option("--picture", options.picture,
                      "write shape, cells, particles, supports and wet surface of the structure as an .svg");
  command->add_flag("--all", options.all, "also print every value and where it came from");
  command->add_flag("--patient", options.patient,
                    "wait without limit for a program that lives, for debuggers");
  command->callback([&] {
    action = [&] {
      options.case_file = find_case(options.case_file);
      return strake::check(options, stop);
    };
  });
}

void add_explain(CLI::App& app, strake::ExplainOptions& options, Action& action) {
  CLI::App* command =
      app.add_subcommand("explain", "what a key means: unit, range, default; a table lists its keys");
  strake::add_explain_options(*command, options);
  command->callback([&] {
    const bool program = !options.completion.empty() || !options.man.empty();
    action = [&, program] {
      return program ? strake::explain_program(options, app) : strake::explain(options);
    };
  });
}

void add_new(CLI::App& app, strake::NewOptions& options, Action& action) {
  CLI::App* command = app.add_subcommand("new", "write a commented case file; on a terminal it asks");
  strake::add_new_options(*command, options);
  command->callback([&] { action = [&] { return strake::new_case(options); }; });
}

void add_import(CLI::App& app, strake::ImportOptions& options, Action& action) {
  CLI::App* command = app.add_subcommand("import", "write a case file from a preCICE configuration");
  command->add_option("FILE", options.configuration, "precice-config.xml of two participants")->required();
  command->add_option("-o", options.out, "the case file, default the configuration's name with .toml")
      ->type_name("FILE");
  command->callback([&] { action = [&] { return strake::import_case(options); }; });
}

void add_compare(CLI::App& app, strake::CompareOptions& options, Action& action) {
  CLI::App* command = app.add_subcommand(
      "compare", "a run against its case's references, or runs and CSV files against the first of them");
  command
      ->add_option("RUN", options.operands, "run folder; or two or more run folders, CSV files, FILE:COLUMN")
      ->required();
  auto* probes = command->add_option("--probe", options.probes,
                                     "quantity, e.g. mid.y; default the probes and forces that they share");
  probes->type_name("NAME")->take_all()->allow_extra_args(false);
  command->add_flag("--all", options.all, "every column that they share")->excludes(probes);
  command->add_option("--from", options.from, "begin of the span")->type_name("S")->check(no_number);
  command->add_option("--to", options.to, "end of the span")->type_name("S")->check(no_number);
  command->add_option("--after", options.after, "where --from and --to count from, on the clock of the first")
      ->check(CLI::IsMember({"start", "contact"}))
      ->type_name("start|contact");
  command->add_option("--shift", options.shifts, "move the others in time: seconds, contact or peak")
      ->type_name("S|contact|peak")
      ->take_all()
      ->allow_extra_args(false);
  command
      ->add_option("--within", options.within, "limit of a deviation from the first, exit 1 outside: l2=0.01")
      ->type_name("METRIC=PART")
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--csv", options.csv, "write all records at common times")->type_name("FILE");
  command->add_option("--plot", options.plot, "draw the curves over one another as a .png or .svg")
      ->type_name("FILE");
  command->callback([&] { action = [&] { return strake::compare(options); }; });
}

void add_export(CLI::App& app, strake::ExportOptions& options, const StopRequest& stop, Action& action) {
  CLI::App* command =
      app.add_subcommand("export", "mesh, supports and recorded loads of a run as another program's deck");
  command->add_option("RUN", options.recorded, "run folder")->required();
  command->add_option("--to", options.to, "CalculiX, or Ansys Mechanical (APDL)")
      ->required()
      ->check(CLI::IsMember({"ccx", "ansys"}))
      ->type_name("ccx|ansys");
  command->add_option("-o", options.folder, "folder of the deck, default RUN/export")->type_name("DIR");
  add_sets(*command, options.sets);
  command->get_option("--set")->description(
      "change one key of the case for the deck: --set structure.fem.refinement=2, --set "
      "structure.analysis=modal");
  command->callback([&] { action = [&] { return strake::export_run(options, stop); }; });
}

void add_picture(CLI::App& app, strake::PictureOptions& options, Action& action) {
  CLI::App* command =
      app.add_subcommand("picture", "one instant of a run as PNG or SVG: water and structure by a field");
  add_picture_options(command, options, "x.png or x.svg, default RUN/FIELD.png");
  command->add_option("--at", options.at, "time [s], the frame next to it; default the last")
      ->check(no_number);
  command->callback([&] { action = [&] { return strake::draw_picture(options); }; });
}

void add_film(CLI::App& app, strake::FilmOptions& options, const StopRequest& stop, Action& action) {
  CLI::App* command =
      app.add_subcommand("film", "all frames of a run as a film, with ffmpeg where that is installed");
  add_picture_options(command, options.picture, "x.mp4, x.webm or x.gif, default RUN/FIELD.mp4");
  command->add_option("--fps", options.frames_per_second, "frames in a second")->capture_default_str();
  command->add_option("--from", options.from, "first time [s]")->check(no_number);
  command->add_option("--to", options.to, "last time [s]")->check(no_number);
  command->callback([&] { action = [&] { return strake::make_film(options, stop); }; });
}

void add_report(CLI::App& app, strake::ReportOptions& options, Action& action) {
  CLI::App* command =
      app.add_subcommand("report", "one self-contained HTML page about runs, or about a study");
  command->add_option("RUN", options.what, "run folders, or the folder of a study")->required();
  command->add_option("-o", options.out, "default report.html in the first folder")->type_name("FILE");
  command
      ->add_option("--at", options.at,
                   "times of the pictures [s]: the frames next to them; default contact, first peak (without "
                   "both: half the run), end")
      ->delimiter(',')
      ->type_name("T1,T2,...")
      ->check(no_number);
  command->callback([&] { action = [&] { return strake::write_report(options); }; });
}

void add_watch(CLI::App& app, strake::WatchOptions& options, const StopRequest& stop, Action& action) {
  CLI::App* command = app.add_subcommand(
      "watch", "state, curves and fields of a run, live or afterwards, on the terminal or as a page");
  command->add_option("RUN", options.run, "run folder, default the newest under runs");
  command->add_option("--runs", options.runs, "where the newest is looked for, default runs")
      ->type_name("DIR");
  auto* web = command->add_flag("--web", options.web, "as a page for a browser on this machine");
  command->add_option("--port", options.port, "of the page, default a free one")
      ->check(CLI::Range(1, 65535))
      ->needs(web)
      ->type_name("N");
  command
      ->add_option("--bind", options.bind,
                   "address that the page is served on, default 127.0.0.1: this machine alone")
      ->needs(web)
      ->type_name("ADDR");
  command->callback([&] { action = [&] { return strake::watch_run(options, stop); }; });
}

void add_study(CLI::App& app, strake::StudyOptions& options, const StopRequest& stop, Action& action) {
  CLI::App* command =
      app.add_subcommand("study", "a case at many settings: runs what is not done, one table at the end");
  command->add_option("STUDY", options.file, "study file, or the name of a study of Strake's")->required();
  command->add_option("--runs", options.runs, "the study is DIR/<study>, default runs")->type_name("DIR");
  command->add_option("--jobs", options.jobs, "runs at once, default one for each core")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command->add_flag("--again", options.again, "run again what is done");
  command->add_flag("--list", options.list, "print the command of each run, start none");
  command->add_flag("--strict", options.strict, "exit 1 when a check fails");
  command->add_flag("--quiet", options.quiet, "print only the checks");
  command->callback([&] {
    action = [&] {
      options.file = find_case(options.file);
      return strake::study_command(options, stop);
    };
  });
}

void add_keys(CLI::App& app, strake::KeysOptions& options, Action& action) {
  CLI::App* command = app.add_subcommand("keys", "make the keys of a run between machines");
  command->add_option("DIR", options.folder, "folder of the keys, default keys");
  command->add_option("--for", options.participants, "participants, default fluid structure")
      ->type_name("NAME");
  command->callback([&] { action = [&] { return strake::keys(options); }; });
}

void add_manual(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("manual", "where the manual is");
  command->callback([&] { action = [] { return strake::manual(); }; });
}

void add_replay(CLI::App& app, strake::ReplayOptions& options, const StopRequest& stop, Action& action) {
  CLI::App* command = add_run_options(
      app.add_subcommand("replay", "recorded loads onto another structure, or the reverse"), options.run);
  command->add_option("RUN", options.recorded, "run folder with the record")->required();
  command->add_option("--onto", options.run.case_file, case_help)->required()->type_name("CASE");
  command->add_option("--side", options.side, "the side that plays the record")
      ->check(CLI::IsMember({"fluid", "structure"}))
      ->type_name("fluid|structure");
  command->callback([&] {
    action = [&] {
      options.run.case_file = find_case(options.run.case_file);
      return strake::replay(options, stop);
    };
  });
}

/// What the user gave each command.
struct Options {
  strake::RunOptions run;
  strake::CheckOptions check;
  strake::NewOptions fresh;
  strake::ImportOptions import;
  strake::ExplainOptions explain;
  strake::CompareOptions compare;
  strake::ExportOptions deck;
  strake::PictureOptions picture;
  strake::FilmOptions film;
  strake::ReportOptions report;
  strake::WatchOptions watch;
  strake::StudyOptions study;
  strake::KeysOptions keys;
  strake::ReplayOptions replay;
};

/// Declares every command; the one that the user names becomes `action`.
void add_commands(CLI::App& app, Options& options, const StopRequest& stop, Action& action) {
  add_run(app, options.run, stop, action);
  add_check(app, options.check, stop, action);
  add_new(app, options.fresh, action);
  add_import(app, options.import, action);
  add_explain(app, options.explain, action);
  add_compare(app, options.compare, action);
  add_export(app, options.deck, stop, action);
  add_picture(app, options.picture, action);
  add_film(app, options.film, stop, action);
  add_report(app, options.report, action);
  add_watch(app, options.watch, stop, action);
  add_study(app, options.study, stop, action);
  add_keys(app, options.keys, action);
  add_manual(app, action);
  add_replay(app, options.replay, stop, action);
}

/// Ends the program as the action did.
int end_of(const Action& action) {
  try {
    return end_of_output(static_cast<int>(action()), 0);
  } catch (const Error& error) {
    return report(error);
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) == 0) return report(error_of(error, "strake"));
    const bool pipe = error.code().value() == EPIPE;
    return pipe ? 128 + SIGPIPE : end_of_output(0, error.code().value());
  } catch (const std::exception& error) {
    return report(error_of(error, "strake"));
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::setlocale(LC_ALL, "C");  // numbers are read and written with a point
  strake::hold_streams();
  const strake::StopRequest stop;
  // A limit on the size of files, and a pipe that was closed, are errors of the write, told like a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);

  CLI::App app{"Strake: fluid and structure solvers for slamming and water entry, coupled."};
  app.name("strake");
  app.set_version_flag("--version", [] {
    return fmt::format("strake {}\n{}", strake::strake_version(), strake::build_text());
  });
  app.require_subcommand(1);

  Options options;
  options.run.command_line.assign(argv, argv + argc);
  options.replay.run.command_line = options.run.command_line;
  Action action;
  add_commands(app, options, stop, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wanted) {  // --help, --version
    return app.exit(wanted);
  } catch (const CLI::ParseError& error) {
    return static_cast<int>(refuse(app, error));
  }
  return end_of(action);
}
