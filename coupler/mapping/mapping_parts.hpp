#pragma once

#include "coupler/mapping/mapping.hpp"
#include "proto/interface.hpp"

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

namespace strake {

/// The area that belongs to each point of a mesh [m, m²]. A face's length (2-D, per metre of depth) or area
/// is divided evenly among its corners. Zero for a point without faces.
Eigen::VectorXd point_areas(const InterfaceMesh&);

/// The area that belongs to points without faces that lie on a surface. It is the part of the surface nearer
/// to the point than to any other, to within a `fineness`-th of its faces.
Eigen::VectorXd nearest_areas(const Points&, const InterfaceMesh& surface, int fineness = 8);

/// Changes each component (row) of `value` until its sum is the wanted one.
void match_sums(Eigen::Ref<Eigen::MatrixXd> value, const Eigen::VectorXd& wanted);

/// Corrects a field per area (pressure, traction) after mapping, so that Σ_i A_i v_i = wanted. wanted: the
/// integral over the source mesh.
void match_integral(Eigen::Ref<Eigen::MatrixXd> value, const Eigen::VectorXd& area,
                    const Eigen::VectorXd& wanted);

}  // namespace strake
