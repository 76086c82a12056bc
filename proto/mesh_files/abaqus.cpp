#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/mesh_files/mesh_text.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
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
      ++number_;
      if (line.rfind("**", 0) == 0 || line.find_first_not_of(" \t\r") == std::string::npos) continue;
      if (line[0] == '*')
        open_section(line);
      else
        read_data(split(line));
    }
    for (MeshText::Element& element : mesh_.element)
      if (const auto found = element_set_.find(element.number);
          found != element_set_.end() && element.group.empty())
        element.group = found->second;
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
      if (words.size() < 3) throw wrong("expected NUMBER, X, Y[, Z]");
      mesh_.node[number_of<long>(words[0])] = {number_of<double>(words[1]), number_of<double>(words[2]),
                                               words.size() > 3 ? number_of<double>(words[3]) : 0.0};
    } else if (section_ == "*ELEMENT") {
      read_element(words);
    } else if (section_ == "*NSET" || section_ == "*ELSET") {
      read_set(words);
    }
  }

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
    if (generate) {
      if (members.size() < 2) throw wrong("expected FIRST, LAST[, STEP]");
      const long first = members[0], last = members[1], step = members.size() > 2 ? members[2] : 1;
      if (step < 1 || last < first || last - first > 100'000'000)
        throw wrong("expected FIRST, LAST[, STEP] ascending");
      members.clear();
      for (long k = first; k <= last; k += step) members.push_back(k);
    }
    if (section_ == "*NSET")
      mesh_.node_set[set_].insert(mesh_.node_set[set_].end(), members.begin(), members.end());
    else
      for (const long member : members) element_set_[member] = set_;
  }

  std::filesystem::path path_;
  std::size_t number_ = 0;  // of the line
  MeshText mesh_;
  std::vector<std::string> keyword_, pending_;  // pending: of an element that goes on over several lines
  CellShape shape_;
  std::string section_, set_;
  std::map<long, std::string> element_set_;
};

}  // namespace

MeshText read_abaqus(const std::filesystem::path& path) {
  return AbaqusReader(path).read();
}

}  // namespace strake
