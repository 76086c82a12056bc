#pragma once

#include "proto/box.hpp"
#include "proto/case/key_info.hpp"
#include "proto/error.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace strake {

/// Options of one key declaration. Values before the call are the defaults (those of preset "improved");
/// `paper` is the value under preset = "paper". Precedence: default < preset < case file < --set.
struct NumberKey {
  std::string unit = "1";
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool exclusive = false;  // min itself is refused
  bool required = false;
  bool infinite = false;  // inf is accepted, as where the default or the paper's value is inf; NaN never is
  bool conditional = false;  // `required` depends on what else the case gives, so no list says it
  std::optional<double> paper = {};
  std::string help = {};
};
/// A number greater than 0.
inline NumberKey positive(const std::string& unit, const std::string& help) {
  return {.unit = unit, .min = 0, .exclusive = true, .help = help};
}
struct IntegerKey {
  int min = std::numeric_limits<int>::min(), max = std::numeric_limits<int>::max();
  bool required = false;
  std::optional<int> paper = {};
  std::string help = {};
};
struct FlagKey {
  std::optional<bool> paper = {};
  std::string help = {};
};
struct TextKey {
  bool required = false;
  std::optional<std::string> paper = {};
  std::string instead = {};  // the key is an older name of this key of the table
  bool path = false;         // below the case file's folder unless absolute; it need not exist yet
  std::string help = {};
};
struct ChoiceKey {
  bool required = false;
  bool or_path = false;  // a value with '/' is accepted: a program of the user's
  std::optional<std::string> paper = {};
  std::vector<std::string> not_built = {};  // choices of the design that are refused by name, "not built yet"
  std::string help = {};
};
struct VectorKey {
  std::string unit = "1";
  bool required = false;
  bool conditional = false;              // `required` depends on other tables, so no list says it
  std::vector<std::string> unless = {};  // keys of the table of which any one stands in for a required key
  std::string help = {};
};
struct PointsKey {
  std::string unit = "1";
  std::size_t at_least = 3;
  bool required = false;
  std::string help = {};
};

class CaseTable;

/// A case file with positions. Reading a key declares it; `refuse_unknown` then lists every undeclared key.
class CaseFile {
 public:
  /// Reads FILE and applies the --set strings in order (V is read as TOML, else as text). Throws
  /// Error(case_file).
  static CaseFile load(const std::filesystem::path& file, const std::vector<std::string>& sets = {});
  /// A case from text, for tests; `name` stands where the path would in messages.
  static CaseFile parse(const std::string& text, const std::string& name = "case.toml",
                        const std::vector<std::string>& sets = {});
  /// No file: every declaration is recorded, nothing is required, an array of tables has one empty element.
  static CaseFile declarations_only();

  CaseTable root();
  /// The file is no case (a study): its messages do not point to `strake explain`.
  void not_a_case();
  /// Reads by `read` and throws one Error(case_file) with everything that it refuses. A wrong or missing
  /// number, flag, vector, box or text is remembered and the reading goes on. What decides how to read on
  /// ends it: a choice. A check across keys counts only where all keys are right.
  void read_all(const std::function<void()>& read);
  bool is_right() const;  // nothing that has been read so far is refused
  /// Error for every key below `prefix` ("fluid"; empty: the whole file) that no declaration has touched,
  /// with did-you-mean. Call after all reading.
  void refuse_unknown(const std::string& prefix = {}) const;
  const std::vector<KeyInfo>& declared() const;
  /// Resolved TOML of the declared keys below `prefix`, each marked with its origin.
  std::string echo(const std::string& prefix = {}) const;
  /// A top table as TOML, as the user gave it, with the changes of --set. For programs whose keys Strake does
  /// not declare. `solver` replaces its key of that name. Paths that Strake knows become absolute.
  std::string as_given(const std::string& table, const std::string& solver) const;
  /// SHA-256 of the file's bytes, each --set string, and the bytes of every existing file that a text value
  /// names.
  std::array<std::uint8_t, 32> hash() const;
  std::filesystem::path path() const;
  std::filesystem::path folder() const;  // relative paths in the case are relative to it
  const std::string& preset() const;     // "paper" | "improved"
  /// The finite numbers that stand at a key ("fluid.spacing", one; "fluid.water", its coordinates in order);
  /// empty if it is not given. Declares nothing, so a default may depend on keys that are read later.
  std::vector<double> numbers_at(const std::string& path) const;
  /// The text that stands at a key; empty if there is none. Declares nothing.
  std::string text_at(const std::string& path) const;
  bool has(const std::string& path) const;      // given in the file or by --set
  bool is_true(const std::string& path) const;  // given as true
  /// The names of [[structures]], several bodies in one water; empty for one [structure].
  const std::vector<std::string>& bodies() const;
  /// The case as that body's own program reads it: its [[structures]] stands as [structure]. Hash and preset
  /// are those of the whole case. Throws Error(command_line) if there is none of that name.
  CaseFile of_body(const std::string& name) const;
  const std::string& body() const;  // of `of_body`: the name; empty otherwise
  /// True for `declarations_only`: checks across keys have nothing to check.
  bool only_declares() const;

  struct Document;

 private:
  explicit CaseFile(std::shared_ptr<Document>);
  std::shared_ptr<Document> document_;
};

/// A view of one table. Each call declares one key: reads it, checks it, records it. A second declaration of
/// a key reads and checks it again and records nothing. A name that stands in the table is taken as it is
/// ("structure.solver" in quotes); otherwise dots lead into sub-tables.
class CaseTable {
 public:
  void number(const std::string& name, double& value, const NumberKey&);
  void integer(const std::string& name, int& value, const IntegerKey&);
  void flag(const std::string& name, bool& value, const FlagKey&);
  void text(const std::string& name, std::string& value, const TextKey&);
  /// A file that must exist and be readable; stored absolute.
  void file(const std::string& name, std::filesystem::path& value, const TextKey&);
  /// A folder that must exist (an earlier run); stored absolute.
  void folder(const std::string& name, std::filesystem::path& value, const TextKey&);
  void choice(const std::string& name, std::string& value, const std::vector<std::string>& choices,
              const ChoiceKey&);
  /// Choice straight into an enumerator.
  template <class Enum>
  void choice(const std::string& name, Enum& value, const std::vector<std::pair<std::string, Enum>>& choices,
              const ChoiceKey& key) {
    std::vector<std::string> names;
    std::string text;
    for (const auto& [n, e] : choices) {
      names.push_back(n);
      if (e == value) text = n;
    }
    choice(name, text, names, key);
    for (const auto& [n, e] : choices)
      if (n == text) value = e;
  }
  void vector(const std::string& name, Eigen::Vector3d& value, const VectorKey&);  // [x, y, z] or [x, y]
  void box(const std::string& name, Box& value, const VectorKey&);  // [[…], […]], min < max
  /// A list of points, [[x, y], …] or [[x, y, z], …]; empty if the key is not given.
  void points(const std::string& name, std::vector<Eigen::Vector3d>& value, const PointsKey&);
  /// A list of texts, or one text.
  void texts(const std::string& name, std::vector<std::string>& value, const TextKey&);
  /// Reads a text, number or flag, or a list of them, each written as KeyInfo::value is. So `when` of a
  /// compare block can be compared with any declared key. Empty if the key is not given.
  std::vector<std::string> scalars_as_text(const std::string& name, const std::string& help = {});
  /// A key of the design that is not built yet: refused by name, with that reason.
  void not_built(const std::string& name, const std::string& help);

  CaseTable table(const std::string& name, const std::string& help = {});  // empty view if absent
  std::vector<CaseTable> tables(const std::string& name, const std::string& help = {});  // [[name]]
  /// Tables that the case may have below this one. A misspelt name is compared with them.
  void knows(const std::vector<std::string>& names);
  /// Every key below this table is accepted unread (a user's own program).
  void accept_all();
  std::vector<std::string> keys() const;  // as they stand in the file, without declaring them

  bool has(const std::string& name) const;  // given in the file or by --set
  bool present() const;                     // the table itself is; true where the file only declares
  /// "case.toml:40:9: structure.material.young = 0", for Error::where of a check across keys.
  std::string where(const std::string& name) const;
  /// The error that a wrong value of `name` deserves, with line and caret. expected: "a number in Pa, …".
  Error error(const std::string& name, const std::string& expected, const std::string& fix = {}) const;

 private:
  friend class CaseFile;
  CaseTable(std::shared_ptr<CaseFile::Document>, std::string path);
  std::shared_ptr<CaseFile::Document> document_;
  std::string path_;
};

}  // namespace strake
