#include "coupler/coupling/scheme.hpp"

#include "coupler/coupling/scheme_iterate.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

template <class A, class B>
double dot(const A& a, const B& b) {
  return a.reshaped().dot(b.reshaped());
}

/// Appends samples of a window to those before it, of which the last are kept.
template <class T>
void keep_earlier(std::vector<T>& history, std::vector<T>& samples) {
  constexpr std::size_t earlier = 3;  // with one more a cubic at the start of a window
  for (T& sample : samples) history.push_back(std::move(sample));
  if (history.size() > earlier)
    history.erase(history.begin(), history.end() - static_cast<std::ptrdiff_t>(earlier));
}

/// In one line: the console shows it with the window.
std::string asks_for_shorter(const std::string& who, const Window& window, const std::string& why) {
  return fmt::format("{} asks for a shorter window than {:.3g} s{}{}", who, window.dt,
                     why.empty() ? "" : ": ", why);
}

}  // namespace

Scheme::Scheme(Participant& fluid, Participant& structure, FieldTransfer transfer,
               SchemeParameters parameters, double start_time, std::vector<Attachment> attachments)
    : fluid_(fluid),
      structure_(structure),
      attachments_(std::move(attachments)),
      transfer_(std::move(transfer)),
      parameters_(std::move(parameters)),
      of_structure_(fields_of_structure(structure)),
      of_fluid_(fields_of_fluid(fluid)),
      accelerator_(make_accelerator(parameters_.accelerator)) {
  const Index n = structure_.mesh().position.cols(), n_wet = fluid_.mesh().position.cols();
  const auto check = [](const Mapping& mapping, Index rows, Index columns) {
    const auto& weights = mapping.weights();
    if (weights.rows() != rows || weights.cols() != columns)
      throw Error(ExitCode::case_file, "coupling",
                  fmt::format("the mapping is {}×{}, the meshes have {} and {} points", weights.rows(),
                              weights.cols(), rows, columns));
  };
  check(mapping(), n_wet, n);
  if (transfer_.to_structure()) check(*transfer_.to_structure(), n, n_wet);
  if (FieldTransfer::needs_way_back(of_structure_, of_fluid_) && !transfer_.to_structure())
    throw Error(ExitCode::case_file, "coupling",
                "the fluid sends a field that is not a load, or the structure one that is: there is no "
                "mapping for it");
  if (parameters_.volume && (!of_structure_.motion || !find(structure_.description().initial, "velocity")))
    throw Error(ExitCode::case_file, "coupling.interface = \"volume\"",
                "the structure gives no velocity, which the fluid needs for the solid's particles",
                "structure.solver = \"particle\"");
  if (!attachments_.none() && (!of_structure_.motion || !find(of_fluid_, "force") || parameters_.volume))
    throw Error(ExitCode::case_file, "attachments",
                "need a structure that sends its displacement, and a fluid that sends force on its surface");
  parameters_.parallel = parameters_.parallel && !parameters_.volume;
  state_.sends_velocity = find(structure_.description().initial, "velocity") != nullptr;
  of_structure_.time = start_time;
  state_.structure = {of_structure_};
  Sample load = {start_time, {}};
  for (const Field& field : of_fluid_) load.fields.push_back(transfer_.onto_structure(field));
  Sample of_water = load;
  add_attached(load.fields, attachments_.load());
  const bool announced = !fluid_.description().initial.empty() || !attachments_.none();
  if (structure_.description().history && announced) state_.history = {load};
  if (structure_.description().partner_initial && announced) initial_load_ = load;
  if (fluid_takes_history()) state_.structure_history = {of_structure_};
  if (needs_last_load()) state_.fluid = {std::move(of_water)};
}

void Scheme::set_state(CouplingState state) {
  assert(!open_);
  const Index n = structure_.mesh().position.cols();
  // An archive keeps names and values; units and how a field is mapped stand in the announcement.
  const auto fit = [n](std::vector<Field>& fields, const std::vector<Field>& announced) {
    if (fields.size() != announced.size()) return false;
    for (std::size_t k = 0; k < fields.size(); ++k) {
      Field& field = fields[k];
      if (field.quantity != announced[k].quantity || field.value.cols() != n ||
          field.value.rows() != announced[k].value.rows())
        return false;
      field.unit = announced[k].unit;
      field.conservative = announced[k].conservative;
    }
    return true;
  };
  const auto load_fits = [&](Samples& samples) {
    return std::all_of(samples.begin(), samples.end(),
                       [&](Sample& sample) { return fit(sample.fields, of_fluid_); });
  };
  const auto moves_alike = [&](const std::optional<Motion>& motion) {
    const auto whole = [n](const Values& value) { return value.rows() == 3 && value.cols() == n; };
    if (!of_structure_.motion || !motion) return !of_structure_.motion && !motion;
    return whole(motion->displacement) && whole(motion->velocity);
  };
  if (!needs_last_load()) state.fluid.clear();
  const bool structure_fits =
      !state.structure.empty() &&
      std::all_of(state.structure.begin(), state.structure.end(), [&](StructureSample& sample) {
        return moves_alike(sample.motion) && fit(sample.others, of_structure_.others);
      });
  const bool history_fits = std::all_of(
      state.structure_history.begin(), state.structure_history.end(), [&](StructureSample& sample) {
        const bool moves = !sample.motion || sample.motion->displacement.cols() == n;
        return moves && sample.motion.has_value() == of_structure_.motion.has_value() &&
               fit(sample.others, of_structure_.others);
      });
  const bool all_load = !needs_last_load() || !state.fluid.empty();
  if (!structure_fits || !history_fits || !all_load || !load_fits(state.fluid) || !load_fits(state.history))
    throw Error(ExitCode::case_file, "checkpoint, coupler.h5",
                fmt::format("its interface does not have the structure's {} points and fields", n),
                "resume with the case that the checkpoint was made with");
  state_ = std::move(state);
  // The accelerator begins a window with what it kept of the one before, field by field.
  pending_.sends_velocity = state_.sends_velocity;
  if (state_.windows > 0)
    tell_blocks(state_.structure.back(), state_.fluid.empty() ? of_fluid_ : state_.fluid.back().fields);
}

// The coupled map H: motion of the structure → fluid → load → structure. The fluid is given x, the structure
// returns H(x); a window is done when H(x) − x is small enough. In a parallel scheme x contains the load as
// well, and each side computes from the other's part of x.
WindowReport Scheme::advance(const Window& window) {
  assert(!open_);
  const Convergence& convergence = parameters_.convergence;
  pending_ = {};
  pending_.velocity_scale = state_.velocity_scale == 0 ? 0.5 * window.dt : state_.velocity_scale;
  pending_.sends_velocity = state_.sends_velocity;
  accelerator_->set_state(state_.accelerator);
  accelerator_->start_window();

  const int most = parameters_.volume ? 1 : std::max(1, convergence.max_iterations);
  WindowReport report;
  report.window = window;
  report.number = state_.windows + 1;
  Iterate now = first_guess(window);
  std::optional<Shorter> shorter = ask_prescribed(window, now);
  for (int iteration = 1;; ++iteration) {
    if (!shorter) shorter = evaluate(window, iteration, now);
    if (shorter)
      return retry(window, shorter->limit, asks_for_shorter(shorter->who, window, shorter->why),
                   shorter->fix);
    report.log.push_back(measure(window, iteration, now, report.log.empty() ? nullptr : &report.log.front()));
    IterationReport& row = report.log.back();
    if (iteration == 1) tell_blocks(now.answer, now.load);
    report.converged = row.settled();
    if ((report.converged && iteration >= convergence.min_iterations) || iteration >= most) break;
    next_guess(window, now);
    row.relaxation = accelerator_->last_step().relaxation;
    row.columns = accelerator_->last_step().columns;
    row.dropped = accelerator_->last_step().dropped;
    rewind_all();
  }
  if (!report.converged && most > 1) {
    if (convergence.then == Unconverged::halve) {
      rewind_all();
      return retry(window, 0.5 * window.dt,
                   fmt::format("a window of {:.3g} s does not converge in {} iterations", window.dt, most),
                   "raise coupling.surface.converged.max_iterations");
    }
    if (convergence.then == Unconverged::stop) stop_unconverged(report);
  }
  if (most > 1) accelerator_->finish_window(stack(now.guess, now.load_guess), stack(now.answer, now.load));
  close(report, now);
  return report;
}

/// None in explicit schemes: there is nothing that settles. In a parallel one the structure may have settled
/// under a load that is not the fluid's.
Limits Scheme::limits_of_load() const {
  const Convergence& c = parameters_.convergence;
  if (parameters_.volume || c.max_iterations <= 1) return {};
  Limits limits = c.load;
  const bool must_settle = parameters_.parallel || c.measure == Measure::value;
  if (must_settle && limits.relative == 0) limits.relative = c.relative;
  if (must_settle && limits.residual_relative == 0) limits.residual_relative = c.residual_relative;
  return limits;
}

bool Scheme::needs_last_load() const {
  return parameters_.parallel || limits_of_load().any();
}

std::vector<Column> Scheme::measured() const {
  std::vector<Column> columns;
  if (of_structure_.motion) columns.push_back({"displacement", "m"});
  for (const Field& field : of_structure_.others) columns.push_back({field.quantity, field.unit});
  if (limits_of_load().any())
    for (const Field& field : of_fluid_) columns.push_back({field.quantity, field.unit});
  return columns;
}

bool Scheme::is_mechanical() const {
  return of_structure_.motion && find(of_fluid_, "force");
}

IterationReport Scheme::measure(const Window& window, int iteration, const Iterate& now,
                                const IterationReport* first) const {
  const Convergence& c = parameters_.convergence;
  const bool by_value = c.measure == Measure::value;
  const double absolute = c.spacing > 0 ? default_residual(c.spacing, window.dt) : c.absolute;
  IterationReport row;
  row.iteration = iteration;
  row.force = now.force;
  if (parameters_.volume) return row;
  const std::vector<Column> quantity = measured();
  const auto add = [&](Sender sender, double residual, double scale, const Limits& limits) {
    const std::size_t k = row.fields.size();
    const double factor = transfer_.rms_factor(sender, quantity[k].name);
    row.fields.push_back(judge(quantity[k], factor * residual, factor * scale, limits,
                               first ? first->fields[k].residual : -1));
  };
  const StructureSample &guess = guess_of(now), &last = state_.structure.back();
  const auto add_structure = [&](const Values& answer, const Values& given, const Values& committed,
                                 double residual_of_velocity) {
    const double change = rms(answer - given);
    const double scale = by_value ? rms(answer) : &guess == &last ? change : rms(answer - committed);
    add(Sender::structure, std::max(change, residual_of_velocity), scale,
        {c.relative, row.fields.empty() ? absolute : 0, c.residual_relative});
  };
  if (const auto& motion = now.answer.motion)
    add_structure(motion->displacement, guess.motion->displacement, last.motion->displacement,
                  0.5 * window.dt * rms(motion->velocity - guess.motion->velocity));
  for (std::size_t k = 0; k < now.answer.others.size(); ++k)
    add_structure(now.answer.others[k].value, guess.others[k].value, last.others[k].value, 0);
  row.residual = row.fields.front().residual;
  row.threshold = row.fields.front().threshold;
  if (const Limits load = limits_of_load(); load.any())
    for (std::size_t k = 0; k < of_fluid_.size(); ++k) {
      const Field& before = parameters_.parallel ? now.load_guess[k] : now.load_before[k];
      add(Sender::fluid, rms(now.load[k].value - before.value), rms(now.load[k].value), load);
    }
  refuse_non_finite(row.fields, {"coupling", window, state_.windows + 1, iteration});
  return row;
}

void Scheme::rewind_all() {
  fluid_.rewind();
  structure_.rewind();
  attachments_.rewind();
}

WindowReport Scheme::retry(const Window& window, double limit, std::string why, std::string fix) const {
  WindowReport report;
  report.why = std::move(why);
  report.fix = std::move(fix);
  report.window = window;
  report.number = state_.windows + 1;
  report.retry = true;
  report.dt_limit = limit < window.dt ? limit : 0.5 * window.dt;
  return report;
}

void Scheme::stop_unconverged(const WindowReport& report) const {
  const IterationReport& last = report.log.back();
  std::string what;
  for (const FieldResidual& field : last.fields)
    if (!field.settled())
      what += fmt::format(", {} {:.1e} {}, wanted {:.1e} {}",
                          last.fields.size() > 1 ? field.quantity : "residual", field.residual, field.unit,
                          field.threshold, field.unit);
  throw Error(
      ExitCode::solver_fault, fmt::format("coupling, window {} (t = {:g} s)", report.number, report.window.t),
      fmt::format("did not converge\n{} iterations{}", last.iteration, what),
      "lower coupling.surface.window, raise converged.max_iterations, or accept and count such windows");
}

void Scheme::close(WindowReport& report, Iterate& now) {
  report.iterations = report.log.back().iteration;
  report.residual = report.log.back().residual;
  report.threshold = report.log.back().threshold;
  report.dt_limit = std::min({now.from_fluid.dt_limit, now.from_structure.dt_limit, attachments_.dt_limit()});
  report.attachments = attachments_.monitor();
  report.fluid = std::move(now.from_fluid.monitor);
  report.structure = std::move(now.from_structure.monitor);
  const Field *force = find(now.load, "force"), *wet = find(now.wet, "force");
  if (const auto& motion = now.answer.motion; motion && force) {
    const Values& displacement = motion->displacement;
    const Field increment = {"displacement", "m", false,
                             displacement - state_.structure.back().motion->displacement};
    const Values acting = transfer_.onto_moving(*force).value;
    report.work.fluid = dot(wet->value, transfer_.where_fluid_loads(increment).value);
    report.work.structure = dot(acting, increment.value);
    if (!parameters_.volume)
      report.work.unconverged = dot(acting, displacement - guess_of(now).motion->displacement);
    // In a parallel scheme the structure moved under another load than the fluid's.
    if (const Field* given = find(now.load_guess, "force"))
      report.work.unconverged += dot(MatrixXd(transfer_.onto_moving(*given).value - acting), increment.value);
    report.displacement = displacement;
    if (pending_.sends_velocity) report.velocity = motion->velocity;
    report.force = force->value;
  }
  const bool mechanical = is_mechanical();
  StructureSample sent = now.answer;
  if (mechanical) sent.motion.reset();
  if (sent.motion && !pending_.sends_velocity) sent.motion->velocity = {};
  report.from_structure = sent.fields();
  for (const Field& field : now.load)
    if (!mechanical || field.quantity != "force") report.from_fluid.push_back(field);
  if (!attachments_.none()) report.from_attachments = {{"force", "N", true, now.attached}};
  pending_.structure = std::move(now.answer);
  if (needs_last_load()) pending_.fluid = {report.window.t + report.window.dt, std::move(now.load)};
  pending_.history = std::move(now.history);
  pending_.structure_history = std::move(now.structure_history);
  pending_.accelerator = accelerator_->state();
  open_ = true;
}

void Scheme::commit(bool write_output) {
  assert(open_);
  fluid_.commit(write_output);
  structure_.commit(write_output);
  attachments_.commit(write_output);
  ++state_.windows;
  state_.velocity_scale = pending_.velocity_scale;
  state_.sends_velocity = pending_.sends_velocity;
  const Predictor kind = parameters_.volume ? Predictor::constant : parameters_.predictor;
  if (state_.windows == 2 && !state_.sends_velocity)
    correct_start(of_structure_, state_.structure.back(), pending_.structure);
  remember(state_.structure, std::move(pending_.structure), kind);
  if (needs_last_load()) {
    if (!parameters_.parallel)
      state_.fluid.clear();  // a first guess of the load is made in parallel schemes alone
    remember(state_.fluid, std::move(pending_.fluid), kind);
  }
  keep_earlier(state_.history, pending_.history);
  keep_earlier(state_.structure_history, pending_.structure_history);
  state_.accelerator = std::move(pending_.accelerator);
  open_ = false;
}

WindowReport advance_alone(Participant& participant, const Window& window) {
  WindowReport report;
  report.window = window;
  const Advanced advanced = participant.advance(window, {});
  if (advanced.retry_smaller_dt) {
    participant.rewind();
    report.retry = true;
    report.why = asks_for_shorter("the solver", window, advanced.why);
    report.fix = advanced.fix;
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
