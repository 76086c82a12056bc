#include "coupler/participant/participant_main.hpp"

#include "coupler/participant/case/participant_options.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/participant/liveness_thread.hpp"
#include "proto/case/case_file.hpp"
#include "proto/error.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <utility>

namespace strake {
namespace {

std::array<std::uint8_t, 32> parse_hash(const std::string& text) {
  std::array<std::uint8_t, 32> hash{};
  const std::string bytes = bytes_of(text);
  if (bytes.size() != hash.size())
    throw Error(ExitCode::command_line, "--case-hash " + text,
                "is no SHA-256: expected 64 hexadecimal digits");
  std::copy(bytes.begin(), bytes.end(), hash.begin());
  return hash;
}

void require(bool condition, const std::string& option) {
  if (!condition)
    throw Error(ExitCode::command_line, option, "is missing",
                "strake starts this program itself: strake run CASE; --help lists the modes");
}

/// Declares all keys of this program, and checks that the machine's memory suffices.
void declare(CaseFile& file, const Program& program) {
  file.read_all([&] {
    program.declare(file);
    file.refuse_unknown(program.prefix);
  });
  if (program.sizes) refuse_oversized(file, program.sizes());
}

/// The case as this program sees it: of several bodies, its own.
CaseFile load(const ParticipantOptions& options, const Program& program) {
  const CaseFile file = CaseFile::load(options.case_file, options.sets);
  if (!options.body.empty()) return file.of_body(options.body);
  if (program.prefix == "structure" && !file.bodies().empty())
    throw Error(ExitCode::command_line, "--body",
                fmt::format("is missing: the case has the bodies {}", fmt::join(file.bodies(), ", ")),
                "--body " + file.bodies().front());
  return file;
}

/// The case, read by everything that this program declares.
CaseFile load_declared(const ParticipantOptions& options, const Program& program) {
  require(!options.case_file.empty(), "--case");
  CaseFile file = load(options, program);
  declare(file, program);
  return file;
}

/// Size and derived numbers of a case. One that takes long to build is not built: a check answers soon.
void print_check(CaseFile& file, const Program& program) {
  const SizeEstimates sizes = program.sizes ? program.sizes() : SizeEstimates{};
  if (const std::string text = size_text(sizes); !text.empty()) fmt::print("{}{}\n", size_words, text);
  if (is_large(sizes))
    fmt::print("{}a case of this size takes long to build; run it to see more\n", not_built_words);
  else if (program.check)
    for (const std::string& line : program.check(file)) fmt::print("{}\n", line);
}

/// A line of the table of discretisations, or a drawing, of what is small enough to be built for it.
std::string properties(CaseFile& file, const ParticipantOptions& options, const Program& program) {
  const bool picture = options.mode == ParticipantOptions::Mode::picture;
  const auto& make = picture ? program.picture : program.properties;
  if (!make) return {};
  const SizeEstimates sizes = program.sizes ? program.sizes() : SizeEstimates{};
  if (!is_large(sizes, picture ? 1 : program.properties_cost)) return make(file);
  if (picture)
    throw Error(ExitCode::case_file, file.path().string(), "is too large to draw: " + size_text(sizes),
                "draw it with coarser spacings");
  return fmt::format("{:<10} not built: {}\n", program.solver, size_text(sizes));
}

int serve_case(const ParticipantOptions& options, const Program& program) {
  for (const auto& [value, name] :
       {std::pair{options.endpoint, "--connect"}, {options.name, "--name"}, {options.case_file, "--case"}})
    require(!value.empty(), name);
  CaseFile file = load(options, program);
  const char* token = std::getenv("STRAKE_TOKEN");
  const ServeOptions serving{options.endpoint, options.name,    token ? token : "",
                             program.solver,   program.version, file.hash()};
  return serve(serving, [&](const Setup& setup) {
    declare(file, program);  // late, so that the coupler receives an error
    return program.build(file, options, setup);
  });
}

int run_mode(const ParticipantOptions& options, const Program& program) {
  using Mode = ParticipantOptions::Mode;
  switch (options.mode) {
    case Mode::serve:
      return serve_case(options, program);
    case Mode::version:
      fmt::print("{} {} ({})\n{}{}", program.program, program.version, program.solver, program.built_from,
                 program.built_from.empty() ? "" : "\n");
      break;
    case Mode::keys: {
      CaseFile nothing = CaseFile::declarations_only();
      program.declare(nothing);
      fmt::print("{}\n", to_json(nothing.declared()));
      break;
    }
    case Mode::echo:
      fmt::print("{}", load_declared(options, program).echo(program.prefix));
      break;
    case Mode::export_deck:
      if (!program.export_deck)
        throw Error(ExitCode::command_line, program.program + " --export", "this solver has no mesh to write",
                    "strake-structure-fem has one");
      for (const auto& [value, name] :
           {std::pair{options.deck.run, "--run"}, {options.deck.folder, "--into"}})
        require(!value.empty(), name);
      load_declared(options, program);
      fmt::print("{}", program.export_deck(options.deck));
      break;
    case Mode::properties:
    case Mode::picture: {
      CaseFile file = load_declared(options, program);
      fmt::print("{}", properties(file, options, program));
      break;
    }
    case Mode::check: {
      CaseFile file = load_declared(options, program);
      print_check(file, program);
      break;
    }
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace

void add_participant_options(CLI::App& app, ParticipantOptions& options, ParticipantFlags& flags) {
  app.description("A participant of a Strake run. `strake run CASE` starts it; its modes stand alone.");
  app.add_option("--connect", options.endpoint, "endpoint of the coupler; the token is in STRAKE_TOKEN")
      ->type_name("ENDPOINT");
  app.add_option("--name", options.name, "part in the run: fluid, structure, or the name of a body")
      ->type_name("NAME");
  app.add_option("--case,CASE", options.case_file, "case file")->type_name("CASE");
  app.add_option("--set", options.sets, "KEY=VALUE, replaces a key of the case file")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  app.add_option("--body", options.body, "which body of [[structures]] this is")->type_name("NAME");
  app.add_option("--case-hash", flags.hash, "hash of the case as the coupler read it")->type_name("HEX");
  auto* modes = app.add_option_group("modes", "instead of taking part in a run");
  modes->add_flag("--check", flags.check,
                  "read the case, refuse what a run would refuse, print derived numbers");
  modes->add_flag("--properties", flags.properties,
                  "print mass, centre, inertia, frequencies and stable step");
  modes->add_flag("--picture", flags.picture,
                  "print a drawing of shape, cells or particles, supports and wet surface (SVG)");
  modes->add_flag("--echo", flags.echo, "print this program's tables with every key resolved");
  modes
      ->add_option("--export", options.deck.format,
                   "write mesh, supports and recorded loads for ccx or ansys")
      ->check(CLI::IsMember({"ccx", "ansys"}))
      ->type_name("ccx|ansys");
  app.add_option("--run", options.deck.run, "with --export: folder of the run whose loads are taken")
      ->type_name("RUN");
  app.add_option("--into", options.deck.folder, "with --export: folder of the input file")->type_name("DIR");
  app.add_option("--origin", options.deck.origin, "with --export: what its heading says of its origin");
  modes->add_flag("--keys,--declarations", flags.keys, "print this program's keys as JSON");
  modes->add_flag("--version", flags.version, "print name, version and libraries");
  modes->require_option(0, 1);
}

ParticipantOptions parse_participant_options(int argc, char** argv) {
  ParticipantOptions options;
  ParticipantFlags flags;
  CLI::App app;
  add_participant_options(app, options, flags);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    std::exit(app.exit(help));
  } catch (const CLI::ParseError& e) {
    throw Error(ExitCode::command_line, argv[0], e.what(), "--help lists the options");
  }
  if (!flags.hash.empty()) options.case_hash = parse_hash(flags.hash);
  using Mode = ParticipantOptions::Mode;
  options.mode = flags.check                    ? Mode::check
                 : flags.properties             ? Mode::properties
                 : flags.picture                ? Mode::picture
                 : flags.echo                   ? Mode::echo
                 : !options.deck.format.empty() ? Mode::export_deck
                 : flags.keys                   ? Mode::keys
                 : flags.version                ? Mode::version
                                                : Mode::serve;
  return options;
}

int participant_main(int argc, char** argv, const Program& program) {
  end_with_starter();
  try {
    return run_mode(parse_participant_options(argc, argv), program);
  } catch (const Error& e) {
    std::fputs(to_text(e).c_str(), stderr);
    return static_cast<int>(e.code());
  } catch (const std::exception& e) {
    std::fputs(
        fmt::format("{}: unexpected: {}\n  fix: please report it\n", program.program, e.what()).c_str(),
        stderr);
    return static_cast<int>(ExitCode::our_bug);
  }
}

}  // namespace strake
