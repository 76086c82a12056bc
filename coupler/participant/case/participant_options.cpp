#include "coupler/participant/case/participant_options.hpp"

#include "coupler/participant/launch.hpp"
#include "proto/error.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdlib>
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

/// Refuses options of --precice without it, and those of a run of Strake beside it.
void check_precice(const ParticipantOptions& options) {
  const PreciceRequest& precice = options.precice;
  for (const auto& [value, name] : {std::pair{precice.participant, std::string("--participant")},
                                    {precice.library.string(), "--precice-library"}})
    if (precice.config.empty() && !value.empty())
      throw Error(ExitCode::command_line, name + " " + value, "stands without --precice",
                  "--precice CONFIG --participant NAME");
  if (!precice.config.empty() && !options.endpoint.empty())
    throw Error(ExitCode::command_line, "--connect", "and --precice are two ways into a run",
                "--connect for a run of Strake, --precice for one of preCICE");
}

}  // namespace

void add_participant_options(CLI::App& app, ParticipantOptions& options, ParticipantFlags& flags) {
  app.description("A participant of a Strake run. `strake run CASE` starts it; its modes stand alone.");
  app.add_option("--connect", options.endpoint, "endpoint of the coupler; the token is in STRAKE_TOKEN")
      ->type_name("ENDPOINT");
  app.add_option("--name", options.name, "part in the run: fluid, structure, or the name of a body")
      ->type_name("NAME");
  app.add_option("--body", options.body, "which body of [[structures]] this is")->type_name("NAME");
  app.add_option("--case,CASE", options.case_file, "case file")->type_name("CASE");
  app.add_option("--set", options.sets, "KEY=VALUE, replaces a key of the case file")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  app.add_option("--case-hash", flags.hash, "hash of the case as the coupler read it")->type_name("HEX");
  auto* modes = app.add_option_group("modes", "instead of taking part in a run of Strake");
  modes->add_flag("--check", flags.check,
                  "read the case, refuse what a run would refuse, print derived numbers");
  app.add_flag("--values", flags.values, "with --check: then print what --echo prints");
  app.add_flag("--table", flags.table, "with --check --values: before them print what --properties prints");
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
  app.add_option("--into", options.deck.folder,
                 "with --export: folder of the input file; with --precice: of frames and history.csv")
      ->type_name("DIR");
  app.add_option("--origin", options.deck.origin, "with --export: what its heading says of its origin");
  modes->add_flag(
      "--interface", flags.interface,
      "print the surface that meets the water, with its velocity at t = 0 (Gmsh); structures alone");
  modes
      ->add_option("--precice", options.precice.config,
                   "take part in a preCICE run instead of one of Strake, by this precice-config.xml")
      ->type_name("CONFIG");
  app.add_option("--participant", options.precice.participant,
                 "with --precice: name of the participant in the configuration")
      ->type_name("NAME");
  app.add_option("--precice-library", options.precice.library,
                 "with --precice: libprecice.so.3 of preCICE 3; otherwise looked up in LD_LIBRARY_PATH")
      ->type_name("FILE");
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
  check_precice(options);
  if (flags.values && !flags.check)
    throw Error(ExitCode::command_line, "--values", "stands without --check", "--check --values, or --echo");
  if (flags.table && !flags.values)
    throw Error(ExitCode::command_line, "--table", "stands without --check --values",
                "--check --values --table, or --properties");
  options.values = flags.values;
  options.table = flags.table;
  using Mode = ParticipantOptions::Mode;
  options.mode = flags.check                    ? Mode::check
                 : flags.properties             ? Mode::properties
                 : flags.picture                ? Mode::picture
                 : flags.echo                   ? Mode::echo
                 : !options.deck.format.empty() ? Mode::export_deck
                 : flags.interface              ? Mode::interface
                 : !options.precice.config.empty() ? Mode::precice
                 : flags.keys                   ? Mode::keys
                 : flags.version                ? Mode::version
                                                : Mode::serve;
  return options;
}

}  // namespace strake
