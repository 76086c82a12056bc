#pragma once

#include "coupler/new_case/kinds.hpp"

#include <string>

namespace strake {

/// A TOML number with a point: 5.0, 0.0125, 1.0e-6.
std::string toml_number(double);
/// [x, y, z].
std::string toml_vector(double x, double y, double z = 0);

/// Lines of a case file whose comments stand in one column.
class CaseLines {
 public:
  CaseLines& table(const std::string& head);  // "[fluid]" or "[[output.probe]]", after an empty line
  CaseLines& key(const std::string& name, const std::string& value, const std::string& comment);
  CaseLines& number(const std::string& name, double value, const std::string& comment);
  /// Quotes and backslashes of the value are escaped.
  CaseLines& text(const std::string& name, const std::string& value, const std::string& comment);
  CaseLines& comment(const std::string& words);  // a line of its own
  std::string str() const { return text_; }

 private:
  std::string text_;
};

/// The whole case file. kind: its name, for the head.
std::string case_file_text(const std::string& kind, const NewScene&);

}  // namespace strake
