#include "coupler/mapping/mapping.hpp"

#include "coupler/mapping/mapping_parts.hpp"
#include "coupler/mapping/point_tree.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace strake {

using Eigen::Index;
using Eigen::Vector3d;

namespace mapping_parts {

std::string title(const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  return fmt::format("coupling, mapping from {} to {}",
                     structure.name.empty() ? "the structure" : structure.name,
                     fluid.name.empty() ? "the fluid" : fluid.name);
}

void check_meshes(const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  const std::string where = title(structure, fluid);
  if (structure.position.cols() == 0)
    throw Error(ExitCode::case_file, where, "the structure's interface has no points",
                "give the structure a surface that the fluid can wet, or coupling.surface away");
  if (fluid.position.cols() == 0 && structure.faces.cols() == 0 && structure.mass.size() == 0)
    throw Error(ExitCode::case_file, where,
                "the structure's interface has points but no faces: the fluid finds no surface to wet",
                "let the structure give its faces (segments in 2-D, triangles in 3-D, counter-clockwise seen "
                "from outside), or name a mesh of its surface: structure.surface = \"FILE.msh\"");
  if (fluid.position.cols() == 0)
    throw Error(ExitCode::case_file, where, "the fluid's interface has no points",
                "is the structure inside the tank?");
  if (structure.dimension != fluid.dimension)
    throw Error(ExitCode::case_file, where,
                fmt::format("the structure is {}-dimensional, the fluid {}-dimensional", structure.dimension,
                            fluid.dimension),
                "give both solvers the same dimension");
  for (const auto* mesh : {&structure, &fluid})
    for (Index i = 0; i < mesh->position.cols(); ++i)
      if (!mesh->position.col(i).allFinite())
        throw Error(ExitCode::case_file, where,
                    fmt::format("point {} of the {}'s interface has a position that is not finite", i,
                                mesh == &structure ? "structure" : "fluid"));
}

void check_distance(const MappingQuality& quality, double limit, const InterfaceMesh& structure,
                    const InterfaceMesh& fluid) {
  if (!(quality.largest_distance > limit)) return;
  const Vector3d p = fluid.position.col(quality.farthest);
  throw Error(
      ExitCode::case_file, title(structure, fluid),
      fmt::format("fluid point {} at ({:g}, {:g}, {:g}) m lies {:g} m from the structure's surface, at most "
                  "{:g} m is allowed",
                  quality.farthest, p.x(), p.y(), p.z(), quality.largest_distance, limit),
      "let both solvers take the shape from the same case file");
}

void note_distance(MappingQuality& quality, Index fluid_point, double distance) {
  if (quality.farthest >= 0 && distance <= quality.largest_distance) return;
  quality.largest_distance = distance;
  quality.farthest = fluid_point;
}

Mapping build(Index n_fluid, Index n_structure, const std::vector<Eigen::Triplet<double>>& entries,
              MappingQuality quality) {
  Mapping::Matrix weights(n_fluid, n_structure);
  weights.setFromTriplets(entries.begin(), entries.end());
  return Mapping(std::move(weights), quality);
}

}  // namespace mapping_parts

namespace {

using namespace mapping_parts;

/// As `from`, on other points.
Field carried(const Field& from, Values value) {
  return {from.quantity, from.unit, from.conservative, std::move(value)};
}

Mapping plain_mapping(const MappingParameters& p, const InterfaceMesh& structure,
                      const InterfaceMesh& fluid) {
  if (p.kind == "nearest-neighbour") return nearest_neighbour(structure, fluid, p.limit);
  if (p.kind == "nearest-projection") return nearest_projection(structure, fluid, p.limit);
  if (p.kind == "linear-cell") return linear_cell(structure, fluid, p.limit);
  if (p.kind == "radial-basis") return radial_basis(structure, fluid, p.radial_basis, p.limit);
  if (p.kind == "identity") return identity(structure, fluid);
  throw Error(ExitCode::case_file, "coupling.surface.mapping.kind",
              fmt::format("\"{}\" is not a mapping", p.kind),
              "nearest-projection, nearest-neighbour, linear-cell or radial-basis");
}

/// Computes f_s = A_s V A_f⁻¹ f_f. V interpolates the force per area from the fluid's points to the
/// structure's points, where it is multiplied by their areas.
Mapping::Matrix force_by_area(Mapping::Matrix to_structure, const Eigen::VectorXd& of_structure,
                              const Eigen::VectorXd& of_fluid) {
  for (Index i = 0; i < to_structure.rows(); ++i)
    for (Mapping::Matrix::InnerIterator v(to_structure, i); v; ++v)
      v.valueRef() *= of_structure[i] / of_fluid[v.col()];
  return to_structure;
}

/// Areas by the mesh's own faces, else by the other's.
Eigen::VectorXd areas_of(const InterfaceMesh& mesh, const InterfaceMesh& other) {
  return mesh.faces.cols() > 0 ? point_areas(mesh) : nearest_areas(mesh.position, other);
}

/// Throws Error(case_file) where a point of the mesh has no area to take its force per.
void check_areas(const Eigen::VectorXd& area, const char* side, const InterfaceMesh& structure,
                 const InterfaceMesh& fluid) {
  const char* fix = "coupling.surface.mapping.constraint = \"conservative\"";
  for (Index i = 0; i < area.size(); ++i)
    if (!(area[i] > 0))
      throw Error(ExitCode::case_file, title(structure, fluid),
                  fmt::format("point {} of the {}'s interface stands for no part of a face: it has no area, "
                              "which a force per area needs",
                              i, side),
                  fix);
}

}  // namespace

std::vector<std::string> quality_lines(const MappingQuality& quality, const Points& mapped_to, bool back) {
  const std::string to = back ? "structure" : "fluid", from = back ? "fluid" : "structure";
  std::vector<std::string> lines;
  std::string far = fmt::format("largest distance {:.2g} m", quality.largest_distance);
  if (quality.farthest >= 0)
    far += fmt::format(", {} point {} at ({:.4g}, {:.4g}, {:.4g}) m", to, quality.farthest,
                       mapped_to(0, quality.farthest), mapped_to(1, quality.farthest),
                       mapped_to(2, quality.farthest));
  lines.push_back(far);
  lines.push_back(fmt::format("{} of {} {} points are not covered by the {}'s surface", quality.outside,
                              quality.n_fluid, to, from));
  lines.push_back(fmt::format("{} of {} {} points {}", quality.without_load, quality.n_structure, from,
                              back ? "are not used" : "feel no load"));
  lines.push_back(fmt::format("rows sum to 1 within {:.1e}, {:.3g} {} points behind a {} point",
                              quality.row_sum_error, quality.row_size, from, to));
  if (quality.patches > 0)
    lines.push_back(fmt::format("condition {:.1e}, the worst of {} system{} of {:.0f} points",
                                quality.condition, quality.patches, quality.patches == 1 ? "" : "s",
                                quality.patch_points));
  return lines;
}

Mapping::Mapping(Matrix&& weights, MappingQuality quality)
    : weights_(std::move(weights)), transpose_(weights_.transposed()), quality_(quality) {
  const Matrix& matrix = weights_.matrix();
  quality_.n_fluid = matrix.rows();
  quality_.n_structure = matrix.cols();
  quality_.row_sum_error = 0;
  for (Index i = 0; i < matrix.rows(); ++i) {
    double sum = 0;
    for (Matrix::InnerIterator w(matrix, i); w; ++w) sum += w.value();
    quality_.row_sum_error = std::max(quality_.row_sum_error, std::abs(sum - 1));
  }
  quality_.row_size =
      static_cast<double>(matrix.nonZeros()) / std::max(1.0, static_cast<double>(matrix.rows()));
  quality_.without_load = transpose_.empty_rows();
}

// u_f = W u_s
Field Mapping::consistent(const Field& on_structure) const {
  return carried(on_structure, weights_ * on_structure.value);
}

// f_s = Wᵀ f_f, hence f_s·u_s = f_f·W u_s = f_f·u_f
Field Mapping::conservative(const Field& on_fluid) const {
  return carried(on_fluid, transpose_ * on_fluid.value);
}

Field Mapping::force(const Field& on_fluid) const {
  if (!force_weights_) return conservative(on_fluid);
  Field on_structure = carried(on_fluid, force_weights_ * on_fluid.value);
  if (scaled_) match_sums(on_structure.value.edit(), on_fluid.value.rowwise().sum());
  return on_structure;
}

Field Mapping::per_area(const Field& on_structure) const {
  Field on_fluid = consistent(on_structure);
  if (area_of_fluid_.size() > 0)
    match_integral(on_fluid.value.edit(), area_of_fluid_, on_structure.value * area_of_structure_);
  return on_fluid;
}

void Mapping::set_areas(Eigen::VectorXd of_structure, Eigen::VectorXd of_fluid) {
  assert(of_structure.size() == this->weights().cols() && of_fluid.size() == this->weights().rows());
  area_of_structure_ = std::move(of_structure);
  area_of_fluid_ = std::move(of_fluid);
}

void Mapping::set_force(Matrix&& weights, bool scaled) {
  assert(weights.rows() == this->weights().cols() && weights.cols() == this->weights().rows());
  force_weights_ = SparseOperator(std::move(weights));
  scaled_ = scaled;
  quality_.without_load = force_weights_.empty_rows();
}

Mapping Mapping::embedded(const SparseOperator::Place& of_fluid,
                          const SparseOperator::Place& of_structure) const {
  Mapping whole = *this;
  whole.weights_ = weights_.embedded(of_fluid, of_structure);
  whole.transpose_ = transpose_.embedded(of_structure, of_fluid);
  if (force_weights_) whole.force_weights_ = force_weights_.embedded(of_structure, of_fluid);
  const auto placed = [](const Eigen::VectorXd& area, const SparseOperator::Place& place) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(place.size);
    all.segment(place.first, area.size()) = area;
    return all;
  };
  if (area_of_structure_.size() > 0) whole.area_of_structure_ = placed(area_of_structure_, of_structure);
  if (area_of_fluid_.size() > 0) whole.area_of_fluid_ = placed(area_of_fluid_, of_fluid);
  if (quality_.farthest >= 0) whole.quality_.farthest = quality_.farthest + of_fluid.first;
  return whole;
}

Mapping nearest_neighbour(const InterfaceMesh& structure, const InterfaceMesh& fluid, double limit) {
  check_meshes(structure, fluid);
  const PointTree tree(structure.position);
  const Index n = fluid.position.cols();
  Mapping::Matrix weights(n, structure.position.cols());
  weights.resizeNonZeros(n);
  MappingQuality quality;
  for (Index i = 0; i < n; ++i) {
    const Vector3d p = fluid.position.col(i);
    // Equally near points: the first, whatever order the tree has.
    const Index nearest = tree.nearest(p, round_off);
    weights.outerIndexPtr()[i + 1] = static_cast<int>(i + 1);
    weights.innerIndexPtr()[i] = static_cast<int>(nearest);
    weights.valuePtr()[i] = 1;
    note_distance(quality, i, (structure.position.col(nearest) - p).norm());
  }
  check_distance(quality, limit, structure, fluid);
  return Mapping(std::move(weights), quality);
}

Mapping identity(const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  check_meshes(structure, fluid);
  const Index n = structure.position.cols();
  if (fluid.position.cols() != n)
    throw Error(
        ExitCode::case_file, title(structure, fluid),
        fmt::format("the structure has {} points, the fluid {}: the identity needs the same points", n,
                    fluid.position.cols()),
        "coupling.interface = \"volume\" needs structure.solver = \"particle\" and fluid.solver = \"mps\"");
  MappingQuality quality;
  for (Index i = 0; i < n; ++i)
    note_distance(quality, i, (fluid.position.col(i) - structure.position.col(i)).norm());
  const double size =
      (structure.position.rowwise().maxCoeff() - structure.position.rowwise().minCoeff()).norm();
  check_distance(quality, round_off * (size + structure.position.cwiseAbs().maxCoeff()), structure, fluid);
  Mapping::Matrix weights(n, n);
  weights.setIdentity();
  return Mapping(std::move(weights), quality);
}

Mapping make_mapping(const MappingParameters& p, const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  Mapping mapping = plain_mapping(p, structure, fluid);
  if (p.constraint == "conservative" || p.kind == "identity") return mapping;
  if (p.constraint != "consistent" && p.constraint != "scaled-consistent")
    throw Error(ExitCode::case_file, "coupling.surface.mapping.constraint",
                fmt::format("\"{}\" is not a constraint", p.constraint),
                "conservative, consistent or scaled-consistent");
  const Eigen::VectorXd of_structure = areas_of(structure, fluid), of_fluid = areas_of(fluid, structure);
  check_areas(of_structure, "structure", structure, fluid);
  check_areas(of_fluid, "fluid", structure, fluid);
  // Every structure point takes its load from the fluid, however far that ends before the structure does.
  MappingParameters back = p;
  back.limit = std::numeric_limits<double>::infinity();
  const bool scaled = p.constraint == "scaled-consistent";
  mapping.set_force(force_by_area(plain_mapping(back, fluid, structure).weights(), of_structure, of_fluid),
                    scaled);
  if (scaled) mapping.set_areas(of_structure, of_fluid);
  return mapping;
}

}  // namespace strake
