#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "structure/mesh_files/mesh_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>

namespace strake::structure {
namespace {

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> words(1);
  for (const char c : line)
    if (c == ',')
      words.emplace_back();
    else if (!std::isspace(static_cast<unsigned char>(c)))
      words.back() += c;
  if (words.back().empty()) words.pop_back();
  return words;
}

/// "NSET" of "*NSET, NSET=clamp, GENERATE"; empty if it is not there.
std::string option(const std::vector<std::string>& keyword, const std::string& name) {
  for (const std::string& word : keyword) {
    const auto equal = word.find('=');
    if (equal != std::string::npos && upper(word.substr(0, equal)) == name) return word.substr(equal + 1);
  }
  return {};
}

struct Shape {
  std::string kind;
  std::size_t nodes;
};
/// By the family of the element's name: CPE4R and CPS4 are quadrilaterals, C3D8I is a hexahedron.
Shape shape_of(const std::string& type) {
  const auto begins = [&](const char* with) { return type.rfind(with, 0) == 0; };
  if (begins("CPE4") || begins("CPS4") || begins("S4")) return {"quadrilateral", 4};
  if (begins("CPE3") || begins("CPS3")) return {"triangle", 3};
  if (begins("C3D8")) return {"hexahedron", 8};
  if (begins("C3D4")) return {"tetrahedron", 4};
  return {};
}

}  // namespace

MeshText read_abaqus(const std::filesystem::path& path) {
  require_file(path, largest_mesh, path.string());
  std::ifstream in(path);
  if (!in) throw Error(ExitCode::case_file, path.string(), "cannot be read", "give the path of a mesh file");
  MeshText mesh;
  std::string line;
  std::size_t number = 0;
  std::vector<std::string> keyword;
  Shape shape;
  std::string section, set;
  std::map<long, std::string> element_set;
  std::vector<std::string> pending;  // of an element that continues over several lines
  const auto wrong = [&](const std::string& problem, const std::string& fix = "export the mesh anew") {
    return Error(ExitCode::case_file, fmt::format("{}:{}", path.string(), number), problem, fix);
  };
  const auto number_of = [&](const std::string& word, auto value) {
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (code != std::errc{} || end != word.data() + word.size())
      throw wrong("expected a number instead of \"" + word + "\"");
    return value;
  };
  while (std::getline(in, line)) {
    ++number;
    if (line.rfind("**", 0) == 0 || line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (line[0] == '*') {
      keyword = split(line);
      section = upper(keyword[0]);
      set = section == "*NSET" ? option(keyword, "NSET") : option(keyword, "ELSET");
      pending.clear();
      if (section == "*ELEMENT") {
        const std::string type = upper(option(keyword, "TYPE"));
        shape = shape_of(type);
        if (shape.kind.empty())
          throw wrong(
              fmt::format(
                  "elements of type {} are not linear quadrilaterals (CPE4, CPS4) or hexahedra (C3D8)", type),
              "mesh with those elements");
      }
      continue;
    }
    std::vector<std::string> words = split(line);
    if (section == "*NODE") {
      if (words.size() < 3) throw wrong("expected NUMBER, X, Y[, Z]");
      mesh.node[number_of(words[0], long{})] = {number_of(words[1], double{}), number_of(words[2], double{}),
                                                words.size() > 3 ? number_of(words[3], double{}) : 0.0};
    } else if (section == "*ELEMENT") {
      pending.insert(pending.end(), words.begin(), words.end());
      if (pending.size() < shape.nodes + 1) continue;
      MeshText::Element element;
      element.number = number_of(pending[0], long{});
      element.line = number;
      element.kind = shape.kind;
      element.group = set;
      for (std::size_t k = 1; k <= shape.nodes; ++k) element.node.push_back(number_of(pending[k], long{}));
      mesh.element.push_back(std::move(element));
      pending.clear();
    } else if (section == "*NSET" || section == "*ELSET") {
      const bool generate = std::any_of(keyword.begin(), keyword.end(),
                                        [](const std::string& w) { return upper(w) == "GENERATE"; });
      std::vector<long> members;
      for (const std::string& word : words) members.push_back(number_of(word, long{}));
      if (generate) {
        if (members.size() < 2) throw wrong("expected FIRST, LAST[, STEP]");
        const long first = members[0], last = members[1], step = members.size() > 2 ? members[2] : 1;
        if (step < 1 || last < first || last - first > 100'000'000)
          throw wrong("expected FIRST, LAST[, STEP] ascending");
        members.clear();
        for (long k = first; k <= last; k += step) members.push_back(k);
      }
      if (section == "*NSET")
        mesh.node_set[set].insert(mesh.node_set[set].end(), members.begin(), members.end());
      else
        for (const long member : members) element_set[member] = set;
    }
  }
  for (MeshText::Element& element : mesh.element)
    if (const auto found = element_set.find(element.number);
        found != element_set.end() && element.group.empty())
      element.group = found->second;
  if (mesh.node.empty() || mesh.element.empty()) throw wrong("the file has no *NODE or no *ELEMENT lines");
  return mesh;
}

}  // namespace strake::structure
