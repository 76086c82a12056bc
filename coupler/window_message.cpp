#include "coupler/window_message.hpp"

#include <fmt/format.h>

#include <string_view>

#include "proto/error.hpp"

namespace strake {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::string_view of_fluid = "fluid/", of_structure = "structure/";
constexpr Index row_head = 9;  // numbers of an iteration before its fields

/// Each number of a window under its name, in one place for both directions.
template <class Visit, class Message>
void visit_numbers(Message& m, const Visit& visit) {
  auto& window = m.window;
  auto& report = window.report;
  visit("number", window.number);
  visit("time", window.time);
  visit("output", window.output);
  visit("last", window.last);
  visit("taken_back", window.taken_back);
  visit("begin", window.begin);
  visit("end", window.end);
  visit("t", report.window.t);
  visit("dt", report.window.dt);
  visit("iterations", report.iterations);
  visit("residual", report.residual);
  visit("threshold", report.threshold);
  visit("converged", report.converged);
  visit("limit", report.dt_limit);
  visit("work.fluid", report.work_fluid);
  visit("work.structure", report.work_structure);
  visit("work.unconverged", report.work_unconverged);
  visit("loop.time", m.state.time);
  visit("loop.windows", m.state.windows);
  visit("loop.length", m.state.length);
  visit("loop.settled", m.state.settled);
  visit("loop.limit", m.state.limit);
}

MatrixXd log_of(const std::vector<IterationReport>& log) {
  const Index fields = log.empty() ? 0 : static_cast<Index>(log.front().fields.size());
  MatrixXd rows(row_head + 2 * fields, static_cast<Index>(log.size()));
  for (Index i = 0; i < rows.cols(); ++i) {
    const IterationReport& row = log[static_cast<std::size_t>(i)];
    rows.col(i).head(row_head) << row.iteration, row.residual, row.threshold, row.relaxation, row.columns,
        row.dropped, row.force;
    for (Index k = 0; k < fields; ++k) {
      const FieldResidual& field = row.fields[static_cast<std::size_t>(k)];
      rows.col(i).segment<2>(row_head + 2 * k) << field.residual, field.threshold;
    }
  }
  return rows;
}

std::vector<IterationReport> log_of(const MatrixXd& rows, const std::vector<Column>& measured) {
  std::vector<IterationReport> log;
  for (Index i = 0; i < rows.cols(); ++i) {
    const auto value = rows.col(i);
    IterationReport row;
    row.iteration = static_cast<int>(value[0]);
    row.residual = value[1];
    row.threshold = value[2];
    row.relaxation = value[3];
    row.columns = static_cast<int>(value[4]);
    row.dropped = static_cast<int>(value[5]);
    row.force = value.segment<3>(6);
    for (Index k = 0; row_head + 2 * k < rows.rows(); ++k) {
      const Column& column = measured[static_cast<std::size_t>(k)];
      row.fields.push_back({column.name, column.unit, value[row_head + 2 * k], value[row_head + 2 * k + 1]});
    }
    log.push_back(std::move(row));
  }
  return log;
}

// Nanoseconds of a steady clock are exact in a double for a hundred days.
MatrixXd times_of(const std::vector<Exchange>& exchanges) {
  MatrixXd times(6, static_cast<Index>(exchanges.size()));
  for (Index i = 0; i < times.cols(); ++i) {
    const Exchange& e = exchanges[static_cast<std::size_t>(i)];
    times.col(i) << (e.participant == "fluid" ? 1 : 0), e.iteration, static_cast<double>(e.sent),
        static_cast<double>(e.heard), static_cast<double>(e.received), static_cast<double>(e.answered);
  }
  return times;
}

std::vector<Exchange> exchanges_of(const MatrixXd& times, long window) {
  std::vector<Exchange> exchanges;
  for (Index i = 0; i < times.cols(); ++i) {
    const auto value = times.col(i);
    exchanges.push_back({.participant = value[0] == 1 ? "fluid" : "structure",
                         .asked = "Advance",
                         .window = window,
                         .iteration = static_cast<std::uint32_t>(value[1]),
                         .sent = static_cast<std::int64_t>(value[2]),
                         .heard = static_cast<std::int64_t>(value[3]),
                         .received = static_cast<std::int64_t>(value[4]),
                         .answered = static_cast<std::int64_t>(value[5])});
  }
  return exchanges;
}

[[noreturn]] void missing(const std::string& what) {
  throw Error(ExitCode::participant_lost, "fluid", fmt::format("reports a window without {}", what),
              "use programs of one version");
}

const Values& field(const Advanced& message, const std::string& name) {
  const Field* found = find(message.output, name);
  if (found == nullptr) missing(name);
  return found->value;
}

}  // namespace

Advanced to_message(WindowMessage m) {
  Advanced message;
  visit_numbers(
      m, [&](const char* name, auto value) { message.monitor.emplace(name, static_cast<double>(value)); });
  WindowReport& report = m.window.report;
  for (const auto& [name, value] : report.fluid) message.monitor.emplace(std::string(of_fluid) + name, value);
  for (const auto& [name, value] : report.structure)
    message.monitor.emplace(std::string(of_structure) + name, value);
  message.why = m.window.why;
  message.output.push_back({"log", "1", false, log_of(report.log)});
  message.output.push_back({"exchanges", "ns", false, times_of(m.exchanges)});
  message.output.push_back({"displacement", "m", false, std::move(report.displacement)});
  message.output.push_back({"velocity", "m/s", false, std::move(report.velocity)});
  message.output.push_back({"force", "N", true, std::move(report.force)});
  message.history = {{0, std::move(report.from_structure)}, {0, std::move(report.from_fluid)}};
  return message;
}

WindowMessage from_message(const Advanced& message, const std::vector<Column>& measured) {
  WindowMessage m;
  visit_numbers(m, [&](const char* name, auto& value) {
    const auto found = message.monitor.find(name);
    if (found == message.monitor.end()) missing(name);
    value = static_cast<std::remove_reference_t<decltype(value)>>(found->second);
  });
  WindowReport& report = m.window.report;
  report.number = static_cast<int>(m.window.number);
  for (const auto& [name, value] : message.monitor) {
    if (name.starts_with(of_fluid)) report.fluid.emplace(name.substr(of_fluid.size()), value);
    if (name.starts_with(of_structure)) report.structure.emplace(name.substr(of_structure.size()), value);
  }
  m.window.why = message.why;
  const MatrixXd& log = field(message, "log");
  if (log.rows() != row_head && log.rows() != row_head + 2 * static_cast<Index>(measured.size()))
    missing("the numbers of its iterations");
  report.log = log_of(log, measured);
  const MatrixXd& times = field(message, "exchanges");
  if (times.rows() != 6) missing("the times of its exchanges");
  m.exchanges = exchanges_of(times, m.window.number);
  for (const auto& [name, points] : {std::pair{"displacement", &report.displacement},
                                     {"velocity", &report.velocity},
                                     {"force", &report.force}}) {
    const Values& value = field(message, name);
    if (value.rows() != 3) missing(name);
    *points = value;
  }
  if (message.history.size() != 2) missing("the fields of either side");
  report.from_structure = message.history[0].fields;
  report.from_fluid = message.history[1].fields;
  return m;
}

}  // namespace strake
