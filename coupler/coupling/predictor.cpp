#include "coupler/coupling/scheme.hpp"
#include "proto/interpolation.hpp"

#include <algorithm>

namespace strake {
namespace {

/// Lagrange polynomial of `value` through the last `n` samples: Σ_k f_k Π_(j≠k) (t − t_j)/(t_k − t_j). Of one
/// sample its value.
template <class History, class Value>
Values extrapolate(const History& history, std::size_t n, double time, const Value& value) {
  // Differences to the newest value: a travel much larger than its changes loses no digits.
  const Values& newest = value(history.back());
  if (n == 1) return newest;
  const std::size_t first = history.size() - n;
  Eigen::MatrixXd sum = newest;
  for (std::size_t k = first; k + 1 < history.size(); ++k) {
    double weight = 1;
    for (std::size_t j = first; j < history.size(); ++j)
      if (j != k) weight *= (time - history[j].time) / (history[k].time - history[j].time);
    sum += weight * (value(history[k]) - newest);
  }
  return sum;
}

/// Fields that stand in the member `fields` of each sample.
template <class T>
std::vector<Field> extrapolate(const std::vector<T>& history, std::size_t n, double time,
                               std::vector<Field> T::*fields) {
  std::vector<Field> made;
  const std::vector<Field>& last = history.back().*fields;
  for (std::size_t f = 0; f < last.size(); ++f)
    made.push_back({last[f].quantity, last[f].unit, last[f].conservative,
                    extrapolate(history, n, time, [&](const T& sample) -> const Values& {
                      return (sample.*fields)[f].value;
                    })});
  return made;
}

std::size_t taken_by(Predictor kind) {
  return static_cast<std::size_t>(kind) + 1;
}

template <class T>
void keep_last(std::vector<T>& history, T sample, Predictor kind) {
  history.push_back(std::move(sample));
  const std::size_t most = taken_by(kind);
  if (history.size() > most)
    history.erase(history.begin(), history.end() - static_cast<std::ptrdiff_t>(most));
}

}  // namespace

Predictor predictor_kind(const std::string& name) {
  return static_cast<Predictor>(degree_of(name, "coupling.surface.predictor"));
}

void remember(Samples& history, Sample sample, Predictor kind) {
  keep_last(history, std::move(sample), kind);
}

void remember(StructureSamples& history, StructureSample sample, Predictor kind) {
  keep_last(history, std::move(sample), kind);
}

Sample predict(Predictor kind, const Samples& history, double time) {
  const std::size_t n = std::min(taken_by(kind), history.size());
  return {time, extrapolate(history, n, time, &Sample::fields)};
}

StructureSample predict(Predictor kind, const StructureSamples& history, double time) {
  const std::size_t wanted = taken_by(kind), n = std::min(wanted, history.size());
  const StructureSample& last = history.back();
  StructureSample guess = {time, {}, extrapolate(history, n, time, &StructureSample::others)};
  if (!last.motion) return guess;
  const auto& [u, v] = *last.motion;
  guess.motion = Motion{
      extrapolate(history, n, time,
                  [](const StructureSample& sample) -> const Values& { return sample.motion->displacement; }),
      v};
  if (v.size() == 0) return guess;
  if (n == 1 && wanted > 1) guess.motion->displacement = u + (time - last.time) * v;
  if (n > 1)  // as the fluid follows it (cases/VALIDATION.md, "Piston and column")
    guess.motion->velocity = 2 / (time - last.time) * (guess.motion->displacement - u) - v;
  return guess;
}

}  // namespace strake
