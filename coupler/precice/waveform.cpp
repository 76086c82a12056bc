#include "coupler/precice/waveform.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace strake {
namespace {

/// Lagrange's polynomial through `count` knots from `first` on.
Values polynomial(const std::vector<Waveform::Knot>& knots, std::size_t first, std::size_t count,
                  double time) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(knots[first].value.rows(), knots[first].value.cols());
  for (std::size_t i = first; i < first + count; ++i) {
    double weight = 1;
    for (std::size_t j = first; j < first + count; ++j)
      if (j != i) weight *= (time - knots[j].time) / (knots[i].time - knots[j].time);
    sum += weight * knots[i].value;
  }
  return sum;
}

}  // namespace

void Waveform::begin(double time, Values value) {
  start_ = {time, std::move(value)};
}

void Waveform::set_window(double start, std::vector<Knot> samples) {
  start_.time = start;
  const Knot& last = samples.back();
  if (start_.value.cols() != last.value.cols() || start_.value.rows() != last.value.rows())
    start_.value = Values(Eigen::MatrixXd(Eigen::MatrixXd::Zero(last.value.rows(), last.value.cols())));
  const double same = 1e-9 * (last.time - start);
  knots_.clear();
  if (samples.front().time > start + same) knots_.push_back(start_);
  for (Knot& sample : samples) knots_.push_back(std::move(sample));
}

void Waveform::commit() {
  if (!knots_.empty()) start_ = knots_.back();
}

Values Waveform::at(double time) const {
  const Knot& last = knots_.back();
  const double same = 1e-9 * (last.time - start_.time);
  if (std::abs(time - last.time) <= same || knots_.size() == 1) return last.value;
  const auto after =
      std::find_if(knots_.begin(), knots_.end(), [&](const Knot& knot) { return knot.time > time + same; });
  const auto next =
      static_cast<std::size_t>(after - knots_.begin());  // at least 1 where the window has begun
  if (degree_ == 0) return knots_[std::min(next, knots_.size() - 1)].value;
  const std::size_t count = std::min(static_cast<std::size_t>(degree_) + 1, knots_.size());
  const std::size_t before = next < (count + 1) / 2 ? 0 : next - (count + 1) / 2;
  return polynomial(knots_, std::min(before, knots_.size() - count), count, time);
}

}  // namespace strake
