#include "coupler/import/import_parts.hpp"

#include <fmt/format.h>

namespace strake {

std::string place_of(const XmlElement& element) {
  return fmt::format("line {}", element.line);
}

ImportedRun import_precice(const std::filesystem::path& path) {
  Configuration from{{}, read_xml_tree(path)};
  ImportedRun run;
  run.file = path;
  // Another file altogether is told by the reader of names, below.
  if (from.tree.element.name == "precice-configuration") run.notes = check_elements(from.tree);
  from.config = PreciceConfig::read(path);
  import_sides(from, run);
  import_mapping(from, run);
  import_scheme(from, run);
  import_measures(from, run);
  import_acceleration(from, run);
  return run;
}

}  // namespace strake
