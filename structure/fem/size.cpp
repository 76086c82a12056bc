#include "structure/fem/fem.hpp"
#include "structure/fem/mesh/refinement.hpp"

#include <algorithm>
#include <cmath>

namespace strake::structure::fem {
namespace {

/// Bytes and seconds of an unknown, its cells, matrix and factors together, which grow faster than their
/// number. Measured as peak memory and time of --check on the plate of cases/plate_entry.toml, 28 000 and 273
/// 000 unknowns in the plane, 12 000 to 52 000 in space. From 250 000 on in space there are no factors. With
/// conjugate gradients in the plane, --check of a slender body (cases/rolling_tank.toml) takes 3.1 s for 2
/// 368 unknowns, of the other cases a third of that each.
void set_costs(SizeEstimate& unknowns, int dim, LinearMethod method) {
  constexpr double iterative = 250000, iterative_bytes = 17000;
  const double n = std::max(unknowns.count, 1.0);
  unknowns.bytes_each =
      dim == 2 ? 3000 * std::pow(n / 28000, 0.16) : 13000 * std::pow(std::min(n, iterative) / 12000, 0.3);
  unknowns.seconds_each = dim == 2 ? 1.5e-5 : 1.5e-4 * std::pow(n / 12000, 0.2);
  if (method != LinearMethod::cg_amg) return;
  if (dim == 2) unknowns.seconds_each = 1.3e-3;
  if (dim == 3) unknowns.bytes_each = iterative_bytes;
}

}  // namespace

SizeEstimates sizes(const Parameters& p) {
  const Solid solid = elastic_solid(p);
  const double cells = refined_count(solid, p.fem.refinement, size_along(p.fem, solid));
  SizeEstimate elements{.what = "cells", .count = cells};
  const double layers = p.fem.strain == StrainField::solid_shell ? 2 : 1;  // of nodes to one of cells
  SizeEstimate unknowns{.what = "unknowns",
                        .count = p.dimension * layers * cells * std::pow(p.fem.degree, p.dimension)};
  const LinearMethod asked = p.fem.linear_solver;
  set_costs(unknowns, p.dimension,
            p.ranks > 1 && asked != LinearMethod::direct ? LinearMethod::cg_amg : asked);
  if (p.shape.kind == ShapeKind::plate)
    elements.keys = {{"structure.plate.length", p.plate.length, 1},
                     {"structure.plate.thickness", p.plate.thickness, p.dimension == 2 ? -1.0 : -2.0}};
  else if (solid.made_of_boxes())
    elements.keys = {{"structure.box", 0, 1}};
  else
    elements.keys = {{"structure.mesh", 0, 1}};
  elements.remedy = !solid.made_of_boxes() ? "a coarser mesh"
                    : p.fem.cell_size > 0  ? "a larger structure.fem.cell_size"
                    : p.fem.refinement > 0 ? "a smaller structure.fem.refinement"
                                           : "structure.fem.degree = 1";
  unknowns.keys = elements.keys;
  unknowns.remedy = elements.remedy;
  return {elements, unknowns, surface_size(p, cells)};
}

}  // namespace strake::structure::fem
