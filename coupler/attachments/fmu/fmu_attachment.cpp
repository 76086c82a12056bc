#include "coupler/attachments/fmu/fmu_attachment.hpp"

#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>

namespace strake {
namespace {

using Eigen::MatrixXd;

constexpr std::size_t most_columns = 32, longest_name = 150;  // [bytes]
constexpr double same_step = 1e-6;                            // relative difference of equal steps

/// Displacement and velocity of k points, 3×k each. A velocity that is not sent is zero.
std::pair<MatrixXd, MatrixXd> motion_in(const std::vector<Field>& fields, Eigen::Index k,
                                        const std::string& name) {
  const Field *displacement = find(fields, "displacement"), *velocity = find(fields, "velocity");
  const auto fits = [k](const Field& field) { return field.value.rows() == 3 && field.value.cols() == k; };
  if (displacement == nullptr || !fits(*displacement))
    throw Error(ExitCode::participant_lost, name,
                fmt::format("the coupler sent no displacement of {} points", k));
  const bool has_velocity = velocity != nullptr && fits(*velocity);
  return {displacement->value, has_velocity ? MatrixXd(velocity->value) : MatrixXd(MatrixXd::Zero(3, k))};
}

/// A variable's name as that of a column: history.csv keeps brackets and commas for itself, and the coupler
/// some prefixes.
std::string column_of(const std::string& variable) {
  constexpr std::array<std::pair<char, char>, 4> replaced = {
      {{'[', '('}, {']', ')'}, {',', ';'}, {':', '_'}}};
  std::string name = visible(variable.substr(0, longest_name), "");
  for (const auto& [from, to] : replaced) std::replace(name.begin(), name.end(), from, to);
  for (const char* prefix : {"seconds.", "count.", "check.", "memory.", "alarm."})
    if (name.starts_with(prefix)) return "fmu." + name;
  return name;
}

/// Bytes as 64-bit integers, the last one filled up with zeros.
template <class Bytes>
std::vector<std::int64_t> packed(const Bytes& bytes) {
  std::vector<std::int64_t> words((bytes.size() + sizeof(std::int64_t) - 1) / sizeof(std::int64_t));
  if (!bytes.empty()) std::memcpy(words.data(), bytes.data(), bytes.size());
  return words;
}

}  // namespace

FmuAttachment::FmuAttachment(FmuParameters parameters, const Setup& setup, double start_time)
    : parameters_(std::move(parameters)),
      points_(setup.partner_mesh),
      package_(parameters_.file),
      model_(read_model_description(package_)),
      connections_(connect(parameters_, model_, points_.position.cols(), points_.dimension)),
      instance_(model_, package_, parameters_.name) {
  points_.name = parameters_.name;
  points_.parts.clear();
  const Eigen::Index k = points_.position.cols();
  auto [displacement, velocity] = motion_in(setup.partner_initial, k, parameters_.name);
  committed_ = {start_time, std::move(displacement), std::move(velocity), MatrixXd::Zero(3, k)};
  last_ = committed_;
  describe();
  for (const FmuInput& input : connections_.inputs) set_.push_back(input.variable);
  for (const FmuSetting& one : connections_.settings) instance_.set_parameter(one.variable, one.value);
  instance_.enter_initialization(start_time);
  instance_.set(set_, mean_inputs(committed_, committed_));
  instance_.exit_initialization();
  outputs_ = instance_.get(read_);
  last_.force = force_in(outputs_);
  committed_ = last_;
  description_.initial = {{"force", "N", true, committed_.force}};
  if (can_rewind()) instance_.keep_state();
}

/// Columns of the connected outputs, then of the FMU's other ones; what is known of it, for people.
void FmuAttachment::describe() {
  description_.cannot_resume = !model_.can_serialize_state;
  const auto add = [&](const FmuVariable& variable) {
    read_.push_back(variable.reference);
    columns_.push_back(column_of(variable.name));
    const auto has_name = [&](const Column& column) { return column.name == columns_.back(); };
    auto& columns = description_.columns;
    if (std::none_of(columns.begin(), columns.end(), has_name))
      columns.push_back({columns_.back(), variable.unit.empty() ? "1" : column_of(variable.unit)});
  };
  for (const FmuOutput& output : connections_.outputs) add(*model_.find(output.name));
  for (const FmuVariable& variable : model_.variables) {
    const bool is_scalar = variable.type == "Float64" && !variable.is_array && !variable.is_clocked;
    const bool is_read = std::find(read_.begin(), read_.end(), variable.reference) != read_.end();
    if (variable.causality == "output" && is_scalar && !is_read && read_.size() < most_columns) add(variable);
  }
  const Eigen::Index k = points_.position.cols();
  const auto counted = [](std::size_t n, const std::string& what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  auto& lines = description_.lines;
  lines.push_back(fmt::format("{}   {}, {}, {}, {}", visible(package_.file().filename().string(), ""),
                              visible(model_.model, ""), counted(static_cast<std::size_t>(k), "point"),
                              counted(connections_.inputs.size(), "input"),
                              counted(connections_.outputs.size(), "output")));
  add_unconnected(lines);
  if (!can_rewind()) lines.push_back(std::string("cannot take back its state: ") + explicit_coupling);
  if (description_.cannot_resume) lines.push_back("cannot save its state: the run cannot be resumed");
  if (model_.fixed_internal_step > 0)
    lines.push_back(fmt::format("steps of {:.6g} s inside: windows of twice as much, or a multiple of that",
                                model_.fixed_internal_step));
}

/// Names the inputs that nothing sets, and the points that get no force.
void FmuAttachment::add_unconnected(std::vector<std::string>& lines) const {
  std::vector<std::string> idle, free;
  for (const FmuVariable& variable : model_.variables)
    if (variable.causality == "input" &&
        std::none_of(connections_.inputs.begin(), connections_.inputs.end(),
                     [&](const FmuInput& input) { return input.variable == variable.reference; }))
      idle.push_back(visible(variable.name, "") +
                     (variable.start.empty() ? "" : " = " + visible(variable.start, "")));
  for (Eigen::Index point = 0; point < points_.position.cols(); ++point)
    if (std::none_of(connections_.outputs.begin(), connections_.outputs.end(),
                     [&](const FmuOutput& output) { return output.at.point == point; }))
      free.push_back(fmt::format("{}", point + 1));
  if (!idle.empty()) lines.push_back("inputs that keep their start: " + joined(idle));
  if (!free.empty()) lines.push_back("points without a force: " + joined(free));
}

std::vector<double> FmuAttachment::mean_inputs(const State& from, const State& to) const {
  std::vector<double> values;
  for (const FmuInput& input : connections_.inputs) {
    const auto member = input.quantity == PointMotion::velocity ? &State::velocity : &State::displacement;
    values.push_back(
        0.5 * ((from.*member)(input.at.axis, input.at.point) + (to.*member)(input.at.axis, input.at.point)));
  }
  return values;
}

/// 3×k [N]. The connected outputs come first in `values`. Refuses one that is no number.
MatrixXd FmuAttachment::force_in(const std::vector<double>& values) const {
  MatrixXd force = MatrixXd::Zero(3, points_.position.cols());
  for (std::size_t i = 0; i < connections_.outputs.size(); ++i) {
    const FmuOutput& output = connections_.outputs[i];
    if (!std::isfinite(values[i]))
      throw Error(ExitCode::solver_fault, fmt::format("{}, t = {:.9g} s", parameters_.name, last_.time),
                  fmt::format("the FMU gives {} = {}", visible(output.name, ""), values[i]),
                  "look at its parameters, or compute shorter windows (coupling.surface.window)");
    force(output.at.axis, output.at.point) = values[i];
  }
  return force;
}

/// Refuses a step that an FMU with steps of one length cannot take.
void FmuAttachment::check_step(double step) {
  if (model_.variable_step) return;
  const std::string where = "attachments." + parameters_.name + ".fmu.file";
  const double inside = model_.fixed_internal_step, ratio = inside > 0 ? step / inside : 1;
  if (ratio < 0.5 || std::abs(ratio - std::round(ratio)) > same_step * ratio)
    throw Error(
        ExitCode::case_file, where,
        fmt::format("the FMU has fixed steps of {:.9g} s, and half a window, which it is asked for, is "
                    "{:.9g} s",
                    inside, step),
        fmt::format("coupling.surface.window = {:.9g}, or a multiple of it", 2 * inside));
  if (only_step_ && std::abs(step - *only_step_) > same_step * *only_step_)
    throw Error(ExitCode::case_file, where,
                fmt::format("the FMU cannot vary its step (canHandleVariableCommunicationStepSize): {:.9g} s "
                            "after {:.9g} s",
                            step, *only_step_),
                "windows of one length: a coupling.surface.window that divides end_time, and no solver that "
                "asks for shorter ones");
  only_step_ = step;
}

void FmuAttachment::start(const Window& window, const Input& input) {
  const auto begin = std::chrono::steady_clock::now();
  discarded_.reset();
  window_ = window;
  if (input.samples.empty())
    throw Error(ExitCode::participant_lost, parameters_.name, "the coupler sent no motion");
  auto [displacement, velocity] =
      motion_in(input.samples.back().fields, points_.position.cols(), parameters_.name);
  last_ = {window.t + window.dt, std::move(displacement), std::move(velocity), committed_.force};
  const double half = 0.5 * window.dt;
  try {
    check_step(half);
    ahead_ = true;
    instance_.set(set_, mean_inputs(committed_, last_));
    instance_.step(window.t, half);
    last_.force = force_in(instance_.get(read_));
    instance_.step(window.t + half, half);
    outputs_ = instance_.get(read_);
  } catch (const FmuDiscarded& discarded) {
    discarded_ = discarded;
  } catch (const Error&) {  // the coupler may end this process as soon as it hears of it
    package_.remove();
    throw;
  }
  if (discarded_ && !can_rewind())
    throw Error(ExitCode::solver_fault, fmt::format("{}, t = {:.9g} s", parameters_.name, window.t),
                discarded_->why + "\nand it cannot take back its state to try a shorter window",
                "a shorter coupling.surface.window");
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

Advanced FmuAttachment::finish() {
  Advanced answer;
  answer.monitor["seconds.step"] = seconds_;
  if (discarded_) {
    answer.retry_smaller_dt = true;
    answer.dt_limit = 0.5 * window_.dt;
    answer.why = discarded_->why;
    return answer;
  }
  answer.output = {{"force", "N", true, last_.force}};
  for (std::size_t i = 0; i < columns_.size(); ++i) answer.monitor[columns_[i]] = outputs_[i];
  return answer;
}

void FmuAttachment::rewind() {
  if (!ahead_) return;
  if (!can_rewind())
    throw Error(ExitCode::case_file, "attachments." + parameters_.name + ".fmu.file",
                "the FMU cannot take back its state (canGetAndSetFMUState), and a window is to be computed "
                "again",
                explicit_coupling);
  instance_.restore_state();
  last_ = committed_;
  ahead_ = false;
}

void FmuAttachment::commit(bool /*write_output*/) {
  if (can_rewind()) instance_.keep_state();
  committed_ = last_;
  ahead_ = false;
}

void FmuAttachment::checkpoint(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / (parameters_.name + ".h5");
  if (description_.cannot_resume)
    throw Error(ExitCode::cannot_write, file.string(), "the FMU cannot save its state (canSerializeFMUState)",
                "a run without checkpoints");
  const std::vector<fmi3Byte> state = instance_.serialized();
  Archive archive;
  archive.real["time"] = MatrixXd::Constant(1, 1, committed_.time);
  archive.real["displacement"] = committed_.displacement;
  archive.real["velocity"] = committed_.velocity;
  archive.real["force"] = committed_.force;
  archive.integer["state"] = packed(state);
  archive.integer["state.bytes"] = {static_cast<std::int64_t>(state.size())};
  archive.integer["token"] = packed(model_.instantiation_token);
  write_archive(file, archive);
}

void FmuAttachment::resume(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / (parameters_.name + ".h5");
  const Archive archive = read_archive(file);
  const auto refuse = [&](const std::string& problem) -> Error {
    return {ExitCode::case_file, file.string(), problem,
            "resume with the case that the checkpoint was made with"};
  };
  const auto matrix = [&](const std::string& name, Eigen::Index rows, Eigen::Index columns) -> MatrixXd {
    const auto found = archive.real.find(name);
    if (found == archive.real.end() || found->second.rows() != rows || found->second.cols() != columns)
      throw refuse(fmt::format("has no {} of an FMU at {} points", name, points_.position.cols()));
    return found->second;
  };
  const auto words = [&](const std::string& name) -> std::vector<std::int64_t> {
    const auto found = archive.integer.find(name);
    if (found == archive.integer.end()) throw refuse(fmt::format("has no {} of an FMU", name));
    return found->second;
  };
  const Eigen::Index k = points_.position.cols();
  State saved{matrix("time", 1, 1)(0, 0), matrix("displacement", 3, k), matrix("velocity", 3, k),
              matrix("force", 3, k)};
  if (words("token") != packed(model_.instantiation_token))
    throw refuse("is of another FMU than " + package_.file().string());
  const std::vector<std::int64_t> state = words("state"), size = words("state.bytes");
  const std::size_t room = state.size() * sizeof(std::int64_t);
  if (size.size() != 1 || size[0] < 0 || static_cast<std::size_t>(size[0]) > room ||
      room - static_cast<std::size_t>(size[0]) >= sizeof(std::int64_t))
    throw refuse("has a damaged state of an FMU");
  if (description_.cannot_resume)
    throw refuse("is of an FMU that could save its state, which this one cannot");
  std::vector<fmi3Byte> bytes(static_cast<std::size_t>(size[0]));
  if (!bytes.empty()) std::memcpy(bytes.data(), state.data(), bytes.size());
  instance_.deserialize(bytes);
  committed_ = last_ = std::move(saved);
  ahead_ = false;
}

}  // namespace strake
