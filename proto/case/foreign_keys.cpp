#include "proto/case/foreign_keys.hpp"

#include "proto/case/case_file.hpp"
#include "proto/error.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace strake {
namespace {

namespace fs = std::filesystem;

/// Refuses a text that is no rule "Name=quantity".
void check_names(const CaseTable& table, const std::string& key, const std::vector<std::string>& rules) {
  for (const std::string& rule : rules) {
    const std::size_t equals = rule.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == rule.size() ||
        rule.find(';') != std::string::npos)
      throw table.error(key, "texts \"Name=quantity\", not \"" + rule + "\"", key + " = [\"Force=force\"]");
  }
}

void read_surface(CaseTable& table, fs::path& surface, const std::string& where) {
  table.file(
      "surface", surface,
      {.help = where +
               ": mesh of the surface that meets the water, for a program that sends its points without "
               "faces; Gmsh (.msh, text) or Abaqus (.inp), with the program's own points as nodes"});
}

void read_names(CaseTable& table, ForeignKeys& keys) {
  table.texts("precice_names", keys.precice_names,
              {.help = "where solver is a path: for a program with a preCICE adapter, a list of "
                       "\"Name=quantity\": what its names of data are at Strake's coupler; for Strake's own "
                       "solver in a preCICE run (--precice): what they are at that solver"});
  check_names(table, "precice_names", keys.precice_names);
}

/// The program that a shell would start for a word: a path, from the case file's folder, or the first of that
/// name on PATH; below the case file's folder if there is none.
fs::path program_of(const std::string& word, const fs::path& case_folder) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(word.find('/') == std::string::npos && path ? path : "");
  std::error_code ignored;
  for (std::string folder; std::getline(folders, folder, ':');)
    if (const fs::path file = fs::path(folder) / word; fs::is_regular_file(file, ignored))
      return fs::absolute(file);
  return fs::absolute(case_folder / word).lexically_normal();
}

/// Only a program knows the keys of its table, but Strake knows those of the table `precice`.
void refuse_other_keys(const CaseTable& table, const std::vector<std::string>& known) {
  for (const std::string& key : table.keys())
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      const std::string nearest = did_you_mean(key, known);
      throw table.error(key, "a key of a preCICE solver",
                        nearest.empty() ? "command, folder, config, read, write, surface"
                                        : "did you mean " + nearest + "?");
    }
}

/// The table `precice` of a side. Its words become those of a program with a command line of its own.
ForeignKeys read_precice(const CaseFile& file, CaseTable table, bool is_structure, std::string& solver) {
  ForeignKeys keys;
  std::vector<std::string> command, read, write;
  table.texts(
      "command", command,
      {.help =
           "the program, a path or a name on PATH, and its arguments: [\"ccx_preCICE\", \"-i\", \"flap\"]"});
  table.folder("folder", keys.folder,
               {.help = "where it is started; not given: the folder where strake was called"});
  table.file("config", keys.precice_config,
             {.help = "precice-config.xml: names of data are looked up in it; its scheme is not used"});
  table.texts("read", read,
              {.help = "what the program reads, a list of \"Name=quantity\": [\"Force=force\"]"});
  table.texts(
      "write", write,
      {.help = "what the program writes, a list of \"Name=quantity\": [\"Displacement=displacement\"]"});
  if (is_structure) read_surface(table, keys.surface, "where solver = \"precice\"");
  if (file.only_declares()) return {};
  refuse_other_keys(table, {"command", "folder", "config", "read", "write", "surface"});
  check_names(table, "read", read);
  check_names(table, "write", write);
  keys.own_command_line = keys.adapted = true;
  keys.precice_names = read;
  keys.precice_names.insert(keys.precice_names.end(), write.begin(), write.end());
  const bool named = !command.empty() && !command.front().empty();
  if (!named && keys.surface.empty())
    throw table.error("command", "a program and its arguments",
                      "command = [\"ccx_preCICE\", \"-i\", \"flap\"]");
  if (!named) return keys;
  solver = program_of(command.front(), file.folder()).string();
  keys.arguments.assign(command.begin() + 1, command.end());
  return keys;
}

}  // namespace

ForeignKeys read_foreign(CaseFile& file, const std::string& side, std::string& solver) {
  ForeignKeys keys;
  CaseTable table = file.root().table(side);
  const bool users = solver.find('/') != std::string::npos, adapted = solver == "precice";
  if (adapted || file.only_declares())
    keys = read_precice(
        file, table.table("precice", "a program with a preCICE adapter, where solver = \"precice\""),
        side == "structure", solver);
  if (!users && !file.only_declares()) {
    if (solver == "none") return keys;
    if (!adapted && table.has("precice_names")) read_names(table, keys);
    for (const char* name : {"arguments", "folder", "surface", adapted ? "precice_names" : "precice"})
      if (table.has(name))
        throw table.error(name,
                          "no such key beside solver = \"" + std::string(adapted ? "precice" : solver) + "\"",
                          adapted ? "it is for solver = \"./PROGRAM\"; here " + side + ".precice has its own"
                                  : "it is for a program of yours: solver = \"./PROGRAM\"");
    return keys;
  }
  keys.own_command_line = table.has("arguments");
  table.texts(
      "arguments", keys.arguments,
      {.help = "where solver is a path: the whole command line of a program that knows none of Strake's "
               "options; its connection is in its environment (proto/WIRE.md)"});
  table.folder("folder", keys.folder,
               {.help = "where solver is a path: the folder in which the program is started; not given: the "
                        "one where strake was called"});
  read_names(table, keys);
  if (side == "structure") read_surface(table, keys.surface, "where solver is a path");
  return keys;
}

}  // namespace strake
