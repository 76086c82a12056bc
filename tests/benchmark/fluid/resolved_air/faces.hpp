#pragma once

#include "tests/benchmark/fluid/resolved_air/fluids.hpp"

// The faces of a cell: what stands at them, and what crosses them.
namespace resolved_air {

/// Content of a cell: masses [kg/m] and momenta [kg/s], per metre across the plane. Each fluid has its own
/// momentum along x, both share that up.
struct Content {
  double air = 0, water = 0, along_air = 0, along_water = 0, up = 0;
};

/// Pointwise values of a cell.
struct Cell {
  double fraction = 0;  // of the air in what air and water fill
  double filled = 1;    // by air and water; the rest is vapour
  double along_air = 0, along_water = 0, up = 0;
  double pressure = ambient_pressure, air_density = ambient_air;
  double steep_along = 0, steep_up = 0;  // β of the interface along both axes; 0: no interface
};

/// Values of a cell at one of its faces; densities are those of the fluids alone.
struct FaceState {
  double fraction, filled, pressure, air_density, water_density, along_air, along_water, up;
};

/// What crosses a face between columns, per height; the pressures push the fluids of the cell at either side.
struct ColumnFlux {
  Content carried;
  double low_air = 0, low_water = 0, high_air = 0, high_water = 0;  // ∫ p over each fluid's part of the face
  double wave = 0;

  /// Adds a part of the face, over which one fluid meets one fluid.
  void add(double part, const FaceState& low, bool low_is_air, const FaceState& high, bool high_is_air);
};

/// What is at a face, of a cell's values there.
FaceState face_state(const Cell& cell, double fraction, double pressure);

/// Side of a face between rows: the mixture.
Side mixed_side(const FaceState& state);

/// Flux between columns (discrete equations: Abgrall and Saurel 2003). Air meets air and water meets water
/// over the parts that both sides have in common; unlike fluids meet over the rest.
ColumnFlux column_flux(const FaceState& low, const FaceState& high);

/// The same at a wall at rest; `outward` is +1 where the wall is the cell's high face.
ColumnFlux wall_flux(const FaceState& state, int outward);

}  // namespace resolved_air
