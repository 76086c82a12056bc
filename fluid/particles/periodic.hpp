#pragma once

#include "fluid/particles/state.hpp"

#include <limits>

namespace strake::fluid {

/// Directions in which space repeats itself. Between two places counts the shortest way over the seams.
/// Places are kept within one length of one another (`wrap`), so that one length at most is added; a particle
/// that is to see nobody stands further off than that.
template <int dim>
class Periodic {
 public:
  Periodic() : Periodic(Vector<dim>::Zero()) {}
  /// length: of the period in each direction [m]; 0: not periodic.
  explicit Periodic(const Vector<dim>& length) : length_(length) {
    for (int d = 0; d < dim; ++d)
      half_[d] = length[d] > 0 ? 0.5 * length[d] : std::numeric_limits<double>::infinity();
    any_ = (length.array() > 0).any();
  }
  const Vector<dim>& length() const { return length_; }          // [m]; 0: not periodic
  double half(int direction) const { return half_[direction]; }  // [m]; infinite where not periodic
  bool along(int direction) const { return length_[direction] > 0; }
  bool any() const { return any_; }

  /// One component of a difference of places, over the seam where that is shorter. Exactly odd in its
  /// argument.
  double nearest(double difference, int direction) const {
    const double up = difference < -half_[direction] ? length_[direction] : 0.0;
    const double down = difference > half_[direction] ? length_[direction] : 0.0;
    return difference + up - down;
  }
  /// b − a to the nearest image of b; separation(b, a) is the same with the other sign, to the last bit.
  Vector<dim> separation(const Vector<dim>& a, const Vector<dim>& b) const {
    Vector<dim> r = b - a;
    if (any_)  // else left as it is: numbers written one by one would be waited for
      for (int d = 0; d < dim; ++d) r[d] = nearest(r[d], d);
    return r;
  }
  /// The image of x in [low, low + length) of each periodic direction, for x not further off than one length.
  Vector<dim> wrap(Vector<dim> x, const Vector<dim>& low) const {
    for (int d = 0; d < dim; ++d) {
      if (!along(d)) continue;
      if (x[d] < low[d]) x[d] += length_[d];
      if (x[d] >= low[d] + length_[d]) x[d] -= length_[d];
    }
    return x;
  }

 private:
  Vector<dim> length_, half_;
  bool any_ = false;
};

}  // namespace strake::fluid
