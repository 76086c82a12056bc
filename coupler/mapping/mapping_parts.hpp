#pragma once

#include "coupler/mapping/mapping.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <string>
#include <vector>

/// What the mappings share.
namespace strake::mapping_parts {

// A weight or an overhang below this part of a face is round-off of the positions.
constexpr double round_off = 1e-12;

/// "coupling, mapping from the structure to the fluid".
std::string title(const InterfaceMesh& structure, const InterfaceMesh& fluid);
/// Throws Error(case_file) unless both have points, all finite, in the same dimension.
void check_meshes(const InterfaceMesh& structure, const InterfaceMesh& fluid);
/// Throws Error(case_file) when the farthest fluid point is beyond the limit [m].
void check_distance(const MappingQuality&, double limit, const InterfaceMesh& structure,
                    const InterfaceMesh& fluid);
/// Keeps the farthest fluid point.
void note_distance(MappingQuality&, Eigen::Index fluid_point, double distance);
Mapping build(Eigen::Index n_fluid, Eigen::Index n_structure,
              const std::vector<Eigen::Triplet<double>>& entries, MappingQuality);

}  // namespace strake::mapping_parts
