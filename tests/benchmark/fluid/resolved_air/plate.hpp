#pragma once

#include "tests/benchmark/fluid/resolved_air/flow.hpp"

#include <vector>

namespace resolved_air {

/// A rigid flat plate that is driven down at a constant speed onto still water, from rest at once.
struct PlateCase {
  double speed = 6.26;          // [m/s]
  double row = 1e-3;            // [m] height of a cell near plate and water
  double edge_column = 0.5e-3;  // [m] width of the columns at the plate's edge; those inside grow to 8 times
  double gap = 0.012;           // [m] at the start
  double half_width = 0.2;      // [m] of the plate
  double half_tank = 1;         // [m]
  double depth = 0.5;           // [m]
  double air_above = 0.4;       // [m] height of the computed air beside the body, above the plate's face
  Slip slip = Slip::free;
  double after_contact = 0.5e-3;  // [s] time computed after nominal contact
};

/// What a run records at every step. Pressures are gauge pressures.
struct Sample {
  double time;             // [s] after nominal contact, t = gap/V
  double mean_pressure;    // [Pa] over the plate
  double centre_pressure;  // [Pa] on the plate
  double centre_gap;       // [m] thickness of the air under the plate's centre
  double air_left;         // [m] mass of the air under the plate / (ρ0 a)
};

struct PlateRun {
  std::vector<Sample> samples;
  double air_error = 0, water_error = 0;  // of the masses, relative, in- and outflow counted
  double seconds = 0;
  std::size_t cells = 0, steps = 0;
};

/// The grid of a case. The plate's face is a row face that moves with −V, the bottom's is at rest.
Grid plate_grid(const PlateCase& plate);

PlateRun run_plate(const PlateCase& plate);

/// Figures of a run in the order of `figure_names`.
std::vector<double> figures_of(const PlateRun& run, const PlateCase& plate);

struct FigureName {
  const char* name;
  const char* unit;
  double unit_size;
};

/// What the table shows.
const std::vector<FigureName>& figure_names();

/// Prints the figures of self-checks; false where one is beyond its bound.
bool self_checks();

}  // namespace resolved_air
