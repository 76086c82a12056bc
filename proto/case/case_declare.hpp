#pragma once
// Private to the case_*.cpp files: what every declaration of a key does.

#include "proto/case/case_document.hpp"

#include <string>

namespace strake {

/// One declaration while it is read: finds the value, words the errors, is recorded once.
class Declaration {
 public:
  Declaration(CaseFile::Document&, const std::string& table, const std::string& name, KeyInfo description);

  std::string name() const;  // last part of the path, as it stands in the file
  /// The characters of a --set value that TOML took for something else than text, else empty.
  std::string raw_text() const;
  Error wrong(const std::string& what, const std::string& fix = {}, const toml::node* part = nullptr) const;
  /// True if there is a value; throws if there is none and one is needed. sample: the line that the fix
  /// proposes.
  bool given(bool required, const std::string& sample) const;
  /// Takes the value by `read`. Where a file is read to its end, an error is remembered and the reading goes
  /// on with the default, or with any value of the range.
  template <class Read>
  void take(const Read& read) {
    take(false, read);
  }
  /// The same for a key that decides how to read on, a choice: the reading ends.
  template <class Read>
  void take_or_end(const Read& read) {
    take(true, read);
  }
  /// Whether `take` has remembered an error.
  bool refused() const { return refused_; }
  /// True if the value shall come from preset "paper".
  bool takes_paper(bool has_paper);
  /// echoed = false: the value would not pass its own checks; it means "not given".
  void record(std::string value, bool echoed = true);

  KeyInfo info;
  const toml::node* node = nullptr;  // the value, if it is given
  const CaseFile::Document::Set* set = nullptr;
  std::string expected;        // "a number in Pa, greater than 0"
  bool default_passes = true;  // the default may be offered as a fix

 private:
  template <class Read>
  void take(bool decides, const Read& read) {
    if (!document_.collects) return read();
    try {
      read();
    } catch (const Error& error) {
      document_.refused.push_back(error);
      refused_ = true;
      if (decides) throw;
    }
  }

  CaseFile::Document& document_;
  bool refused_ = false;
};

}  // namespace strake
