#include "coupler/participant/participant_main.hpp"

#include "coupler/participant/case/declared_case.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/participant/liveness_thread.hpp"
#include "proto/case/case_file.hpp"
#include "proto/error.hpp"
#include "proto/mesh_files/mesh_text.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <utility>

namespace strake {
namespace {

/// Size and derived numbers of a case. One that takes long to build is not built: a check answers soon.
void print_check(CaseFile& file, const Program& program) {
  const SizeEstimates sizes = program.sizes ? program.sizes() : SizeEstimates{};
  if (const std::string text = size_text(sizes); !text.empty()) fmt::print("{}{}\n", size_words, text);
  if (const std::string remedy = remedy_of(sizes); is_large(sizes))
    fmt::print("{}a case of this size takes long to build{}; run it to see more\n", not_built_words,
               remedy.empty() ? "" : ", less with " + remedy);
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

/// The same after --check. What refuses the line alone is no error of the check: who wants it asks again.
void print_table(CaseFile& file, const ParticipantOptions& options, const Program& program) {
  try {
    fmt::print("{}{}", table_line, properties(file, options, program));
  } catch (const Error&) {
  }
}

/// The surface of a structure with its motion at t = 0, as a mesh of Gmsh's.
std::string interface_text(const ParticipantOptions& options, const Program& program) {
  if (program.prefix == "fluid")
    throw Error(ExitCode::command_line, program.program + " --interface",
                "a fluid's interface follows from the structure's", "strake-structure-fem CASE --interface");
  CaseFile file = load_declared(options, program);
  Setup setup;
  setup.interface = "surface";
  const std::unique_ptr<Participant> participant = program.build(file, options, setup);
  return gmsh_text(participant->mesh(), participant->description().initial);
}

int serve_case(const ParticipantOptions& options, const Program& program) {
  for (const auto& [value, name] :
       {std::pair{options.endpoint, "--connect"}, {options.name, "--name"}, {options.case_file, "--case"}})
    require_option(!value.empty(), name);
  CaseFile file = load_case(options, program);
  const char* token = std::getenv("STRAKE_TOKEN");
  const ServeOptions serving{options.endpoint, options.name,    token ? token : "",
                             program.solver,   program.version, file.hash()};
  return serve(serving, [&](const Setup& setup) {
    declare_case(file, program);  // late, so that the coupler receives an error
    return program.build(file, options, setup);
  });
}

int run_mode(const ParticipantOptions& options, const Program& program) {
  using Mode = ParticipantOptions::Mode;
  switch (options.mode) {
    case Mode::serve:
      return serve_case(options, program);
    case Mode::precice:
      return run_in_precice(options, program);
    case Mode::interface:
      fmt::print("{}", interface_text(options, program));
      break;
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
        require_option(!value.empty(), name);
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
      const std::string values = options.values ? values_line + file.echo(program.prefix) : "";
      print_check(file, program);
      if (options.table) print_table(file, options, program);
      fmt::print("{}", values);
      break;
    }
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace

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
