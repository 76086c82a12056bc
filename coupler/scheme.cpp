#include "coupler/scheme.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string_view>

#include "proto/error.hpp"

namespace strake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// √(Σ |a_i|² / n) over the n columns.
double rms(const MatrixXd& a) {
  return a.cols() == 0 ? 0 : std::sqrt(a.squaredNorm() / static_cast<double>(a.cols()));
}

/// v_(n+1) = 2 (u_(n+1) − u_n)/dt − v_n, the end velocity of an interface that moves with constant
/// acceleration (DESIGN 2). From the structure's committed motion, so that what one window leaves unconverged
/// does not add up in the next.
MatrixXd followed_velocity(const Motion& committed, const MatrixXd& displacement, double dt) {
  return 2 / dt * (displacement - committed.displacement) - committed.velocity;
}

/// The place of a fault: which participant, window and iteration.
struct Place {
  const char* name;
  Window window;
  int number, iteration;
  std::string text() const {
    return fmt::format("{}, window {} (t = {:g} s), iteration {}", name, number, window.t, iteration);
  }
};

/// A field of a participant's answer, checked; 0×0 when it may be absent and is.
MatrixXd taken(const Advanced& answer, const std::string& quantity, const InterfaceMesh& mesh,
               const Place& place, bool required) {
  const Field* field = find(answer.output, quantity);
  if (!field) {
    if (!required) return {};
    throw Error(ExitCode::solver_fault, place.text(), fmt::format("sent no {}", quantity),
                "it must send displacement (structure) or force (fluid) with each window");
  }
  if (field->value.rows() != 3 || field->value.cols() != mesh.position.cols())
    throw Error(ExitCode::solver_fault, place.text(),
                fmt::format("sent a {} of {}×{}, its mesh needs 3×{}", quantity, field->value.rows(),
                            field->value.cols(), mesh.position.cols()));
  for (Index i = 0; i < field->value.cols(); ++i)
    if (!field->value.col(i).allFinite()) {
      const auto X = mesh.position.col(i);
      throw Error(ExitCode::solver_fault, place.text(),
                  fmt::format("the {} of interface point {}, X = ({:g}, {:g}, {:g}) m, is not finite",
                              quantity, i, X.x(), X.y(), X.z()),
                  "see its log; a smaller coupling window or solver step may help");
    }
  return field->value;
}

double dot(const MatrixXd& a, const MatrixXd& b) {
  return a.reshaped().dot(b.reshaped());
}

}  // namespace

double WindowReport::work_gap() const {
  const double larger = std::max(std::abs(work_fluid), std::abs(work_structure));
  return larger == 0 ? 0 : std::abs(work_fluid - work_structure) / larger;
}

std::map<std::string, double> WindowReport::monitor() const {
  std::map<std::string, double> merged;
  for (const auto* side : {&fluid, &structure})
    for (const auto& [name, value] : *side) {
      const auto begins = [&name = name](std::string_view prefix) { return name.starts_with(prefix); };
      if (!begins("seconds.") && !begins("count.") && !begins("check.") && !begins("memory."))
        merged.emplace(name, value);
    }
  return merged;
}

Scheme::Scheme(Participant& fluid, Participant& structure, Mapping mapping, SchemeParameters parameters,
               double start_time)
    : fluid_(fluid),
      structure_(structure),
      mapping_(std::move(mapping)),
      parameters_(std::move(parameters)),
      accelerator_(make_accelerator(parameters_.accelerator)) {
  const Index n = structure_.mesh().position.cols();
  if (mapping_.weights().rows() != fluid_.mesh().position.cols() || mapping_.weights().cols() != n)
    throw Error(
        ExitCode::case_file, "coupling",
        fmt::format("the mapping is {}×{}, the meshes have {} and {} points", mapping_.weights().rows(),
                    mapping_.weights().cols(), fluid_.mesh().position.cols(), n));
  const auto& initial = structure_.description().initial;
  const Field* u = find(initial, "displacement");
  const Field* v = find(initial, "velocity");
  Motion start = {start_time, u ? u->value : MatrixXd::Zero(3, n), v ? v->value : MatrixXd::Zero(3, n)};
  if (start.displacement.cols() != n || (v && v->value.cols() != n))
    throw Error(ExitCode::solver_fault, "structure", "its motion at the start does not fit its mesh");
  if (parameters_.volume && !v)
    throw Error(ExitCode::case_file, "coupling.interface = \"volume\"",
                "the structure gives no velocity, which the fluid needs for the solid's particles",
                "structure.solver = \"particle\"");
  state_.sends_velocity = v != nullptr;
  state_.motion = {std::move(start)};
  state_.force = MatrixXd::Zero(3, n);
}

void Scheme::set_state(CouplingState state) {
  assert(!open_);
  const Index n = structure_.mesh().position.cols();
  if (state.motion.empty() || state.motion.back().displacement.cols() != n)
    throw Error(ExitCode::case_file, "checkpoint, coupler.h5",
                fmt::format("its interface does not have the structure's {} points", n),
                "resume with the case that the checkpoint was made with");
  state_ = std::move(state);
}

/// One evaluation of H.
struct Scheme::Iterate {
  Motion guess, answer;         // x and H(x) on the structure's mesh
  Advanced wet, dry;            // of the fluid and the structure
  MatrixXd fluid_force, force;  // 3×n [N] on each side
};

// H: motion of the structure's surface → fluid → force → structure → motion. The fluid is given x, the
// structure answers H(x); a window is done when rms(H(x) − x) is small enough.
WindowReport Scheme::advance(const Window& window) {
  assert(!open_);
  const Convergence& convergence = parameters_.convergence;
  pending_ = state_;
  if (pending_.velocity_scale == 0) pending_.velocity_scale = 0.5 * window.dt;
  accelerator_->set_state(state_.accelerator);
  accelerator_->start_window();

  const Motion& committed = state_.motion.back();
  const bool volume = parameters_.volume;
  const int most = volume ? 1 : std::max(1, convergence.max_iterations);
  WindowReport report;
  report.window = window;
  report.number = state_.windows + 1;
  Iterate now;
  now.guess = volume ? committed : predict(parameters_.predictor, state_.motion, window.t + window.dt);
  for (int iteration = 1;; ++iteration) {
    const MatrixXd previous_force = now.force;
    if (const auto limit = evaluate(window, iteration, now)) return retry(window, *limit);
    IterationReport row = volume ? IterationReport{} : measure(window, now, previous_force);
    row.iteration = iteration;
    row.force = now.force.rowwise().sum();
    report.converged = row.residual <= row.threshold;
    if ((report.converged && iteration >= convergence.min_iterations) || iteration >= most) {
      if (!volume) accelerator_->finish_window(stack(now.guess), stack(now.answer));
      report.log.push_back(row);
      break;
    }
    now.guess = next_guess(window, now);
    row.relaxation = accelerator_->last_step().relaxation;
    row.columns = accelerator_->last_step().columns;
    row.dropped = accelerator_->last_step().dropped;
    report.log.push_back(row);
    take_back();
  }
  if (!report.converged && most > 1) {
    if (convergence.then == Unconverged::halve) {
      take_back();
      return retry(window, 0.5 * window.dt);
    }
    if (convergence.then == Unconverged::stop) stop_unconverged(report);
  }
  close(report, now);
  return report;
}

std::optional<double> Scheme::evaluate(const Window& window, int iteration, Iterate& now) {
  const double end = window.t + window.dt;
  const Place fluid = {"fluid", window, state_.windows + 1, iteration};
  const Place structure = {"structure", window, state_.windows + 1, iteration};
  const Sample motion = {parameters_.volume ? window.t : end,
                         {mapping_.consistent({"displacement", "m", false, now.guess.displacement}),
                          mapping_.consistent({"velocity", "m/s", false, now.guess.velocity})}};
  now.wet = fluid_.advance(window, {{motion}});
  if (now.wet.retry_smaller_dt) {
    fluid_.rewind();
    return now.wet.dt_limit;
  }
  now.fluid_force = taken(now.wet, "force", fluid_.mesh(), fluid, true);
  const Field force = mapping_.conservative({"force", "N", true, now.fluid_force});
  now.force = force.value;

  now.dry = structure_.advance(window, {{{end, {force}}}});
  if (now.dry.retry_smaller_dt) {
    take_back();
    return now.dry.dt_limit;
  }
  now.answer.time = end;
  now.answer.displacement = taken(now.dry, "displacement", structure_.mesh(), structure, true);
  now.answer.velocity = taken(now.dry, "velocity", structure_.mesh(), structure, parameters_.volume);
  pending_.sends_velocity = now.answer.velocity.size() > 0;
  if (!pending_.sends_velocity)
    now.answer.velocity = followed_velocity(state_.motion.back(), now.answer.displacement, window.dt);
  return std::nullopt;
}

IterationReport Scheme::measure(const Window& window, const Iterate& now,
                                const MatrixXd& previous_force) const {
  const Convergence& c = parameters_.convergence;
  const bool by_value = c.measure == Measure::value;
  IterationReport row;
  row.residual = std::max(rms(now.answer.displacement - now.guess.displacement),
                          0.5 * window.dt * rms(now.answer.velocity - now.guess.velocity));
  const double scale =
      rms(by_value ? now.answer.displacement : now.answer.displacement - state_.motion.back().displacement);
  row.threshold = std::max(c.absolute, c.relative * scale);
  // By value the force has to settle too: its change counts as a residual of the same relative size.
  if (by_value && c.max_iterations > 1) {
    const double change = previous_force.size() == 0 ? rms(now.force) : rms(now.force - previous_force);
    const double part = change / std::max(rms(now.force), change);
    if (change > c.relative * rms(now.force))
      row.residual = std::max(row.residual, part * std::max(scale, row.threshold / c.relative));
  }
  return row;
}

// Displacement [m] and, where the structure sends it, velocity × scale [m], one below the other: one linear
// combination moves both.
VectorXd Scheme::stack(const Motion& motion) const {
  if (!pending_.sends_velocity) return motion.displacement.reshaped();
  VectorXd x(motion.displacement.size() + motion.velocity.size());
  x << motion.displacement.reshaped(), pending_.velocity_scale * motion.velocity.reshaped();
  return x;
}

Motion Scheme::next_guess(const Window& window, const Iterate& now) {
  const VectorXd x = accelerator_->next(stack(now.guess), stack(now.answer));
  const Index n = now.guess.displacement.size();
  Motion guess = now.guess;
  guess.displacement = x.head(n).reshaped(3, n / 3);
  guess.velocity = pending_.sends_velocity
                       ? MatrixXd(x.tail(n).reshaped(3, n / 3) / pending_.velocity_scale)
                       : followed_velocity(state_.motion.back(), guess.displacement, window.dt);
  return guess;
}

void Scheme::take_back() {
  fluid_.rewind();
  structure_.rewind();
}

WindowReport Scheme::retry(const Window& window, double limit) const {
  WindowReport report;
  report.window = window;
  report.number = state_.windows + 1;
  report.retry = true;
  report.dt_limit = limit < window.dt ? limit : 0.5 * window.dt;
  return report;
}

void Scheme::stop_unconverged(const WindowReport& report) const {
  const IterationReport& last = report.log.back();
  throw Error(
      ExitCode::solver_fault, fmt::format("coupling, window {} (t = {:g} s)", report.number, report.window.t),
      fmt::format("did not converge\n{} iterations, residual {:.1e} m, wanted {:.1e} m", last.iteration,
                  last.residual, last.threshold),
      "lower coupling.surface.window, raise converged.max_iterations, or accept and count such windows");
}

void Scheme::close(WindowReport& report, Iterate& now) {
  const Field increment = {"displacement", "m", false,
                           now.answer.displacement - state_.motion.back().displacement};
  report.iterations = report.log.back().iteration;
  report.residual = report.log.back().residual;
  report.threshold = report.log.back().threshold;
  report.dt_limit = std::min(now.wet.dt_limit, now.dry.dt_limit);
  report.work_fluid = dot(now.fluid_force, mapping_.consistent(increment).value);
  report.work_structure = dot(now.force, increment.value);
  if (!parameters_.volume)
    report.work_unconverged = dot(now.force, now.answer.displacement - now.guess.displacement);
  report.displacement = now.answer.displacement;
  if (pending_.sends_velocity) report.velocity = now.answer.velocity;
  report.force = now.force;
  report.fluid = std::move(now.wet.monitor);
  report.structure = std::move(now.dry.monitor);
  pending_.force = now.force;
  pending_.accelerator = accelerator_->state();
  remember(pending_.motion, std::move(now.answer));
  ++pending_.windows;
  open_ = true;
}

void Scheme::commit(bool write_output) {
  assert(open_);
  fluid_.commit(write_output);
  structure_.commit(write_output);
  state_ = std::move(pending_);
  open_ = false;
}

void Scheme::abandon() {
  assert(open_);
  take_back();
  open_ = false;
}

WindowReport advance_alone(Participant& participant, const Window& window) {
  WindowReport report;
  report.window = window;
  const Advanced advanced = participant.advance(window, {});
  if (advanced.retry_smaller_dt) {
    participant.rewind();
    report.retry = true;
    report.dt_limit = advanced.dt_limit < window.dt ? advanced.dt_limit : 0.5 * window.dt;
    return report;
  }
  report.iterations = 1;
  report.converged = true;
  report.dt_limit = advanced.dt_limit;
  report.fluid = advanced.monitor;
  return report;
}

}  // namespace strake
