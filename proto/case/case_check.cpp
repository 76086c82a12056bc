// Reports keys that no program declared.
#include "proto/case/case_document.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace strake {
namespace {

using Document = CaseFile::Document;

struct Unknown {
  std::string path;
  toml::source_position at;
  const Document::Set* set;
};

class Search {
 public:
  explicit Search(const Document& document) : document_(document) {}

  void table(const toml::table& table, const std::string& path) {
    if (accepted(path)) return;
    for (auto&& [key, node] : table) {
      const std::string below = (path.empty() ? "" : path + ".") + quoted_key(std::string(key.str()));
      const bool declared_table = document_.tables.contains(below);
      if (accepted(below) || (document_.index.contains(below) && !declared_table)) continue;
      if (node.is_table() && leads_to_a_declaration(below))
        this->table(*node.as_table(), below);
      else if (node.is_array() && declared_table)
        elements(*node.as_array(), below);
      else if (!declared_table)
        found.push_back({below, key.source().begin, document_.set_of(below)});
    }
  }

  std::vector<Unknown> found;

 private:
  void elements(const toml::array& array, const std::string& path) {
    for (std::size_t i = 0; i < array.size(); ++i)
      if (const toml::table* element = array.get(i)->as_table())
        table(*element, fmt::format("{}[{}]", path, i));
  }

  bool accepted(const std::string& path) const {
    return std::any_of(document_.accepted.begin(), document_.accepted.end(),
                       [&](const std::string& prefix) { return lies_below(path, prefix); });
  }

  bool leads_to_a_declaration(const std::string& path) const {
    return document_.tables.contains(path) ||
           std::any_of(document_.keys.begin(), document_.keys.end(),
                       [&](const KeyInfo& key) { return lies_below(key.path, path); });
  }

  const Document& document_;
};

/// The key that the user may have meant. It is a near name in the same table, else the same name in another
/// one.
std::string advice(const Document& document, const std::string& path) {
  const std::pair<std::string, std::string> split = parent_and_name(path);
  const auto &parent = split.first, &name = split.second;  // a lambda of clang 14 takes no structured binding
  std::vector<std::string> siblings, near_by, elsewhere;
  const auto consider = [&](const std::string& known) {
    const auto [table, key] = parent_and_name(known);
    if (table == parent && !key.empty()) siblings.push_back(key);
    const bool below = !parent.empty() && lies_below(table, parent);
    if (table == parent || (!below && known.find('[') != std::string::npos)) return;
    // Further down another name of the quantity will do: structure.E is structure.material.young.
    if (below && key == name) near_by.insert(near_by.begin(), known);
    if (below && key != name && means(key, name)) near_by.push_back(known);
    if (key == name) elsewhere.push_back(known);
  };
  for (const KeyInfo& key : document.keys) consider(key.path);
  for (const std::string& table : document.tables) consider(table);
  elsewhere.insert(elsewhere.begin(), near_by.begin(), near_by.end());
  const auto command = [](const std::string& table) -> std::string {
    const bool all = table.empty() || table.find('[') != std::string::npos;
    return all ? "strake explain" : "strake explain " + table;
  };
  const auto explain = [&](const std::string& table) {
    return document.explained ? fmt::format("  ({})", command(table)) : std::string();
  };
  const bool sibling =
      std::any_of(siblings.begin(), siblings.end(), [&](const std::string& key) { return means(key, name); });
  if (const std::string near = meant_key(name, siblings); !near.empty() && (sibling || near_by.empty()))
    return fmt::format("did you mean {}?{}", quoted_key(near), explain(parent));
  if (!elsewhere.empty())
    return fmt::format("did you mean {}?{}", elsewhere.front(),
                       explain(parent_and_name(elsewhere.front()).first));
  if (document.explained) return command(parent) + " lists the keys";
  return fmt::format("its keys are {}", joined(siblings));
}

}  // namespace

void CaseFile::refuse_unknown(const std::string& prefix) const {
  const Document& document = *document_;
  const toml::node* start = document.at(prefix);
  if (!start || !start->is_table()) return;
  Search search(document);
  search.table(*start->as_table(), prefix);
  if (search.found.empty()) return;
  std::stable_sort(search.found.begin(), search.found.end(), [](const Unknown& a, const Unknown& b) {
    if ((a.set != nullptr) != (b.set != nullptr)) return b.set != nullptr;
    return a.set ? a.set < b.set : std::pair(a.at.line, a.at.column) < std::pair(b.at.line, b.at.column);
  });
  const auto place = [&](const Unknown& unknown) {
    return unknown.set ? "--set " + unknown.set->argument : document.place(unknown.at);
  };
  std::string problem = document.shown(search.found.front().path) + " is not a key";
  for (std::size_t i = 1; i < search.found.size(); ++i)
    problem += fmt::format("\n{}: {} is not a key; {}", place(search.found[i]),
                           document.shown(search.found[i].path), advice(document, search.found[i].path));
  const Error unknown(ExitCode::case_file, place(search.found.front()), problem,
                      advice(document, search.found.front().path));
  if (!document.collects) throw unknown;
  // First: what is missing may be what has a misspelt name.
  document_->refused.insert(document_->refused.begin(), unknown);
}

void CaseFile::read_all(const std::function<void()>& read) {
  Document& document = *document_;
  document.collects = true;
  document.refused.clear();
  std::optional<Error> last;
  try {
    read();
  } catch (const Error& error) {
    last = error;
  } catch (const std::exception&) {  // of values that stand in for refused ones
    document.collects = false;
    if (document.refused.empty()) throw;
  }
  document.collects = false;
  if (last && last->code() != ExitCode::case_file) throw *last;
  if (!document.refused.empty()) throw all_of(document.refused);
  if (last) throw *last;
}

}  // namespace strake
