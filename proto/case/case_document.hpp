#pragma once
// Private to the case_*.cpp files: the parsed document behind CaseFile and CaseTable.

#include "proto/case/case_file.hpp"

#include <toml++/toml.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace strake {

/// One step of a path: a key, or the index of an element of an array. "[]" (any element, in declarations) has
/// index −1.
struct PathStep {
  std::string key;
  bool is_index = false;
  long index = -1;
};

/// "output.probe[0].diameter", with quotes around a key that is not bare:
/// `compare[0].when."structure.solver"`. Empty if the text is no path.
std::vector<PathStep> split_path(const std::string& path);
std::string quoted_key(const std::string& key);  // as TOML wants it: bare where that is allowed
/// The last key of a path without quotes, and what stands before it.
std::pair<std::string, std::string> parent_and_name(const std::string& path);
/// True if `path` is `prefix` or lies below it; everything lies below the empty prefix.
bool lies_below(const std::string& path, const std::string& prefix);

/// Whether a word is the key's name (without its tables) or another name of the quantity: E is young.
bool means(const std::string& key, const std::string& word);
/// The key of `known` that a word means: another name of the quantity (E is young), or a slip of the pen.
/// Empty if there is none.
std::string meant_key(const std::string& word, const std::vector<std::string>& known);

std::string to_toml(double);  // shortest text that reads back to the same value: 0.01, 2.1e11, inf
std::string to_toml(const std::string&);
std::string to_toml(const toml::node&);

struct CaseFile::Document {
  /// One --set K=V.
  struct Set {
    std::string argument, path, value;
  };
  struct Found {
    const toml::node* node = nullptr;
    const toml::key* key = nullptr;  // of the last step, where that is a key
  };

  std::filesystem::path file;
  std::string name;                // the path as the user gave it, or the name given to parse()
  std::string bytes;               // the file's content
  std::vector<std::string> lines;  // without line ends
  toml::table root;
  std::vector<Set> sets;
  bool only_declares = false;
  std::vector<std::string> bodies;        // names of [[structures]], in order
  std::string body;                       // of of_body: the one that stands as [structure]; empty: none
  std::shared_ptr<const Document> whole;  // of of_body: the case with all bodies
  bool explained = true;                  // `strake explain` lists its keys
  std::string preset = "improved";
  bool collects = false;       // in read_all: what is wrong goes to `refused`
  std::vector<Error> refused;  // so far

  std::vector<KeyInfo> keys;  // one per declaration, in order
  std::vector<bool> echoed;   // false: the value would not pass its own checks (it means "not given")
  std::map<std::string, std::size_t> index;  // path → place in `keys`
  std::set<std::string> tables;              // declared tables
  std::set<std::string> accepted;            // tables of a user's program: nothing below is checked

  void read_text();                    // bytes → lines, root
  void apply(const std::string& set);  // one --set string
  void read_preset();
  void read_bodies();  // refuses what is wrong with the list itself
  void find_named(std::vector<PathStep>&, const std::string& where) const;  // a name to its index
  void choose_body(const std::string& name_of_body);
  std::string shown(const std::string& path) const;         // a path as the user knows it
  std::string in_file(const std::string& table) const;      // [structures.plate] of a body
  std::string as_body(const std::string& toml_text) const;  // tables as the user's file has them

  Found find(const std::string& path) const;
  const toml::node* at(const std::string& path) const { return find(path).node; }
  /// The path of `name` in a table. A name that stands in the table as it is wins; else dots separate keys.
  std::string join(const std::string& table, const std::string& name) const;
  /// The --set string that gave this path or a table around it. nullptr if the file gave it, or it is not
  /// given.
  const Set* set_of(const std::string& path) const;
  /// How --set reaches the keys of a table. element: the table, or one of a list.
  std::string set_of_key(const std::string& path, const std::string& element) const;
  std::filesystem::path folder() const;

  /// "case.toml:40:9" of a place, the line with its number and a caret, and both as an error.
  std::string place(const toml::source_position&) const;
  std::string excerpt(const toml::source_position&, const std::string& remark) const;
  std::string where(const std::string& path, const std::string& value = {}) const;
  /// A wrong value. `part` is the place of the element that is wrong, if not the value's own.
  Error wrong(const std::string& path, const std::string& expected, const std::string& fix,
              const toml::node* part = nullptr) const;
  Error missing(const std::string& path, const std::string& expected, const std::string& sample) const;
};

}  // namespace strake
