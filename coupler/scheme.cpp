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

// Field::conservative says how it is mapped.
Field displacement_field(const MatrixXd& u) {
  return {"displacement", "m", false, u};
}
Field velocity_field(const MatrixXd& v) {
  return {"velocity", "m/s", false, v};
}

/// √(Σ |a_i|² / n) over the n columns.
double rms(const MatrixXd& a) {
  return a.cols() == 0 ? 0 : std::sqrt(a.squaredNorm() / static_cast<double>(a.cols()));
}

/// Displacement [m] and velocity × scale [m], one below the other: one linear combination moves both.
VectorXd stack(const Motion& motion, double scale) {
  VectorXd x(motion.displacement.size() + motion.velocity.size());
  x << motion.displacement.reshaped(), scale * motion.velocity.reshaped();
  return x;
}

Motion unstack(const VectorXd& x, const Motion& shape, double scale) {
  const Index n = shape.displacement.size();
  Motion motion = shape;
  motion.displacement = x.head(n).reshaped(3, n / 3);
  if (shape.velocity.size() > 0) motion.velocity = x.tail(n).reshaped(3, n / 3) / scale;
  return motion;
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
  Motion start = {start_time, u ? u->value : MatrixXd::Zero(3, n), v ? v->value : MatrixXd()};
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

// H: motion of the structure's surface → fluid → force → structure → motion. The fluid is given x, the
// structure answers H(x); a window is done when rms(H(x) − x) is small enough.
WindowReport Scheme::advance(const Window& window) {
  assert(!open_);
  const Convergence& convergence = parameters_.convergence;
  const Motion& committed = state_.motion.back();
  const double end = window.t + window.dt;
  pending_ = state_;
  if (pending_.velocity_scale == 0) pending_.velocity_scale = 0.5 * window.dt;
  const double scale = pending_.velocity_scale;
  accelerator_->set_state(state_.accelerator);
  accelerator_->start_window();

  WindowReport report;
  report.window = window;
  report.number = state_.windows + 1;
  Motion guess = parameters_.volume ? committed : predict(parameters_.predictor, state_.motion, end);
  if (!state_.sends_velocity) guess.velocity.resize(0, 0);
  MatrixXd previous_force;
  const int most = parameters_.volume ? 1 : std::max(1, convergence.max_iterations);

  const auto retry = [&](double limit) {
    WindowReport again;
    again.window = window;
    again.number = report.number;
    again.retry = true;
    again.dt_limit = limit < window.dt ? limit : 0.5 * window.dt;
    return again;
  };

  for (int iteration = 1;; ++iteration) {
    Sample motion = {parameters_.volume ? window.t : end, {}};
    motion.fields.push_back(mapping_.consistent(displacement_field(guess.displacement)));
    if (guess.velocity.size() > 0)
      motion.fields.push_back(mapping_.consistent(velocity_field(guess.velocity)));
    const Advanced wet = fluid_.advance(window, {{motion}});
    if (wet.retry_smaller_dt) {
      fluid_.rewind();
      return retry(wet.dt_limit);
    }
    const MatrixXd fluid_force =
        taken(wet, "force", fluid_.mesh(), {"fluid", window, report.number, iteration}, true);
    const Field force = mapping_.conservative({"force", "N", true, fluid_force});

    const Advanced dry = structure_.advance(window, {{{end, {force}}}});
    if (dry.retry_smaller_dt) {
      fluid_.rewind();
      structure_.rewind();
      return retry(dry.dt_limit);
    }
    const Place place = {"structure", window, report.number, iteration};
    Motion answer = {end, taken(dry, "displacement", structure_.mesh(), place, true),
                     taken(dry, "velocity", structure_.mesh(), place, parameters_.volume)};
    // A structure may give a velocity at the start alone; one that begins to send it later is followed from
    // then on.
    if (answer.velocity.size() == 0) guess.velocity.resize(0, 0);
    if (answer.velocity.size() > 0 && guess.velocity.size() == 0) guess.velocity = answer.velocity;
    pending_.sends_velocity = answer.velocity.size() > 0;

    IterationReport row;
    row.iteration = iteration;
    row.force = force.value.rowwise().sum();
    bool settled = true;
    if (!parameters_.volume) {
      const MatrixXd missing = answer.displacement - guess.displacement;
      row.residual = rms(missing);
      if (answer.velocity.size() > 0)
        row.residual = std::max(row.residual, 0.5 * window.dt * rms(answer.velocity - guess.velocity));
      const bool by_value = convergence.measure == Measure::value;
      row.threshold =
          std::max(convergence.absolute,
                   convergence.relative *
                       rms(by_value ? answer.displacement : answer.displacement - committed.displacement));
      if (by_value && most > 1)
        settled = previous_force.size() > 0 &&
                  rms(force.value - previous_force) <= convergence.relative * rms(force.value);
    }
    const bool converged = row.residual <= row.threshold && settled;
    const bool done = (converged && iteration >= convergence.min_iterations) || iteration >= most;
    const VectorXd x = stack(guess, scale), hx = stack(answer, scale);
    if (done) {
      if (!parameters_.volume) accelerator_->finish_window(x, hx);
    } else {
      const VectorXd next = accelerator_->next(x, hx);
      guess = unstack(next, guess, scale);
      row.relaxation = accelerator_->last_step().relaxation;
      row.columns = accelerator_->last_step().columns;
      row.dropped = accelerator_->last_step().dropped;
    }
    report.log.push_back(row);
    previous_force = force.value;
    if (!done) {
      fluid_.rewind();
      structure_.rewind();
      continue;
    }

    if (!converged && most > 1) {
      if (convergence.then == Unconverged::halve) {
        fluid_.rewind();
        structure_.rewind();
        return retry(0.5 * window.dt);
      }
      if (convergence.then == Unconverged::stop)
        throw Error(ExitCode::solver_fault,
                    fmt::format("coupling, window {} (t = {:g} s)", report.number, window.t),
                    fmt::format("did not converge\n{} iterations, residual {:.1e} m, wanted {:.1e} m",
                                iteration, row.residual, row.threshold),
                    "lower coupling.surface.window, raise converged.max_iterations, or accept and count such "
                    "windows");
    }
    const MatrixXd increment = answer.displacement - committed.displacement;
    report.iterations = iteration;
    report.residual = row.residual;
    report.threshold = row.threshold;
    report.converged = converged;
    report.dt_limit = std::min(wet.dt_limit, dry.dt_limit);
    report.work_fluid = dot(fluid_force, mapping_.consistent(displacement_field(increment)).value);
    report.work_structure = dot(force.value, increment);
    if (!parameters_.volume)
      report.work_unconverged = dot(force.value, answer.displacement - guess.displacement);
    report.displacement = answer.displacement;
    if (answer.velocity.size() > 0) report.velocity = answer.velocity;
    report.force = force.value;
    report.fluid = wet.monitor;
    report.structure = dry.monitor;
    pending_.force = force.value;
    pending_.accelerator = accelerator_->state();
    remember(pending_.motion, std::move(answer));
    ++pending_.windows;
    open_ = true;
    return report;
  }
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
  fluid_.rewind();
  structure_.rewind();
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
