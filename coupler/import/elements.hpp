#pragma once

#include "coupler/import/xml_tree.hpp"

#include <string>
#include <vector>

namespace strake {

/// Looks at every element and at the attributes that change a run. Returns one sentence for each kind of
/// element that is left out, with its first line. Error(case_file) with file:line:column names all elements
/// and attributes that Strake does not have.
std::vector<std::string> check_elements(const XmlTree& configuration);

}  // namespace strake
