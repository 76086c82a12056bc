#include "tests/benchmark/fluid/resolved_air/fluids.hpp"

#include <algorithm>

namespace resolved_air {

double air_density_near(double pressure, double known_pressure, double known_density) {
  // ρ = ρ_k (1 + x)^n with n = 1/1.4 and x = p/p_k − 1, as a binomial series up to x⁵.
  constexpr double n = 1 / air_exponent;
  constexpr double c2 = n * (n - 1) / 2, c3 = c2 * (n - 2) / 3, c4 = c3 * (n - 3) / 4, c5 = c4 * (n - 4) / 5;
  const double x = pressure / known_pressure - 1;
  if (std::abs(x) > 0.01) return air_density(pressure);
  return known_density * (1 + x * (n + x * (c2 + x * (c3 + x * (c4 + x * c5)))));
}

double mixture_pressure(double air_mass, double water_mass, double guess) {
  if (air_mass <= 0) return std::max(water_pressure(water_mass), vapour_pressure);
  if (water_mass <= 0) return std::max(air_pressure(air_mass), vapour_pressure);
  // f(p) = m_a/ρ_a + m_w/ρ_w − 1 falls and is convex, so Newton's steps rise to the root after the first.
  double p = std::max(guess, vapour_pressure);
  for (int i = 0; i < 60; ++i) {
    const double water = water_density(p);
    const double air_volume = air_mass / air_density(p), water_volume = water_mass / water;
    // f' = −m_a/(1.4 p ρ_a) − m_w/(c² ρ_w²).
    const double slope = air_volume / (air_exponent * p) + water_volume / (water * water_sound * water_sound);
    const double change = (air_volume + water_volume - 1) / slope;
    const double next = std::max(p + change, vapour_pressure);
    const double moved = std::abs(next - p);
    p = next;
    if (moved <= 1e-12 * p) break;
  }
  return p;
}

double mixture_sound(double air_mass, double water_mass, double pressure, double air_at_pressure) {
  const double of_air = air_exponent * pressure / air_at_pressure;  // c² of the air
  if (water_mass <= 0) return std::sqrt(of_air);
  if (air_mass <= 0) return water_sound;
  const double water = water_density(pressure);
  const double air_fraction = air_mass / air_at_pressure, water_fraction = water_mass / water;
  const double filled = air_fraction + water_fraction;
  const double compressibility =
      air_fraction / (air_at_pressure * of_air) + water_fraction / (water * water_sound * water_sound);
  return std::sqrt(filled * filled / ((air_mass + water_mass) * compressibility));
}

namespace {

/// Speed of the acoustic wave of one side against its fluid, kept above what a compression needs (Bouchut
/// 2004): s = c + (1.4 + 1)/2 · max(0, (p_o − p)/Z_o + u − u_o), where o is the other side, Z its impedance.
double wave_speed(double sound, double jump) {
  constexpr double stiffening = (air_exponent + 1) / 2;
  return sound + stiffening * std::max(0.0, jump);
}

/// Flux of one side's content when its density has changed by a ratio: m (u − w).
Flux carried(const Side& side, double ratio, double velocity, double pressure, double face_velocity,
             double wave) {
  const double through = ratio * (velocity - face_velocity);
  const double air = side.air * through, water = side.water * through;
  return {.air = air,
          .water = water,
          .beside_air = air * side.beside_air,
          .beside_water = water * side.beside_water,
          .velocity = velocity,
          .pressure = pressure,
          .wave = wave};
}

}  // namespace

Flux flux_between(const Side& low, const Side& high, double face_velocity) {
  const double rho_l = low.air + low.water, rho_h = high.air + high.water;
  const double closing = low.normal - high.normal, rise = high.pressure - low.pressure;
  double speed_l = 0, speed_h = 0;
  if (rise >= 0) {
    speed_l = wave_speed(low.sound, rise / (rho_h * high.sound) + closing);
    speed_h = wave_speed(high.sound, -rise / (rho_l * speed_l) + closing);
  } else {
    speed_h = wave_speed(high.sound, -rise / (rho_l * low.sound) + closing);
    speed_l = wave_speed(low.sound, rise / (rho_h * speed_h) + closing);
  }
  // Contact: u* = (Z_l u_l + Z_h u_h + p_l − p_h)/(Z_l + Z_h), p* = (Z_h p_l + Z_l p_h + Z_l Z_h (u_l − u_h))
  // /(Z_l + Z_h), with the impedances Z = ρ s.
  const double z_l = rho_l * speed_l, z_h = rho_h * speed_h, sum = z_l + z_h;
  const double velocity = (z_l * low.normal + z_h * high.normal - rise) / sum;
  const double pressure =
      std::max((z_h * low.pressure + z_l * high.pressure + z_l * z_h * closing) / sum, vapour_pressure);
  const double first = low.normal - speed_l - face_velocity;
  const double last = high.normal + speed_h - face_velocity;
  const double wave = std::max(std::abs(first), std::abs(last));
  if (first >= 0) return carried(low, 1, low.normal, low.pressure, face_velocity, wave);
  if (last <= 0) return carried(high, 1, high.normal, high.pressure, face_velocity, wave);
  // Density beside the contact: 1/ρ* = 1/ρ_l + (u* − u_l)/Z_l, and likewise above it.
  if (velocity >= face_velocity)
    return carried(low, 1 / (1 + rho_l * (velocity - low.normal) / z_l), velocity, pressure, face_velocity,
                   wave);
  return carried(high, 1 / (1 + rho_h * (high.normal - velocity) / z_h), velocity, pressure, face_velocity,
                 wave);
}

double wall_pressure(const Side& side, double wall_velocity, int outward) {
  // p* = p + Z (u − w)·n, the contact between the side and its mirror image.
  const double closing = outward * (side.normal - wall_velocity), density = side.air + side.water;
  const double speed = wave_speed(side.sound, 2 * closing);
  return std::max(side.pressure + density * speed * closing, vapour_pressure);
}

Fractions sharp_fractions(double fraction, double steepness, bool rises) {
  // α(X) = (1 ± tanh(β(X − d)))/2 over 0 < X < 1; d follows from the cell's mean C:
  // B = exp(±β(2C − 1)), A = (B/cosh β − 1)/tanh β; α(0) = (1 ± A)/2,
  // α(1) = (1 ± (tanh β + A)/(1 + A tanh β))/2.
  const double sign = rises ? 1 : -1, tangent = std::tanh(steepness);
  const double b = std::exp(sign * steepness * (2 * fraction - 1));
  const double a = (b / std::cosh(steepness) - 1) / tangent;
  const double low = 0.5 * (1 + sign * a);
  const double high = 0.5 * (1 + sign * (tangent + a) / (1 + a * tangent));
  return {std::clamp(low, 0.0, 1.0), std::clamp(high, 0.0, 1.0)};
}

}  // namespace resolved_air
