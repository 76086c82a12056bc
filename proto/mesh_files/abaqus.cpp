#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/mesh_files/byte_order_mark.hpp"
#include "proto/mesh_files/mesh_text.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>

namespace strake {
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

struct CellShape {
  std::string kind;
  std::size_t nodes = 0;
};
/// By the family of the element's name: CPE4R and CPS4 are quadrilaterals, C3D8I is a hexahedron.
CellShape shape_of(const std::string& type) {
  const auto begins = [&](const char* with) { return type.rfind(with, 0) == 0; };
  if (begins("CPE4") || begins("CPS4") || begins("S4")) return {"quadrilateral", 4};
  if (begins("CPE3") || begins("CPS3")) return {"triangle", 3};
  if (begins("C3D8")) return {"hexahedron", 8};
  if (begins("C3D4")) return {"tetrahedron", 4};
  return {};
}

/// Reads a file line by line: a keyword line opens a section, the lines after it are its data.
class AbaqusReader {
 public:
  explicit AbaqusReader(const std::filesystem::path& path) : path_(path) {}

  MeshText read() {
    require_file(path_, largest_mesh, path_.string());
    std::ifstream in(path_);
    if (!in)
      throw Error(ExitCode::case_file, path_.string(), "cannot be read", "give the path of a mesh file");
    for (std::string line; std::getline(in, line);) {
      if (++number_ == 1) line = std::string(without_byte_order_mark(line));
      if (line.rfind("**", 0) == 0 || line.find_first_not_of(" \t\r") == std::string::npos) continue;
      if (line[0] == '*')
        open_section(line);
      else
        read_data(split(line));
    }
    fill_sets();
    if (mesh_.node.empty() || mesh_.element.empty())
      throw wrong("the file has no *NODE or no *ELEMENT lines");
    return std::move(mesh_);
  }

 private:
  Error wrong(const std::string& problem, const std::string& fix = "export the mesh anew") const {
    return Error(ExitCode::case_file, fmt::format("{}:{}", path_.string(), number_), problem, fix);
  }

  template <class Number>
  Number number_of(const std::string& word) const {
    const auto value = number_from<Number>(word);
    if (!value) throw wrong("expected a number instead of \"" + word + "\"");
    return *value;
  }

  void open_section(const std::string& line) {
    keyword_ = split(line);
    section_ = upper(keyword_[0]);
    set_ = section_ == "*NSET" ? option(keyword_, "NSET") : option(keyword_, "ELSET");
    pending_.clear();
    const std::string system = upper(option(keyword_, "SYSTEM"));
    if (section_ == "*SYSTEM" || (section_ == "*NODE" && !system.empty() && system != "R"))
      throw wrong("coordinates of a system of their own, Cartesian ones of the whole are read",
                  "export the mesh with global Cartesian coordinates");
    if (section_ != "*ELEMENT") return;
    const std::string type = upper(option(keyword_, "TYPE"));
    shape_ = shape_of(type);
    if (shape_.kind.empty())
      throw wrong(fmt::format("elements of type {} are not linear quadrilaterals (CPE4, CPS4) or hexahedra "
                              "(C3D8)",
                              type),
                  "mesh with those elements");
  }

  void read_data(const std::vector<std::string>& words) {
    if (section_ == "*NODE") {
      read_node(words);
    } else if (section_ == "*INSTANCE") {
      refuse_moved(words);
    } else if (section_ == "*ELEMENT") {
      read_element(words);
    } else if (section_ == "*NSET" || section_ == "*ELSET") {
      read_set(words);
    }
  }

  /// Parts that count their nodes from 1 each would share them.
  void read_node(const std::vector<std::string>& words) {
    if (words.size() < 3) throw wrong("expected NUMBER, X, Y[, Z]");
    const long number = number_of<long>(words[0]);
    const std::array<double, 3> place = {number_of<double>(words[1]), number_of<double>(words[2]),
                                         words.size() > 3 ? number_of<double>(words[3]) : 0.0};
    const auto [found, fresh] = mesh_.node.emplace(number, place);
    if (!fresh && found->second != place)
      throw wrong(fmt::format("node {} is there twice, at two places", number), flat_file);
  }

  /// The data of *INSTANCE move and turn a part; its nodes would be read where the part has them.
  void refuse_moved(const std::vector<std::string>& words) const {
    for (const std::string& word : words)
      if (number_of<double>(word) != 0) throw wrong("an instance that is moved or turned", flat_file);
  }
  static constexpr const char* flat_file =
      "export one part in its place, without parts and assemblies (Abaqus/CAE: Model, Edit Attributes, Do "
      "not use parts and assemblies in input files)";

  void read_element(const std::vector<std::string>& words) {
    pending_.insert(pending_.end(), words.begin(), words.end());
    if (pending_.size() < shape_.nodes + 1) return;
    MeshText::Element element;
    element.number = number_of<long>(pending_[0]);
    element.line = number_;
    element.kind = shape_.kind;
    element.group = set_;
    for (std::size_t k = 1; k <= shape_.nodes; ++k) element.node.push_back(number_of<long>(pending_[k]));
    mesh_.element.push_back(std::move(element));
    pending_.clear();
  }

  void read_set(const std::vector<std::string>& words) {
    const bool generate = std::any_of(keyword_.begin(), keyword_.end(),
                                      [](const std::string& w) { return upper(w) == "GENERATE"; });
    std::vector<long> members;
    for (const std::string& word : words) members.push_back(number_of<long>(word));
    std::vector<Members>& all = section_ == "*NSET" ? node_members_ : element_members_;
    if (!generate) {
      for (const long member : members) all.push_back({member, member, 1, set_});
      return;
    }
    if (members.size() < 2) throw wrong("expected FIRST, LAST[, STEP]");
    const long first = members[0], last = members[1], step = members.size() > 2 ? members[2] : 1;
    if (step < 1 || first < 0 || last < first) throw wrong("expected FIRST, LAST[, STEP] ascending");
    all.push_back({first, last, step, set_});
  }

  /// Sets hold what the mesh has of their numbers: a short line can name more numbers than there is memory.
  /// Of several sets an element's group is the one of its *ELEMENT line, else the last.
  void fill_sets() {
    for (const Members& members : node_members_)
      for_each_in(members, mesh_.node,
                  [&](const auto& node) { mesh_.node_set[members.set].push_back(node.first); });
    std::map<long, std::string> set_of;
    for (const MeshText::Element& element : mesh_.element) set_of[element.number];
    for (const Members& members : element_members_)
      for_each_in(members, set_of, [&](auto& element) {
        element.second = members.set;
        mesh_.element_set[members.set].push_back(element.first);
      });
    for (MeshText::Element& element : mesh_.element)
      if (element.group.empty())
        element.group = set_of[element.number];
      else
        mesh_.element_set[element.group].push_back(element.number);
  }

  /// Numbers of a set: first, first + step … up to last.
  struct Members {
    long first, last, step;
    std::string set;
  };
  template <class Map, class Work>
  static void for_each_in(const Members& members, Map& map, const Work& work) {
    for (auto at = map.lower_bound(members.first); at != map.end() && at->first <= members.last; ++at)
      if ((at->first - members.first) % members.step == 0) work(*at);
  }

  std::filesystem::path path_;
  std::size_t number_ = 0;  // of the line
  MeshText mesh_;
  std::vector<std::string> keyword_, pending_;  // pending: of an element that goes on over several lines
  CellShape shape_;
  std::string section_, set_;
  std::vector<Members> node_members_, element_members_;
};

}  // namespace

MeshText read_abaqus(const std::filesystem::path& path) {
  return AbaqusReader(path).read();
}

}  // namespace strake
