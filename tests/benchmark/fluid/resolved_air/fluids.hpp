#pragma once

#include <cmath>

// Air and water as barotropic fluids that share one pressure, and the flux between two such mixtures.
namespace resolved_air {

constexpr double ambient_pressure = 101325;  // [Pa]
constexpr double ambient_air = 1.204;        // [kg/m³] of the air at ambient pressure
constexpr double air_exponent = 1.4;         // adiabatic
constexpr double ambient_water = 1000;       // [kg/m³]
constexpr double water_sound = 1500;         // [m/s]
/// Water does not bear less: below it, vapour of no mass fills what air and water leave free.
constexpr double vapour_pressure = 2000;  // [Pa], absolute
/// A phase with less of a cell's volume than this does not leave the cell.
constexpr double trace = 1e-8;

/// Density of the air, ρ = ρ0 (p/p0)^(1/1.4).
inline double air_density(double pressure) {
  return ambient_air * std::pow(pressure / ambient_pressure, 1 / air_exponent);
}

/// Pressure of the air, p = p0 (ρ/ρ0)^1.4.
inline double air_pressure(double density) {
  return ambient_pressure * std::pow(density / ambient_air, air_exponent);
}

/// Density of the water, ρ = 1000 + (p − p0)/c².
inline double water_density(double pressure) {
  return ambient_water + (pressure - ambient_pressure) / (water_sound * water_sound);
}

/// Pressure of the water, p = p0 + c² (ρ − 1000).
inline double water_pressure(double density) {
  return ambient_pressure + water_sound * water_sound * (density - ambient_water);
}

/// Density of the air at a pressure near a known one. A series spares the power where it is exact to 1e-12.
double air_density_near(double pressure, double known_pressure, double known_density);

/// Pressure p of a mixture: m_a/ρ_a(p) + m_w/ρ_w(p) = 1, not below the vapour pressure.
/// m: masses per volume [kg/m³]; guess: any pressure.
double mixture_pressure(double air_mass, double water_mass, double guess);

/// One side of a face. Masses are per volume; the normal velocity is along the axis that crosses the face,
/// the other velocity is that of each fluid along the face.
struct Side {
  double air, water, normal, beside_air, beside_water, pressure, sound;
};

/// What crosses a face per area and time: masses, and the momentum along the face of each fluid. The momentum
/// across it is (air + water) · velocity, and the pressure on top.
struct Flux {
  double air, water, beside_air, beside_water;
  double velocity, pressure;  // of the fluid that crosses, and on the face
  double wave;                // [m/s] the fastest beside the face, against it
};

/// Sound speed c of a mixture, 1/(ρ c²) = Σ α_k/(ρ_k c_k²) (Wood 1930).
double mixture_sound(double air_mass, double water_mass, double pressure, double air_at_pressure);

/// Flux through a face that moves with the velocity w (relaxation solver: Suliciu 1998, Bouchut 2004).
Flux flux_between(const Side& low, const Side& high, double face_velocity);

/// Pressure on a wall that moves with the velocity w. `outward` is +1 where the wall is the cell's high face.
double wall_pressure(const Side& side, double wall_velocity, int outward);

/// Volume fraction at both faces of a cell.
struct Fractions {
  double low, high;
};

/// Volume fraction at the faces of a cell that holds an interface (THINC: Xiao, Honma and Kono 2005).
/// steepness: β of the tangent; rises: whether the fraction grows from the low to the high face.
Fractions sharp_fractions(double fraction, double steepness, bool rises);

}  // namespace resolved_air
