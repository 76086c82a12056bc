#include "proto/values.hpp"

#include <cassert>

namespace strake {

using Eigen::Index;
using Eigen::Vector3d;

bool Values::check_finite() {
  if (finite_) return true;
  if (rows() == 3 && cols() > many) {
    sum_ = sum_over_points();
    finite_ = sum_->allFinite();
  }
  finite_ = finite_ || all_finite(*this);  // finite numbers can have a sum that is not
  return finite_;
}

Vector3d Values::sum_over_points() const {
  assert(rows() == 3);
  if (sum_) return *sum_;
  constexpr Index chains = 16;
  using Chains = Eigen::Array<double, 3 * chains, 1>;
  Vector3d sum = Vector3d::Zero();
  if (cols() <= many) return sum + rowwise().sum();
  Chains partial = Chains::Zero();
  Index i = 0;
  for (; i + chains <= cols(); i += chains) partial += Eigen::Map<const Chains>(data() + 3 * i);
  for (Index k = 0; k < chains; ++k) sum += partial.segment<3>(3 * k).matrix();
  for (; i < cols(); ++i) sum += col(i);
  return sum;
}

}  // namespace strake
