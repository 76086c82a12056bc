#pragma once

#include "fluid/particles/state.hpp"

#include <cstdint>
#include <functional>
#include <optional>

namespace strake::fluid {

/// Returns the volume of the water from its particles' positions [m² in 2-D, m³ in 3-D]. It is the
/// morphological closing: balls of 1.25 l0 around the particles are united, and a margin of 0.75 l0 inside
/// their surface is removed. A lattice then fills its box to the faces l0/2 outside its particles. Cracks
/// between particles count as water. A hole that a circle of 1.25 l0 fits into does not. Computed on cells of
/// l0/4.
///
/// Measured: the box of a lattice is exact where it is aligned with the cells. For 40 × 20 particles turned
/// by any angle the error is 0.1 % (standard deviation 0.3 %), with the particles scattered by ±0.2 l0
/// −0.4 %. A single layer is 2 % too thick.
template <int dim>
double water_volume(const Vectors<dim>& particles, double spacing);

/// The same of one part of the water. Particles around it, to 2 l0, must be there. The parts of all ranks add
/// up to the volume of the whole, to the last bit.
template <int dim>
struct VolumePart {
  Vector<dim> low = Vector<dim>::Zero();  // lowest place of the whole along each axis [m]
  /// Whether all places between two along x belong to the part, or none does. Nothing: shorter stretches are
  /// asked for; one place has an answer. Null: all belong to it.
  std::function<std::optional<bool>(const Vector<dim>& first, const Vector<dim>& last)> counts = nullptr;
};
/// Returns the number of cells that are water; −1 where they are too many.
template <int dim>
std::int64_t water_cells(const Vectors<dim>& particles, double spacing, const VolumePart<dim>&);
/// Returns the volume of so many cells.
template <int dim>
double volume_of_cells(std::int64_t cells, double spacing);

}  // namespace strake::fluid
