#include "coupler/acceleration/iqn_imvj.hpp"

#include <algorithm>

namespace strake {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// Singular values of J below this part of the largest are forgotten when it starts again.
constexpr double smallest_singular = 1e-2;

}  // namespace

void IqnImvj::start_window() {
  Secants& secants = state_.secants;
  if (secants.columns() > 0) {
    const Index n = secants.image.front()->size();
    const std::vector<Index> lengths = sizes(n);
    // Carried columns are filtered as those of earlier windows are. For a fine column the linear model's
    // error, divided by the column's new part, would stay in J.
    const LeastSquares problem = factorise(parameters_.filter);
    state_.jacobian.add(secants.images(problem), secants.pseudo_inverse(problem, lengths, weights()));
    if (static_cast<int>(state_.jacobian.left.size()) > parameters_.max_columns) {
      VectorXd scale(n);
      Index begin = 0;
      for (std::size_t b = 0; b < lengths.size(); begin += lengths[b++])
        scale.segment(begin, lengths[b]).setConstant(weights()[static_cast<Index>(b)]);
      state_.jacobian.truncate(std::max(1, parameters_.max_columns / 2), smallest_singular, scale);
    }
    secants = {};
  }
  Accelerator::start_window();
}

}  // namespace strake
