#pragma once

#include "fluid/particles/reorder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace strake::fluid {

/// Groups acoustic sub-steps that share one frozen configuration of the particles (fluid/THEORY.md, section
/// 8.10). Where c Δt ≤ l0, water moves by a thousandth of its spacing in a step. Neighbours, moments,
/// surface, stresses, filter and shifting are then computed once per group. Pressure and velocity are
/// computed in every step. The last step moves the particles, x += T u, with T the length of the group and u
/// the velocity at its end. This adds no energy to the lattice's own oscillation; the mean of the steps'
/// velocities would.
///
/// Between, the velocity gradient changes as if the particles had moved,
///   ∇u(τ) = ∇u − τ ∇u·∇u + O(τ²), τ the age of the configuration.
/// Without this, turning or shearing water would feel the pressure of the whole group in its first step.
///
/// A group begins with a coupling window and ends with it at the latest, so it is no part of the state. A
/// rewound or resumed window therefore gives the same bits. A group of one step equals an ordinary step to
/// the last bit.
class AcousticSubstepping {
 public:
  /// Largest displacement of water and bodies in a group, the next step included [l0]. Measured: the paper's
  /// rigid plate at 1500 m/s moves by 0.03 in a window, and its pressure differs by 0.1 % of ρcV. A vortex 5
  /// l0 wide keeps its energy over a turn within 0.2 % at 0.05, and gains 2 % at 0.1.
  static constexpr double largest_displacement = 0.05;
  /// The same where faces are about to become wet [l0]. A group does not see them, so they would become wet
  /// together at its end, as one blow. Chosen.
  static constexpr double before_contact = 0.005;

  /// Returns a group of one step.
  static AcousticSubstepping single_step(double dt) {
    AcousticSubstepping group;
    group.step(dt, 0, 0, 0);
    return group;
  }
  /// Continues the group or begins a new one, before a step of dt. rest: of the window after this step [s].
  /// longest: duration of a group [s], zero for single steps. number: of the steps taken.
  void step(double dt, double rest, double longest, std::int64_t number) {
    dt_ = dt;
    rest_ = rest;
    if (!over_) return;
    over_ = false;
    age_ = 0;
    const auto to_reorder = static_cast<double>(reorder_interval - number % reorder_interval);
    const double room = std::min({longest, rest + dt, to_reorder * dt});
    const double steps = std::max(1.0, std::floor(room / dt * (1 + round_off)));
    single_ = steps == 1;
    length_ = steps * dt;
  }
  bool begins() const { return age_ == 0; }
  bool is_single() const { return single_; }
  double age() const { return age_; }        // of the configuration [s]
  double length() const { return length_; }  // largest possible duration of the group [s]

  /// Whether the step just taken was the group's last. fastest: largest speed of the water [m/s]. farthest:
  /// largest displacement of the bodies since the group began [m]. contact_gap: what lies between the water
  /// and the next face to become wet, when the group began [m].
  bool ends(double fastest, double farthest, double contact_gap, double spacing) {
    age_ += dt_;
    const double with_next = std::max(fastest * age_, farthest) * (1 + dt_ / age_);
    over_ = !(rest_ > 0) || age_ + dt_ > length_ * (1 + round_off) ||
            !(with_next < std::clamp(contact_gap, before_contact * spacing, largest_displacement * spacing));
    return over_;
  }
  bool is_over() const { return over_; }
  /// Ends the group, after the state has been replaced.
  void forget() { over_ = true; }

 private:
  static constexpr double round_off = 1e-6;
  bool over_ = true, single_ = true;
  double dt_ = 0, rest_ = 0, age_ = 0, length_ = 0;
};

}  // namespace strake::fluid
