// Several bodies in one water: [[structures]], each with a name and the keys of [structure].
#include "proto/case/case_document.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

namespace strake {
namespace {

constexpr std::size_t most_bodies = 64, longest_name = 40;
// What the console, the files of a run and the probes call something else.
constexpr std::array reserved = {"fluid", "structure", "structures", "coupling", "coupler", "both", "air"};

bool is_name(const std::string& name) {
  const auto letter = [](unsigned char c) { return std::isalpha(c) != 0 && c < 128; };
  const auto inside = [&](unsigned char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name.size() <= longest_name && letter(static_cast<unsigned char>(name.front())) &&
         std::all_of(name.begin(), name.end(), inside);
}

/// Replaces the beginning of a path, where it is `from`.
std::string moved(const std::string& path, const std::string& from, const std::string& to) {
  return lies_below(path, from) ? to + path.substr(from.size()) : path;
}

}  // namespace

void CaseFile::Document::read_bodies() {
  const std::string list = "structures";
  const toml::node* node = at(list);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  const bool tables = array != nullptr && std::all_of(array->begin(), array->end(),
                                                      [](const toml::node& n) { return n.is_table(); });
  if (!tables || array->empty())
    throw wrong(list, "tables [[structures]], one for each body", "[[structures]]");
  if (array->size() > most_bodies)
    throw wrong(list, fmt::format("at most {} bodies, not {}", most_bodies, array->size()),
                "leave out some, or make those that do not move walls of the tank");
  if (at("structure") != nullptr)
    throw Error(
        ExitCode::case_file, where("structure", "[structure]"),
        "stands beside [[structures]]: a case has one body or a list of them",
        "name the body: structures.NAME. in front of its keys, or another [[structures]] with a name");
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string element = fmt::format("{}[{}]", list, i), path = element + ".name";
    if (at(path) == nullptr) throw missing(path, "a name of its own for each body", "\"left\"");
    const auto* text = at(path)->as_string();
    if (text == nullptr || !is_name(text->get()))
      throw wrong(path, fmt::format("letters, digits and '_', a letter first, at most {}", longest_name),
                  "name = \"left\"");
    if (std::find(reserved.begin(), reserved.end(), text->get()) != reserved.end())
      throw wrong(path, fmt::format("a name that is free: \"{}\" means something else here", text->get()),
                  "name = \"left\"");
    if (std::find(bodies.begin(), bodies.end(), text->get()) != bodies.end())
      throw wrong(path, "a name that no other body has", "name = \"" + text->get() + "_2\"");
    bodies.push_back(text->get());
  }
}

void CaseFile::Document::choose_body(const std::string& name_of_body) {
  const auto found = std::find(bodies.begin(), bodies.end(), name_of_body);
  if (found == bodies.end())
    throw Error(ExitCode::command_line, "--body " + name_of_body,
                bodies.empty() ? std::string("the case has no [[structures]]")
                               : fmt::format("the case has the bodies {}", joined(bodies)));
  const auto index = static_cast<std::size_t>(found - bodies.begin());
  body = *found;
  toml::table* element = root["structures"].as_array()->get(index)->as_table();
  element->erase("name");
  root.insert_or_assign("structure", std::move(*element));
  root.erase("structures");
  for (Set& set : sets) set.path = moved(set.path, fmt::format("structures[{}]", index), "structure");
}

/// "structure.plate.length" of the body left is "structures.left.plate.length", as --set takes it.
std::string CaseFile::Document::shown(const std::string& path) const {
  return body.empty() ? path : moved(path, "structure", "structures." + body);
}

std::string CaseFile::Document::in_file(const std::string& table) const {
  return body.empty() ? table : moved(table, "structure", "structures");
}

/// structures.left.solver is structures[0].solver; likewise attachments.mooring.at.
void CaseFile::Document::find_named(std::vector<PathStep>& steps, const std::string& where) const {
  const bool is_body = !steps.empty() && steps[0].key == "structures";
  if (steps.size() < 2 || steps[1].is_index || (!is_body && steps[0].key != "attachments")) return;
  const std::string list = steps[0].key;
  std::vector<std::string> names;
  const toml::array* array = root[list].as_array();
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
    const toml::table* element = array->get(i)->as_table();
    names.push_back(element == nullptr ? "" : (*element)["name"].value_or(std::string()));
    if (names.back() != steps[1].key) continue;
    steps[1] = {.key = {}, .is_index = true, .index = static_cast<long>(i)};
    return;
  }
  const std::string instead = is_body ? "structure." + steps[1].key : "write it into the case file";
  throw Error(ExitCode::case_file, where,
              names.empty() ? fmt::format("the case has no [[{}]]", list)
                            : fmt::format("the case has the {} {}", is_body ? "bodies" : list, joined(names)),
              names.empty() ? instead : list + "." + names.front() + ".…");
}

/// [structure.plate] of a body as it stands in a file: [structures.plate], below [[structures]] with its
/// name.
std::string CaseFile::Document::as_body(const std::string& toml_text) const {
  if (body.empty()) return toml_text;
  std::istringstream lines(toml_text);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin =
        std::min(line.find_first_not_of(' '), line.size());  // tables below are indented
    const std::string_view head = std::string_view(line).substr(begin);
    if (head == "[structure]")
      line = "[[structures]]\nname = \"" + body + "\"  # given";
    else if (head.starts_with("[structure.") || head.starts_with("[[structure."))
      line.insert(line.find("structure") + 9, "s");
    text += line + "\n";
  }
  return text;
}

const std::vector<std::string>& CaseFile::bodies() const {
  return document_->bodies;
}

const std::string& CaseFile::body() const {
  return document_->body;
}

CaseFile CaseFile::of_body(const std::string& name) const {
  // Parsed again, since a copy of a table does not know its lines.
  std::vector<std::string> sets;
  for (const Document::Set& set : document_->sets) sets.push_back(set.argument);
  CaseFile one = parse(document_->bytes, document_->name, sets);
  one.document_->file = document_->file;
  one.document_->whole = document_->whole ? document_->whole : document_;
  one.document_->choose_body(name);
  return one;
}

}  // namespace strake
