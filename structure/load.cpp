#include "structure/solver.hpp"

#include <algorithm>
#include <utility>

namespace strake::structure {

Load::Load(std::vector<Sample> samples) : samples_(std::move(samples)) {}

// One sample is the mean over the window: held. A history is linear between its samples and held beyond them.
Points Load::at(double time, Eigen::Index n_points) const {
  const auto force = [&](const Sample& sample) -> Points {
    const Field* field = find(sample.fields, "force");
    Points value = Points::Zero(3, n_points);
    if (field) value.topRows(field->value.rows()) = field->value;
    return value;
  };
  if (samples_.empty()) return Points::Zero(3, n_points);
  const auto after = std::find_if(samples_.begin(), samples_.end(),
                                  [&](const Sample& sample) { return sample.time >= time; });
  if (after == samples_.end()) return force(samples_.back());
  if (after == samples_.begin()) return force(samples_.front());
  const Sample &b = *after, &a = *(after - 1);
  const double s = (time - a.time) / (b.time - a.time);
  return (1 - s) * force(a) + s * force(b);
}

}  // namespace strake::structure
