#pragma once

#include "coupler/import/imported_run.hpp"
#include "coupler/import/xml_tree.hpp"
#include "coupler/precice/config/precice_config.hpp"

namespace strake {

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

}  // namespace strake
