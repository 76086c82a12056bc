#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace strake {

/// An element of an XML file at its start: name, attributes and place.
struct XmlElement {
  std::filesystem::path file;
  int line = 0, column = 0;  // from 1
  int depth = 0;             // 0: the outermost
  std::string parent;        // name of the element around it
  std::string name;          // "mapping:nearest-neighbor"
  std::map<std::string, std::string> attributes;

  std::string_view kind() const;  // "mapping"
  std::string_view type() const;  // "nearest-neighbor"; empty without a colon
  /// An attribute. Error(case_file) if it is missing.
  std::string text(const std::string& attribute) const;
  std::string text_or(const std::string& attribute, const std::string& otherwise) const;
  /// A flag: yes, true, on or 1; no, false, off or 0; false if it is missing. Error(case_file) for another
  /// word.
  bool flag(const std::string& attribute) const;
  /// Throws Error(case_file) with file:line:column.
  [[noreturn]] void refuse(const std::string& problem, const std::string& fix) const;
};

/// Reads an XML file and calls `open` at the start of each element, in their order. Error(case_file) if it
/// cannot be read or is no XML. Names with colons are taken as they are: preCICE's files declare no
/// namespaces.
///
/// Expat (Debian's libexpat1-dev) parses. It gives line and column of each element, which tinyxml2 (line
/// alone) and pugixml (offset alone) do not, and libcairo2-dev needs it anyway.
void read_xml(const std::filesystem::path&, const std::function<void(const XmlElement&)>& open);

}  // namespace strake
