#include "proto/case/foreign_keys.hpp"

#include "proto/case/case_file.hpp"

namespace strake {

ForeignKeys read_foreign(CaseFile& file, const std::string& side, const std::string& solver) {
  ForeignKeys keys;
  CaseTable table = file.root().table(side);
  const bool users = solver.find('/') != std::string::npos;
  if (!users && !file.only_declares()) {
    if (solver == "none") return keys;
    for (const char* name : {"arguments", "folder"})
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
  return keys;
}

}  // namespace strake
