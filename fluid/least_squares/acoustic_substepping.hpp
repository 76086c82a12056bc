#pragma once

#include "fluid/particles/reorder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace strake::fluid {

/// Steps of a window that share their places. Steps that follow sound from particle to particle move water by
/// a thousandth of its spacing; pairs, moments, surface, stresses, filter and shift change with the places
/// alone, or as slowly. They are found where a hold begins and stand until it ends, while pressure and
/// velocity take every step; its last step makes the moves of all of them, x += T u, T the hold's length and
/// u the velocity at its end, which as in a step by itself adds no energy to the lattice's own oscillation
/// (the mean of the steps' velocities would). What the places would have done to ∇u since then it does by
/// itself,
///   ∇u(τ) = ∇u − τ ∇u·∇u + O(τ²), τ the time since the hold began:
/// without it what turns or shears would feel the pressure of a whole hold in its first step, and none in the
/// others.
///
/// A hold begins with a window and ends with it at the latest, so that it is no part of the state: a rewound,
/// resumed or iterated window finds all anew, as the first time. A hold of one step is a step by itself, to
/// the last bit.
class Hold {
 public:
  /// So far water and bodies may have come, or would come in one step more [l0]. Measured: the paper's rigid
  /// plate at 1500 m/s comes by 0.03 in a window, its pressure differs by 0.1 % of ρcV then; a vortex 5 l0
  /// wide keeps its energy over a turn within 0.2 % at 0.05, and 2 % too much of it at 0.1.
  static constexpr double longest_way = 0.05;

  /// A step by itself.
  static Hold of_one(double dt) {
    Hold hold;
    hold.step(dt, 0, 0, 0);
    return hold;
  }
  /// Before a step of dt with `rest` of the window after it [s]: goes on, or begins anew. longest: what steps
  /// together may last [s], zero where each stands by itself; number: of the steps taken.
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
  double age() const { return age_; }        // of the places [s]
  double length() const { return length_; }  // as long as it may become [s]

  /// After a step: whether it was the last one. fastest: of the water [m/s]; farthest: the bodies' longest
  /// way since the hold began [m].
  bool ends(double fastest, double farthest, double spacing) {
    age_ += dt_;
    const double with_next = std::max(fastest * age_, farthest) * (1 + dt_ / age_);
    over_ = !(rest_ > 0) || age_ + dt_ > length_ * (1 + round_off) || !(with_next < longest_way * spacing);
    return over_;
  }
  bool is_over() const { return over_; }
  /// Where the state has become another.
  void forget() { over_ = true; }

 private:
  static constexpr double round_off = 1e-6;
  bool over_ = true, single_ = true;
  double dt_ = 0, rest_ = 0, age_ = 0, length_ = 0;
};

}  // namespace strake::fluid
