// One evaluation of the coupled map: the order of the calls, and the exchanged fields.

#include "coupler/coupling/scheme_iterate.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace strake {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Adds b − c to a, field by field.
void shift(std::vector<Field>& a, const std::vector<Field>& b, const std::vector<Field>& c) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k].value.edit() += b[k].value - c[k].value;
}

}  // namespace

MatrixXd followed_velocity(const Motion& committed, const Values& displacement, double dt) {
  return 2 / dt * (displacement - committed.displacement) - committed.velocity;
}

Scheme::Iterate Scheme::first_guess(const Window& window) const {
  Iterate now;
  const double end = window.t + window.dt;
  if (!holds_last()) now.guess = predict(parameters_.predictor, state_.structure, end);
  if (parameters_.parallel) now.load_guess = predict(parameters_.predictor, state_.fluid, end).fields;
  if (!parameters_.parallel && limits_of_load().any()) now.load = state_.fluid.back().fields;
  return now;
}

/// Whether the fluid is given the structure's last committed sample as it is: no iteration changes it.
bool Scheme::holds_last() const {
  return parameters_.volume ||
         (parameters_.predictor == Predictor::constant && parameters_.convergence.max_iterations <= 1);
}

const StructureSample& Scheme::guess_of(const Iterate& now) const {
  return holds_last() ? state_.structure.back() : now.guess;
}

std::optional<Scheme::Shorter> Scheme::evaluate(const Window& window, int iteration, Iterate& now) {
  now.load_before = std::exchange(now.load, {});
  now.history_before = std::exchange(now.history, {});
  return parameters_.parallel ? evaluate_parallel(window, iteration, now)
                              : evaluate_serial(window, iteration, now);
}

std::optional<Scheme::Shorter> Scheme::evaluate_serial(const Window& window, int iteration, Iterate& now) {
  now.from_fluid = fluid_.advance(window, for_fluid(window, now));
  if (now.from_fluid.retry_smaller_dt) {
    fluid_.rewind();
    return Shorter("the fluid", now.from_fluid);
  }
  receive_fluid(window, iteration, now);

  structure_.start_with(window, for_structure(window, now));
  sum_load(now);  // while the structure computes
  now.from_structure = structure_.finish();
  if (now.from_structure.retry_smaller_dt) {
    rewind_both();
    return Shorter("the structure", now.from_structure);
  }
  receive_structure(window, iteration, now);
  return std::nullopt;
}

std::optional<Scheme::Shorter> Scheme::evaluate_parallel(const Window& window, int iteration, Iterate& now) {
  fluid_.start_with(window, for_fluid(window, now));
  structure_.start_with(window, for_structure(window, now));
  now.from_fluid = fluid_.finish();
  now.from_structure = structure_.finish();
  std::optional<Shorter> shorter;
  if (now.from_fluid.retry_smaller_dt) shorter.emplace("the fluid", now.from_fluid);
  if (now.from_structure.retry_smaller_dt && (!shorter || now.from_structure.dt_limit < shorter->limit))
    shorter.emplace("the structure", now.from_structure);
  if (shorter) {
    rewind_both();
    return shorter;
  }
  receive_fluid(window, iteration, now);
  sum_load(now);
  receive_structure(window, iteration, now);
  return std::nullopt;
}

Input Scheme::for_fluid(const Window& window, const Iterate& now) const {
  Sample sample = {parameters_.volume ? window.t : window.t + window.dt, {}};
  for (const Field& field : guess_of(now).fields()) sample.fields.push_back(transfer_.onto_fluid(field));
  Input input;
  input.samples.push_back(std::move(sample));
  return input;
}

// The load at the window's end, or its history with the samples before it. In a parallel scheme the
// history is the fluid's last one, moved by what the load has been changed since.
Input Scheme::for_structure(const Window& window, const Iterate& now) const {
  const std::vector<Field>& load = parameters_.parallel ? now.load_guess : now.load;
  const Samples& given = parameters_.parallel ? now.history_before : now.history;
  Input input;
  if (!structure_.description().history || given.empty()) {
    input.samples.push_back({window.t + window.dt, load});
    return input;
  }
  input.samples = state_.history;
  for (const Sample& sample : given) {
    input.samples.push_back(sample);
    if (parameters_.parallel) shift(input.samples.back().fields, load, now.load_before);
  }
  return input;
}

// What the fluid sends over the window. Where it is alone with its end values, and these are no means, they
// make a history with those before.
Samples Scheme::receive_history(const Window& window, int iteration, Iterate& now) const {
  const Place place = {"fluid", window, state_.windows + 1, iteration};
  const double end = window.t + window.dt, slack = 1e-9 * window.dt;
  Samples history;
  double last = window.t;
  for (Sample& sample : now.from_fluid.history) {
    if (!(sample.time > last) || sample.time > end + slack)
      throw Error(ExitCode::solver_fault, place.text(),
                  fmt::format("sent a sample at {:.9g} s after {:.9g} s in a window to {:.9g} s", sample.time,
                              last, end),
                  "samples ascend from after the window's start to its end");
    last = sample.time;
    history.push_back({sample.time, {}});
    for (const Field& field : received_fields(std::move(sample.fields), of_fluid_, fluid_.mesh(), place))
      history.back().fields.push_back(transfer_.onto_structure(field));
  }
  if (!history.empty()) return history;
  const bool means =
      std::any_of(of_fluid_.begin(), of_fluid_.end(), [](const Field& field) { return field.conservative; });
  if (!means) history = {{end, now.load}};
  return history;
}

void Scheme::sum_load(Iterate& now) {
  if (const Field* force = find(now.load, "force")) now.force = force->value.sum_over_points();
}

void Scheme::receive_fluid(const Window& window, int iteration, Iterate& now) const {
  now.wet = received_fields(std::move(now.from_fluid.output), of_fluid_, fluid_.mesh(),
                            {"fluid", window, state_.windows + 1, iteration});
  now.load.clear();
  for (const Field& field : now.wet) now.load.push_back(transfer_.onto_structure(field));
  if (structure_.description().history) now.history = receive_history(window, iteration, now);
}

void Scheme::receive_structure(const Window& window, int iteration, Iterate& now) {
  const Place place = {"structure", window, state_.windows + 1, iteration};
  now.answer = received_fields(std::move(now.from_structure.output), of_structure_, structure_.mesh(), place);
  if (!now.answer.motion) return;
  auto& [displacement, velocity] = *now.answer.motion;
  pending_.sends_velocity = velocity.size() > 0;
  if (pending_.sends_velocity) return;
  if (parameters_.volume)
    throw Error(ExitCode::solver_fault, place.text(), "sent no velocity",
                "volume coupling needs the velocity of the solid's particles with each window");
  velocity = followed_velocity(*state_.structure.back().motion, displacement, window.dt);
}

// A motion is one field: its velocity stands there as a length.
std::vector<AcceleratorBlock> Scheme::blocks(const Iterate& now) const {
  std::vector<AcceleratorBlock> blocks;
  const auto add = [&](const Field& field) { blocks.push_back({field.quantity, field.value.size()}); };
  if (const auto& motion = now.answer.motion)
    blocks.push_back({"displacement",
                      motion->displacement.size() + (pending_.sends_velocity ? motion->velocity.size() : 0)});
  for (const Field& field : now.answer.others) add(field);
  if (parameters_.parallel)
    for (const Field& field : now.load) add(field);
  return blocks;
}

// All unknowns one below the other: the structure's fields, and in a parallel scheme the fluid's.
// Displacement [m] and, where the structure sends it, velocity × scale [m]: one linear combination moves
// both.
VectorXd Scheme::stack(const StructureSample& structure, const std::vector<Field>& load) const {
  VectorXd x;
  const auto append = [&](const Values& values, double factor = 1) {
    const Eigen::Index at = x.size();
    x.conservativeResize(at + values.size());
    x.tail(values.size()) = factor * values.reshaped();
  };
  if (const auto& motion = structure.motion) {
    append(motion->displacement);
    if (pending_.sends_velocity) append(motion->velocity, pending_.velocity_scale);
  }
  for (const Field& field : structure.others) append(field.value);
  if (parameters_.parallel)
    for (const Field& field : load) append(field.value);
  return x;
}

void Scheme::next_guess(const Window& window, Iterate& now) {
  const VectorXd x = accelerator_->next(stack(now.guess, now.load_guess), stack(now.answer, now.load));
  Eigen::Index at = 0;
  const auto take = [&](Values& values) {
    MatrixXd value(values.rows(), values.cols());
    value.reshaped() = x.segment(at, value.size());
    at += value.size();
    values = std::move(value);
  };
  if (now.guess.motion) {
    auto& [displacement, velocity] = *now.guess.motion;
    take(displacement);
    if (pending_.sends_velocity) {
      take(velocity);
      velocity.edit() /= pending_.velocity_scale;
    } else {
      velocity = followed_velocity(*state_.structure.back().motion, displacement, window.dt);
    }
  }
  for (Field& field : now.guess.others) take(field.value);
  for (Field& field : now.load_guess) take(field.value);
}

}  // namespace strake
