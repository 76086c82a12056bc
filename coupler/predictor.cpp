#include "coupler/predictor.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "proto/error.hpp"

namespace strake {
namespace {

/// Lagrange polynomial through the last `n` motions: Σ_k f_k Π_(j≠k) (t − t_j)/(t_k − t_j).
Eigen::MatrixXd extrapolate(const MotionHistory& history, std::size_t n, Eigen::MatrixXd Motion::*what,
                            double time) {
  const std::size_t first = history.size() - n;
  // Differences to the newest value: a travel much larger than its changes loses no digits.
  const Eigen::MatrixXd& newest = history.back().*what;
  Eigen::MatrixXd value = newest;
  for (std::size_t k = first; k + 1 < history.size(); ++k) {
    double weight = 1;
    for (std::size_t j = first; j < history.size(); ++j)
      if (j != k) weight *= (time - history[j].time) / (history[k].time - history[j].time);
    value += weight * (history[k].*what - newest);
  }
  return value;
}

}  // namespace

Predictor predictor_kind(const std::string& name) {
  if (name == "constant") return Predictor::constant;
  if (name == "linear") return Predictor::linear;
  if (name == "quadratic") return Predictor::quadratic;
  throw Error(ExitCode::case_file, "coupling.surface.predictor",
              fmt::format("\"{}\" is not a predictor", name), "quadratic, linear or constant");
}

void remember(MotionHistory& history, Motion motion) {
  constexpr std::size_t longest = 3;
  if (history.size() == longest) history.erase(history.begin());
  history.push_back(std::move(motion));
}

Motion predict(Predictor kind, const MotionHistory& history, double time) {
  const Motion& last = history.back();
  const std::size_t wanted = kind == Predictor::constant ? 1 : kind == Predictor::linear ? 2 : 3;
  const std::size_t n = std::min(wanted, history.size());
  Motion guess = {time, last.displacement, last.velocity};
  if (wanted == 1) return guess;
  if (n == 1) {
    if (last.velocity.size() > 0) guess.displacement += (time - last.time) * last.velocity;
    return guess;
  }
  guess.displacement = extrapolate(history, n, &Motion::displacement, time);
  // The velocity that an interface moved with constant acceleration has at the end, as the fluid follows it
  // (DESIGN 2).
  if (last.velocity.size() > 0)
    guess.velocity = 2 / (time - last.time) * (guess.displacement - last.displacement) - last.velocity;
  return guess;
}

}  // namespace strake
