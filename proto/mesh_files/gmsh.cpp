#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/mesh_files/byte_order_mark.hpp"
#include "proto/mesh_files/mesh_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <locale>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace strake {
namespace {

/// Lines of a file with their numbers, and errors that name them.
class Lines {
 public:
  Lines(std::istream& in, std::string name) : in_(in), name_(std::move(name)) {}
  bool next(std::string& line) {
    if (!std::getline(in_, line)) return false;
    if (++number_ == 1) line = std::string(without_byte_order_mark(line));
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
  }
  /// The next line as a stream of words in the C locale; an error where the file ends.
  std::istringstream words(const std::string& expected) {
    std::string line;
    if (!next(line)) throw error("the file ends here, expected " + expected);
    std::istringstream stream(line);
    stream.imbue(std::locale::classic());
    return stream;
  }
  Error error(const std::string& problem,
              const std::string& fix = "write the mesh anew, e.g. gmsh -2 -format msh41 FILE.geo") const {
    return {ExitCode::case_file, fmt::format("{}:{}", name_, number_), problem, fix};
  }
  std::size_t number() const { return number_; }

 private:
  std::istream& in_;
  std::string name_;
  std::size_t number_ = 0;
};

template <class... Value>
void take(Lines& lines, std::istringstream& words, const std::string& expected, Value&... value) {
  if (!(words >> ... >> value)) throw lines.error("expected " + expected);
}

/// The number in a line of its own.
long count(Lines& lines, const std::string& expected) {
  long n = 0;
  auto words = lines.words(expected);
  take(lines, words, expected, n);
  return n;
}

/// Gmsh's numbers of elements (MSH file format, section 9.1 of its manual).
struct Kind {
  std::string name;
  int dimension, nodes;
};
Kind kind_of(const Lines& lines, int type) {
  static const std::map<int, Kind> known = {{1, {"line", 1, 2}},          {2, {"triangle", 2, 3}},
                                            {3, {"quadrilateral", 2, 4}}, {4, {"tetrahedron", 3, 4}},
                                            {5, {"hexahedron", 3, 8}},    {6, {"prism", 3, 6}},
                                            {7, {"pyramid", 3, 5}},       {15, {"point", 0, 1}}};
  const auto found = known.find(type);
  if (found == known.end())
    throw lines.error(
        fmt::format("elements of Gmsh's type {} are not linear lines, quadrilaterals or hexahedra", type),
        "mesh with linear elements: Mesh.ElementOrder = 1");
  return found->second;
}

using Names = std::map<std::pair<int, int>, std::string>;  // (dimension, tag) of a physical group

Names read_names(Lines& lines) {
  Names names;
  const long n = count(lines, "the number of physical names");
  for (long i = 0; i < n; ++i) {
    int dimension = 0, tag = 0;
    auto entry = lines.words("a physical name");
    take(lines, entry, "DIMENSION TAG \"NAME\"", dimension, tag);
    std::string name;
    std::getline(entry, name);
    const auto from = name.find('"'), to = name.rfind('"');
    if (from == std::string::npos || to <= from) throw lines.error("expected DIMENSION TAG \"NAME\"");
    names[{dimension, tag}] = name.substr(from + 1, to - from - 1);
  }
  return names;
}

/// Gmsh gives a tag the sign of the entity's orientation in the group: Physical Curve("clamp") = {-4}.
std::string name_of(const Names& names, int dimension, int signed_tag) {
  const int tag = std::abs(signed_tag);
  const auto found = names.find({dimension, tag});
  return found != names.end() ? found->second : tag == 0 ? "" : std::to_string(tag);
}

void read_nodes_2(Lines& lines, MeshText& mesh) {
  const long n = count(lines, "the number of nodes");
  for (long i = 0; i < n; ++i) {
    long number = 0;
    double x = 0, y = 0, z = 0;
    auto entry = lines.words("a node");
    take(lines, entry, "NUMBER X Y Z", number, x, y, z);
    mesh.node[number] = {x, y, z};
  }
}

/// Adds the element whose corners the rest of a line names.
void add_element(Lines& lines, std::istringstream& entry, const Kind& kind, long number,
                 const std::string& group, MeshText& mesh) {
  MeshText::Element element{.number = number, .line = lines.number(), .kind = kind.name, .group = group};
  element.node.resize(static_cast<std::size_t>(kind.nodes));
  for (long& node : element.node)
    take(lines, entry, fmt::format("{} nodes of a {}", kind.nodes, kind.name), node);
  mesh.element.push_back(std::move(element));
}

void read_elements_2(Lines& lines, const Names& names, MeshText& mesh) {
  const long n = count(lines, "the number of elements");
  for (long i = 0; i < n; ++i) {
    long number = 0;
    int type = 0, tags = 0, physical = 0, other = 0;
    auto entry = lines.words("an element");
    take(lines, entry, "NUMBER TYPE TAGS …", number, type, tags);
    for (int t = 0; t < tags; ++t) take(lines, entry, "a tag", t == 0 ? physical : other);
    const Kind kind = kind_of(lines, type);
    add_element(lines, entry, kind, number, name_of(names, kind.dimension, physical), mesh);
  }
}

/// Format 4: physical tags of each entity (dimension, number).
using Entities = std::map<std::pair<int, int>, std::vector<int>>;

Entities read_entities(Lines& lines) {
  Entities physical;
  std::array<long, 4> count{};
  auto words = lines.words("the numbers of entities");
  take(lines, words, "four numbers of entities", count[0], count[1], count[2], count[3]);
  for (int dimension = 0; dimension < 4; ++dimension)
    for (long i = 0; i < count[static_cast<std::size_t>(dimension)]; ++i) {
      int tag = 0, groups = 0;
      double coordinate = 0;
      auto entry = lines.words("an entity");
      take(lines, entry, "an entity's tag", tag);
      for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) take(lines, entry, "an entity's bounds", coordinate);
      take(lines, entry, "an entity's number of physical groups", groups);
      for (int g = 0, group = 0; g < groups; ++g) {
        take(lines, entry, "an entity's physical group", group);
        physical[{dimension, tag}].push_back(group);
      }
    }
  return physical;
}

void read_nodes_4(Lines& lines, MeshText& mesh) {
  const long blocks = count(lines, "the number of blocks of nodes");
  for (long b = 0; b < blocks; ++b) {
    long dimension = 0, entity = 0, parametric = 0, count = 0;
    auto head = lines.words("a block of nodes");
    take(lines, head, "DIMENSION ENTITY PARAMETRIC COUNT", dimension, entity, parametric, count);
    std::vector<long> numbers;
    for (long i = 0; i < count; ++i) {
      long number = 0;
      auto entry = lines.words("a node's number");
      take(lines, entry, "a node's number", number);
      numbers.push_back(number);
    }
    for (const long number : numbers) {
      double x = 0, y = 0, z = 0;
      auto entry = lines.words("a node's place");
      take(lines, entry, "X Y Z", x, y, z);
      mesh.node[number] = {x, y, z};
    }
  }
}

/// An element of several groups stands there once for each, as format 2 writes it.
void read_elements_4(Lines& lines, const Names& names, const Entities& entities, MeshText& mesh) {
  const long blocks = count(lines, "the number of blocks of elements");
  for (long b = 0; b < blocks; ++b) {
    int dimension = 0, entity = 0, type = 0;
    long count = 0;
    auto head = lines.words("a block of elements");
    take(lines, head, "DIMENSION ENTITY TYPE COUNT", dimension, entity, type, count);
    const Kind kind = kind_of(lines, type);
    const auto found = entities.find({dimension, entity});
    std::vector<std::string> groups;
    if (found != entities.end())
      for (const int tag : found->second) groups.push_back(name_of(names, dimension, tag));
    if (groups.empty()) groups.emplace_back();
    for (long i = 0; i < count; ++i) {
      long number = 0;
      auto entry = lines.words("an element");
      take(lines, entry, "an element's number", number);
      add_element(lines, entry, kind, number, groups.front(), mesh);
      for (std::size_t g = 1; g < groups.size(); ++g) {
        mesh.element.push_back(mesh.element.back());
        mesh.element.back().group = groups[g];
      }
    }
  }
}

/// The lines of a section that holds one text or number each: their number, then they.
std::vector<std::string> read_tags(Lines& lines, const std::string& what) {
  std::vector<std::string> tags;
  for (long left = count(lines, "the number of " + what); left > 0; --left) {
    std::string line;
    if (!lines.next(line)) throw lines.error("the file ends here, expected " + what);
    tags.push_back(line);
  }
  return tags;
}

/// A vector on nodes; other numbers of components are passed over.
void read_node_data(Lines& lines, MeshText& mesh) {
  const std::vector<std::string> texts = read_tags(lines, "text tags");
  read_tags(lines, "real tags");
  const std::vector<std::string> numbers = read_tags(lines, "whole tags");
  if (texts.empty() || numbers.size() < 3 || numbers[1] != "3") return;
  std::string name = texts.front();
  std::erase(name, '"');
  auto& data = mesh.node_data[name];
  for (long left = std::atol(numbers[2].c_str()); left > 0; --left) {
    long node = 0;
    std::array<double, 3> value{};
    auto entry = lines.words("a value on a node");
    take(lines, entry, "NODE X Y Z", node, value[0], value[1], value[2]);
    data[node] = value;
  }
}

MeshText read_gmsh(Lines& lines) {
  MeshText mesh;
  Names names;
  Entities physical;
  int format = 0;
  std::string line;
  while (lines.next(line)) {
    if (line.empty() || line[0] != '$' || line.rfind("$End", 0) == 0) continue;
    const std::string section = line.substr(1);
    if (section == "MeshFormat") {
      double version = 0;
      int binary = 0;
      auto words = lines.words("VERSION BINARY SIZE");
      take(lines, words, "VERSION BINARY SIZE", version, binary);
      format = version >= 2 && version < 3 ? 2 : version >= 4.1 && version < 5 ? 4 : 0;
      if (format == 0)
        throw lines.error(fmt::format("format {} of Gmsh is not 2.2 or 4.1", version),
                          "gmsh -2 -format msh41 FILE.geo");
      if (binary != 0)
        throw lines.error("a binary mesh file, text is read",
                          "gmsh -2 -format msh41 -bin 0 FILE.geo, or Mesh.Binary = 0");
      continue;
    }
    const bool known =
        section == "PhysicalNames" || section == "Entities" || section == "Nodes" || section == "Elements";
    if (known && format == 0) throw lines.error("a Gmsh file begins with $MeshFormat, this one does not");
    if (section == "PhysicalNames")
      names = read_names(lines);
    else if (section == "Entities")
      physical = read_entities(lines);
    else if (section == "Nodes")
      format == 2 ? read_nodes_2(lines, mesh) : read_nodes_4(lines, mesh);
    else if (section == "Elements")
      format == 2 ? read_elements_2(lines, names, mesh) : read_elements_4(lines, names, physical, mesh);
    else if (section == "NodeData")
      read_node_data(lines, mesh);
  }
  if (format == 0) throw lines.error("no Gmsh file: it has no $MeshFormat");
  if (mesh.node.empty() || mesh.element.empty())
    throw lines.error("the file ends without $Nodes and $Elements");
  return mesh;
}

}  // namespace

MeshText read_gmsh(const std::filesystem::path& path) {
  require_file(path, largest_mesh, path.string());
  std::ifstream in(path);
  if (!in) throw Error(ExitCode::case_file, path.string(), "cannot be read", "give the path of a mesh file");
  Lines lines(in, path.string());
  return read_gmsh(lines);
}

MeshText read_gmsh_text(const std::string& text, const std::string& name) {
  std::istringstream in(text);
  Lines lines(in, name);
  return read_gmsh(lines);
}

}  // namespace strake
