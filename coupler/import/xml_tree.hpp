#pragma once

#include "coupler/precice/config/xml_elements.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace strake {

/// An element of an XML file with the elements inside it.
struct XmlTree {
  XmlElement element;
  std::vector<XmlTree> inner;

  /// The elements directly inside whose kind is `kind` ("mapping" of "mapping:rbf"), in their order.
  std::vector<const XmlTree*> all(std::string_view kind) const;
  /// The first of them; nullptr if there is none.
  const XmlTree* first(std::string_view kind) const;
};

/// Reads a whole file. Error(case_file) as read_xml.
XmlTree read_xml_tree(const std::filesystem::path&);

/// Visits the elements inside `tree` from the top; those inside an element follow if `visit` returns true.
void walk(const XmlTree& tree, const std::function<bool(const XmlTree&)>& visit);

/// An attribute as a finite number in [min, max]. Error(case_file) with its place for anything else.
double number_of(const XmlElement&, const std::string& attribute, double min, double max);
int integer_of(const XmlElement&, const std::string& attribute, int min, int max);

}  // namespace strake
