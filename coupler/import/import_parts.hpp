#pragma once

#include "coupler/import/imported_run.hpp"
#include "coupler/precice/config/precice_config.hpp"
#include "coupler/precice/config/xml_elements.hpp"

#include <functional>
#include <string>
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

/// A configuration twice: as names that are known to be defined, and as elements with their places.
struct Configuration {
  PreciceConfig config;
  XmlTree tree;
  const XmlTree& scheme() const { return *tree.first("coupling-scheme"); }
};

/// Where a setting comes from: "line 30".
std::string place_of(const XmlElement&);

/// The mesh that a participant writes or reads data on; its first one where the list does not name the data.
std::string mesh_of(const std::vector<PreciceConfig::MeshData>& list, const std::string& data,
                    const ImportedSide&);

/// The parts of an imported run, in the order in which they are read. Each throws Error(case_file) with
/// file:line:column for what Strake does not have, and may add to `notes`.
void import_sides(const Configuration&, ImportedRun&);
void import_mapping(const Configuration&, ImportedRun&);
void import_scheme(const Configuration&, ImportedRun&);
void import_measures(const Configuration&, ImportedRun&);
void import_acceleration(const Configuration&, ImportedRun&);

/// Looks at every element and at the attributes that change a run. Returns one sentence for each kind of
/// element that is left out, with its first line. Error(case_file) with file:line:column names all elements
/// and attributes that Strake does not have.
std::vector<std::string> check_elements(const XmlTree& configuration);

}  // namespace strake
