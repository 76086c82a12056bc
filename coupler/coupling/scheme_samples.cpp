// What each side is given over a window: samples of its partner, at the window's end or as a history.

#include "coupler/coupling/scheme_iterate.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace strake {

namespace {

constexpr double time_slack = 1e-9;  // of a window, by which a sample's time may miss its end

/// Adds s (b − c) to a.
void shift(Values& a, double s, const Values& b, const Values& c) {
  a.edit() += s * (b - c);
}

/// Adds b − c to a, field by field.
void shift(std::vector<Field>& a, const std::vector<Field>& b, const std::vector<Field>& c) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k].value.edit() += b[k].value - c[k].value;
}

/// Refuses a sample whose time is not after `last` or not in the window.
void check_time(double time, double last, const Place& place) {
  const double end = place.window.t + place.window.dt;
  if (time > last && time <= end + time_slack * place.window.dt) return;
  throw Error(
      ExitCode::solver_fault, place.text(),
      fmt::format("sent a sample at {:.9g} s after {:.9g} s in a window to {:.9g} s", time, last, end),
      "samples ascend from after the window's start to its end");
}

bool any_conservative(const std::vector<Field>& fields) {
  return std::any_of(fields.begin(), fields.end(), [](const Field& field) { return field.conservative; });
}

}  // namespace

// ---- from the structure to the fluid

bool Scheme::fluid_takes_history() const {
  return fluid_.description().history && !parameters_.volume;
}

Input Scheme::for_fluid(const Window& window, const Iterate& now) const {
  Input input;
  input.wants_history = structure_.description().history && !parameters_.volume;
  const auto give = [&](double time, const StructureSample& fields) {
    Sample sample = {time, {}};
    for (const Field& field : fields.fields()) sample.fields.push_back(transfer_.onto_fluid(field));
    input.samples.push_back(std::move(sample));
  };
  if (fluid_takes_history()) {
    for (const StructureSample& sample : state_.structure_history) give(sample.time, sample);
    for (const StructureSample& sample : moved_history(window, now)) give(sample.time, sample);
  }
  give(parameters_.volume ? window.t : window.t + window.dt, guess_of(now));
  return input;
}

// The structure's last answers inside the window. The guess x at the window's end is not its last answer y
// there; a sample at t_j is moved by (t_j − t)/dt of x − y, so that the start of the window stays.
StructureSamples Scheme::moved_history(const Window& window, const Iterate& now) const {
  StructureSamples moved = now.structure_history;
  if (!moved.empty()) moved.pop_back();  // at the end the guess takes its place
  const StructureSample &x = guess_of(now), &y = now.answer;
  for (StructureSample& sample : moved) {
    const double part = (sample.time - window.t) / window.dt;
    if (auto& motion = sample.motion) {
      shift(motion->displacement, part, x.motion->displacement, y.motion->displacement);
      if (motion->velocity.size() > 0) shift(motion->velocity, part, x.motion->velocity, y.motion->velocity);
    }
    for (std::size_t k = 0; k < sample.others.size(); ++k)
      shift(sample.others[k].value, part, x.others[k].value, y.others[k].value);
  }
  return moved;
}

// The answers of the structure over the window, the last at its end. Where it sends that one alone, it makes
// a history with those of the windows before, unless it is a mean.
StructureSamples Scheme::receive_structure_history(const Window& window, int iteration, Iterate& now) const {
  const Place place = {"structure", window, state_.windows + 1, iteration};
  const double end = window.t + window.dt;
  StructureSamples history;
  double last = window.t;
  for (Sample& sample : now.from_structure.history) {
    check_time(sample.time, last, place);
    last = sample.time;
    if (last >= end - time_slack * window.dt) break;
    StructureSample taken =
        received_fields(std::move(sample.fields), of_structure_, structure_.mesh(), place);
    taken.time = last;
    history.push_back(std::move(taken));
  }
  if (!history.empty() || !any_conservative(of_structure_.others)) history.push_back(now.answer);
  return history;
}

// ---- from the fluid to the structure

// The load at the window's end, or its history with the samples before it. In a parallel scheme the
// history is the fluid's last one, moved by what the load has been changed since.
Input Scheme::for_structure(const Window& window, const Iterate& now) const {
  const std::vector<Field>& load = parameters_.parallel ? now.load_guess : now.load;
  const Samples& given = parameters_.parallel ? now.history_before : now.history;
  Input input;
  input.wants_history = fluid_takes_history();
  if (!structure_.description().history || given.empty()) {
    if (initial_load_ && state_.windows == 0) input.samples.push_back(*initial_load_);
    input.samples.push_back({window.t + window.dt, load});
    add_attached(input.samples.back().fields, now.attached);
    return input;
  }
  input.samples = state_.history;
  for (const Sample& sample : given) {
    input.samples.push_back(sample);
    if (!parameters_.parallel) continue;
    std::vector<Field> all = load, before = now.load_before;
    add_attached(all, now.attached);
    add_attached(before, now.attached_before);
    shift(input.samples.back().fields, all, before);
  }
  return input;
}

// What the fluid sends over the window, with the force of attachments. Where it is alone with its end values,
// and these are no means, they make a history with those before.
Samples Scheme::receive_history(const Window& window, int iteration, Iterate& now) const {
  const Place place = {"fluid", window, state_.windows + 1, iteration};
  const double end = window.t + window.dt;
  Samples history;
  double last = window.t;
  for (Sample& sample : now.from_fluid.history) {
    check_time(sample.time, last, place);
    last = sample.time;
    history.push_back({sample.time, {}});
    for (const Field& field : received_fields(std::move(sample.fields), of_fluid_, fluid_.mesh(), place))
      history.back().fields.push_back(transfer_.onto_structure(field));
  }
  if (history.empty() && !any_conservative(of_fluid_)) history = {{end, now.load}};
  for (Sample& sample : history) add_attached(sample.fields, now.attached);
  return history;
}

}  // namespace strake
