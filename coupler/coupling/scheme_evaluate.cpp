// One evaluation of the coupled map: the order of the calls, and the exchanged fields at a window's end.

#include "coupler/coupling/scheme_iterate.hpp"
#include "proto/error.hpp"

#include <algorithm>
#include <utility>

namespace strake {

using Eigen::MatrixXd;
using Eigen::VectorXd;

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

/// Asks a structure that no load moves for its motion over the window. The fluid is given that, and the first
/// iteration ends the window. The load of this question is the announced one: only the answer's motion
/// counts.
std::optional<Scheme::Shorter> Scheme::ask_prescribed(const Window& window, Iterate& now) {
  if (!structure_.description().prescribed || parameters_.parallel || holds_last()) return std::nullopt;
  Iterate asked;
  for (const Field& field : of_fluid_) asked.load.push_back(transfer_.onto_structure(field));
  structure_.start_with(window, for_structure(window, asked));
  asked.from_structure = structure_.finish();
  std::optional<Shorter> shorter;
  if (asked.from_structure.retry_smaller_dt) {
    shorter.emplace("the structure", asked.from_structure);
  } else {
    receive_structure(window, 1, asked);
    now.guess = std::move(asked.answer);
    now.structure_history = std::move(asked.structure_history);
  }
  structure_.rewind();
  return shorter;
}

std::optional<Scheme::Shorter> Scheme::evaluate(const Window& window, int iteration, Iterate& now) {
  now.load_before = std::exchange(now.load, {});
  now.history_before = std::exchange(now.history, {});
  return parameters_.parallel ? evaluate_parallel(window, iteration, now)
                              : evaluate_serial(window, iteration, now);
}

std::optional<Scheme::Shorter> Scheme::evaluate_serial(const Window& window, int iteration, Iterate& now) {
  fluid_.start_with(window, for_fluid(window, now));
  start_attachments(window, now);
  now.from_fluid = fluid_.finish();
  std::optional<Shorter> shorter = finish_attachments(window, iteration, now);
  if (now.from_fluid.retry_smaller_dt && (!shorter || now.from_fluid.dt_limit < shorter->limit))
    shorter.emplace("the fluid", now.from_fluid);
  if (shorter) {
    fluid_.rewind();
    attachments_.rewind();
    return shorter;
  }
  receive_fluid(window, iteration, now);

  structure_.start_with(window, for_structure(window, now));
  sum_load(now);  // while the structure computes
  now.from_structure = structure_.finish();
  if (now.from_structure.retry_smaller_dt) {
    rewind_all();
    return Shorter("the structure", now.from_structure);
  }
  receive_structure(window, iteration, now);
  return std::nullopt;
}

std::optional<Scheme::Shorter> Scheme::evaluate_parallel(const Window& window, int iteration, Iterate& now) {
  fluid_.start_with(window, for_fluid(window, now));
  start_attachments(window, now);
  std::optional<Shorter> shorter = finish_attachments(window, iteration, now);
  structure_.start_with(window, for_structure(window, now));
  now.from_fluid = fluid_.finish();
  now.from_structure = structure_.finish();
  const auto ask = [&](const char* who, const Advanced& answer) {
    if (answer.retry_smaller_dt && (!shorter || answer.dt_limit < shorter->limit))
      shorter.emplace(who, answer);
  };
  ask("the fluid", now.from_fluid);
  ask("the structure", now.from_structure);
  if (shorter) {
    rewind_all();
    return shorter;
  }
  receive_fluid(window, iteration, now);
  sum_load(now);
  receive_structure(window, iteration, now);
  return std::nullopt;
}

/// Like the fluid they compute from the guess of the motion.
void Scheme::start_attachments(const Window& window, Iterate& now) {
  now.attached_before = std::exchange(now.attached, {});
  if (!attachments_.none()) attachments_.start(window, *guess_of(now).motion);
}

std::optional<Scheme::Shorter> Scheme::finish_attachments(const Window& window, int iteration, Iterate& now) {
  const auto shorter = attachments_.finish({"", window, state_.windows + 1, iteration});
  now.attached = attachments_.load();
  if (shorter) return Shorter(shorter->who, shorter->answer);
  return std::nullopt;
}

void add_attached(std::vector<Field>& load, const Values& attached) {
  if (attached.cols() == 0) return;
  for (Field& field : load)
    if (field.quantity == "force") field.value.edit() += attached;
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
  if (fluid_takes_history()) now.structure_history = receive_structure_history(window, iteration, now);
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
std::vector<AcceleratorBlock> Scheme::blocks(const StructureSample& structure,
                                             const std::vector<Field>& load) const {
  std::vector<AcceleratorBlock> blocks;
  const auto add = [&](const Field& field) { blocks.push_back({field.quantity, field.value.size()}); };
  if (const auto& motion = structure.motion)
    blocks.push_back({"displacement",
                      motion->displacement.size() + (pending_.sends_velocity ? motion->velocity.size() : 0)});
  for (const Field& field : structure.others) add(field);
  if (parameters_.parallel)
    for (const Field& field : load) add(field);
  return blocks;
}

void Scheme::tell_blocks(const StructureSample& structure, const std::vector<Field>& load) {
  if (auto fields = blocks(structure, load); fields.size() > 1) accelerator_->set_blocks(std::move(fields));
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
