#include "proto/case/foreign_keys.hpp"

#include "proto/case/case_file.hpp"

namespace strake {

ForeignKeys read_foreign(CaseFile& file, const std::string& side, const std::string& solver) {
  ForeignKeys keys;
  CaseTable table = file.root().table(side);
  const bool users = solver.find('/') != std::string::npos;
  if (!users && !file.only_declares()) {
    if (solver == "none") return keys;
    for (const char* name : {"arguments", "folder", "precice_names", "surface"})
      if (table.has(name))
        throw table.error(name, "no such key beside solver = \"" + solver + "\"",
                          "it is for a program of yours: solver = \"./PROGRAM\"");
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
  table.texts("precice_names", keys.precice_names,
              {.help = "where solver is a path: for a program with a preCICE adapter, a list of "
                       "\"Name=quantity\": what its names of data are at Strake's coupler"});
  for (const std::string& rule : keys.precice_names) {
    const std::size_t equals = rule.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == rule.size() ||
        rule.find(';') != std::string::npos)
      throw table.error("precice_names", "texts \"Name=quantity\", not \"" + rule + "\"",
                        "precice_names = [\"Force=force\", \"Displacement=displacement\"]");
  }
  if (side == "structure")
    table.file(
        "surface", keys.surface,
        {.help = "where solver is a path: mesh of the surface that meets the water, for a program that "
                 "sends its points without faces; Gmsh (.msh, text) or Abaqus (.inp), with the "
                 "program's own points as nodes"});
  return keys;
}

}  // namespace strake
