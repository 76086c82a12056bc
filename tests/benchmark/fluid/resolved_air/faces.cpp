#include "tests/benchmark/fluid/resolved_air/faces.hpp"

#include <algorithm>
#include <cmath>

namespace resolved_air {

namespace {

/// Side of a face between columns: one fluid alone.
Side pure_side(const FaceState& state, bool of_air) {
  return {.air = of_air ? state.filled * state.air_density : 0,
          .water = of_air ? 0 : state.filled * state.water_density,
          .normal = of_air ? state.along_air : state.along_water,
          .beside_air = state.up,
          .beside_water = state.up,
          .pressure = state.pressure,
          .sound = of_air ? std::sqrt(air_exponent * state.pressure / state.air_density) : water_sound};
}

}  // namespace

FaceState face_state(const Cell& cell, double fraction, double pressure) {
  pressure = std::max(pressure, vapour_pressure);
  if (fraction < trace) fraction = 0;
  if (fraction > 1 - trace) fraction = 1;
  return {
      .fraction = fraction,
      .filled = cell.filled,
      .pressure = pressure,
      .air_density = fraction > 0 ? air_density_near(pressure, cell.pressure, cell.air_density) : ambient_air,
      .water_density = water_density(pressure),
      .along_air = cell.along_air,
      .along_water = cell.along_water,
      .up = cell.up};
}

Side mixed_side(const FaceState& state) {
  const double air = state.filled * state.fraction * state.air_density;
  const double water = state.filled * (1 - state.fraction) * state.water_density;
  return {.air = air,
          .water = water,
          .normal = state.up,
          .beside_air = state.along_air,
          .beside_water = state.along_water,
          .pressure = state.pressure,
          .sound = mixture_sound(air, water, state.pressure, state.air_density)};
}

void ColumnFlux::add(double part, const FaceState& low, bool low_is_air, const FaceState& high,
                     bool high_is_air) {
  if (part <= 0) return;
  const Flux flux = flux_between(pure_side(low, low_is_air), pure_side(high, high_is_air), 0);
  carried.air += part * flux.air;
  carried.water += part * flux.water;
  carried.along_air += part * flux.air * flux.velocity;
  carried.along_water += part * flux.water * flux.velocity;
  carried.up += part * (flux.beside_air + flux.beside_water);
  (low_is_air ? low_air : low_water) += part * flux.pressure;
  (high_is_air ? high_air : high_water) += part * flux.pressure;
  wave = std::max(wave, flux.wave);
}

ColumnFlux column_flux(const FaceState& low, const FaceState& high) {
  ColumnFlux flux;
  const double rest = low.fraction - high.fraction;
  flux.add(std::min(low.fraction, high.fraction), low, true, high, true);
  flux.add(1 - std::max(low.fraction, high.fraction), low, false, high, false);
  flux.add(std::abs(rest), low, rest > 0, high, rest < 0);
  return flux;
}

ColumnFlux wall_flux(const FaceState& state, int outward) {
  ColumnFlux flux;
  if (state.fraction > 0) flux.low_air = state.fraction * wall_pressure(pure_side(state, true), 0, outward);
  if (state.fraction < 1)
    flux.low_water = (1 - state.fraction) * wall_pressure(pure_side(state, false), 0, outward);
  flux.high_air = flux.low_air;
  flux.high_water = flux.low_water;
  return flux;
}

}  // namespace resolved_air
