#include "coupler/coupling/predictor.hpp"

#include "proto/interpolation.hpp"

#include <algorithm>

namespace strake {
namespace {

/// Lagrange polynomial of field number `f` through the last `n` samples: Σ_k f_k Π_(j≠k) (t − t_j)/(t_k −
/// t_j).
Eigen::MatrixXd extrapolate(const Samples& history, std::size_t n, std::size_t f, double time) {
  const std::size_t first = history.size() - n;
  // Differences to the newest value: a travel much larger than its changes loses no digits.
  const Values& newest = history.back().fields[f].value;
  Eigen::MatrixXd value = newest;
  for (std::size_t k = first; k + 1 < history.size(); ++k) {
    double weight = 1;
    for (std::size_t j = first; j < history.size(); ++j)
      if (j != k) weight *= (time - history[j].time) / (history[k].time - history[j].time);
    value += weight * (history[k].fields[f].value - newest);
  }
  return value;
}

std::size_t taken_by(Predictor kind) {
  return static_cast<std::size_t>(kind) + 1;
}

}  // namespace

Predictor predictor_kind(const std::string& name) {
  return static_cast<Predictor>(degree_of(name, "coupling.surface.predictor"));
}

void remember(Samples& history, Sample sample, Predictor kind) {
  history.push_back(std::move(sample));
  const std::size_t most = taken_by(kind);
  if (history.size() > most)
    history.erase(history.begin(), history.end() - static_cast<std::ptrdiff_t>(most));
}

Sample predict(Predictor kind, const Samples& history, double time) {
  const Sample& last = history.back();
  const std::size_t wanted = taken_by(kind);
  const std::size_t n = std::min(wanted, history.size());
  const Field *u = find(last.fields, "displacement"), *v = find(last.fields, "velocity");
  Sample guess = {time, {}};
  for (std::size_t f = 0; f < last.fields.size(); ++f) {
    const Field& field = last.fields[f];
    guess.fields.push_back({field.quantity, field.unit, field.conservative, {}});
    Values& value = guess.fields.back().value;
    if (n == 1 && wanted > 1 && v && &field == u)
      value = field.value + (time - last.time) * v->value;
    else if (n == 1 || (u && &field == v))
      value = field.value;
    else
      value = extrapolate(history, n, f, time);
  }
  if (n > 1 && u && v) {
    // As the fluid follows it (cases/VALIDATION.md, "Piston and column").
    const auto index = [&](const Field* field) {
      return static_cast<std::size_t>(field - last.fields.data());
    };
    guess.fields[index(v)].value =
        2 / (time - last.time) * (guess.fields[index(u)].value - u->value) - v->value;
  }
  return guess;
}

}  // namespace strake
