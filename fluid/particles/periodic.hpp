#pragma once

#include "fluid/particles/state.hpp"

#include <limits>

namespace strake::fluid {

/// Directions in which space repeats itself. The distance of two places is the shortest one over the seams.
/// Places are kept within one length of one another (`wrap`), so that one length at most is added. A removed
/// particle is placed farther off than that.
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

  /// Returns one component of a difference of places, over the seam where that is shorter. It is exactly odd
  /// in its argument.
  double nearest(double difference, int direction) const {
    const double up = difference < -half_[direction] ? length_[direction] : 0.0;
    const double down = difference > half_[direction] ? length_[direction] : 0.0;
    return difference + up - down;
  }
  /// Returns b − a to the nearest image of b. separation(b, a) is the same with the other sign, to the last
  /// bit.
  Vector<dim> separation(const Vector<dim>& a, const Vector<dim>& b) const {
    Vector<dim> r = b - a;
    if (any_)  // else r is not written: reading numbers written one by one stalls
      for (int d = 0; d < dim; ++d) r[d] = nearest(r[d], d);
    return r;
  }
  /// Returns the image of x in [low, low + length) of each periodic direction. x must not be farther off than
  /// one length.
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
