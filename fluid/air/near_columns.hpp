#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace strake::fluid {

/// Finds the columns of air near a place, seen from above.
template <int plane>
class NearColumns {
 public:
  using Place = Eigen::Matrix<double, plane, 1>;
  using Places = Eigen::Matrix<double, plane, Eigen::Dynamic>;
  /// place: plane×n, the middles of the columns [m]; spacing: l0 [m].
  NearColumns(const Places& place, double spacing) : place_(place), spacing_(spacing) {
    low_ = place.rowwise().minCoeff();
    high_ = place.rowwise().maxCoeff();
    for (int a = 0; a < plane; ++a) count_[a] = 1 + static_cast<int>((high_[a] - low_[a]) / spacing);
    start_.assign(static_cast<std::size_t>(count_.prod()) + 1, 0);
    column_.resize(static_cast<std::size_t>(place.cols()));
    for (Eigen::Index c = 0; c < place.cols(); ++c) ++start_[cell(cells_at(place.col(c))) + 1];
    for (std::size_t k = 1; k < start_.size(); ++k) start_[k] += start_[k - 1];
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (Eigen::Index c = 0; c < place.cols(); ++c)
      column_[next[cell(cells_at(place.col(c)))]++] = static_cast<int>(c);
  }

  /// Calls visit(column, w) for the columns nearer than l0 in each direction; w = Π (1 − |x_a|/l0).
  template <class Visit>
  void for_each(const Place& x, const Visit& visit) const {
    for (int a = 0; a < plane; ++a)
      if (x[a] < low_[a] - spacing_ || x[a] > high_[a] + spacing_) return;
    // By round-off a place a spacing past the columns may be two cells past them.
    const Cells middle = cells_at(x).max(-1).min(count_), from = (middle - 1).max(0),
                to = (middle + 1).min(count_ - 1);
    Cells at = from;
    for (;;) {
      for (std::size_t k = start_[cell(at)]; k < start_[cell(at) + 1]; ++k) {
        double w = 1;
        for (int a = 0; a < plane; ++a)
          w *= std::max(0.0, 1 - std::abs(x[a] - place_(a, column_[k])) / spacing_);
        if (w > 0) visit(column_[k], w);
      }
      int a = 0;
      while (a < plane && at[a] == to[a]) at[a] = from[a], ++a;
      if (a == plane) return;
      ++at[a];
    }
  }

 private:
  using Cells = Eigen::Array<int, plane, 1>;
  Cells cells_at(const Place& x) const {
    Cells at;
    for (int a = 0; a < plane; ++a) at[a] = static_cast<int>(std::floor((x[a] - low_[a]) / spacing_));
    return at;
  }
  std::size_t cell(const Cells& at) const {
    return static_cast<std::size_t>(plane == 1 ? at[0] : at[0] + count_[0] * at[plane - 1]);
  }

  Places place_;
  double spacing_;
  Place low_, high_;
  Cells count_;
  std::vector<std::size_t> start_;  // of each cell in column_
  std::vector<int> column_;
};

}  // namespace strake::fluid
