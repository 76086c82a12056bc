#include "coupler/run/run_files.hpp"

#include "coupler/summary/history_metrics.hpp"
#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <cmath>

namespace strake {

namespace {

std::string residual_unit(const RunFiles::Options& options) {
  return options.measured.empty() ? "m" : options.measured.front().unit;
}

std::vector<Column> history_columns(const RunFiles::Options& options) {
  const int dimension = options.dimension;
  std::vector<Column> columns = {{"window", "1"}, {"time", "s"}};
  if (options.coupled) {
    columns.insert(columns.end(), {{"iterations", "1"}, {"residual", residual_unit(options)}});
  }
  if (options.coupled && options.mechanical) {
    const std::string newton = dimension == 2 ? "N/m" : "N";
    columns.insert(columns.end(), {{"force.x", newton}, {"force.y", newton}});
    if (dimension == 3) columns.push_back({"force.z", newton});
    if (options.tells_moment && dimension == 2) columns.push_back({"moment.z", "N"});
    if (options.tells_moment && dimension == 3)
      columns.insert(columns.end(), {{"moment.x", "N m"}, {"moment.y", "N m"}, {"moment.z", "N m"}});
    columns.push_back({"work_gap", "1"});
  }
  columns.insert(columns.end(), options.columns.begin(), options.columns.end());
  return columns;
}

std::vector<Column> iteration_columns(const RunFiles::Options& options) {
  const int dimension = options.dimension;
  const std::string newton = dimension == 2 ? "N/m" : "N", unit = residual_unit(options);
  std::vector<Column> columns = {{"window", "1"},    {"time", "s"},       {"iteration", "1"},
                                 {"residual", unit}, {"threshold", unit}, {"relaxation", "1"},
                                 {"columns", "1"},   {"dropped", "1"}};
  if (options.mechanical) columns.insert(columns.end(), {{"force.x", newton}, {"force.y", newton}});
  if (options.mechanical && dimension == 3) columns.push_back({"force.z", newton});
  for (std::size_t k = 1; k < options.measured.size(); ++k) {
    const auto& [quantity, own_unit] = options.measured[k];
    columns.push_back({"residual." + quantity, own_unit});
    columns.push_back({"threshold." + quantity, own_unit});
  }
  return columns;
}

/// Opens a column file, or continues one. It keeps the lines of earlier windows byte for byte, and cuts the
/// file behind them in one step. So an interrupted resume loses nothing.
std::unique_ptr<History> open(const std::filesystem::path& path, const std::vector<Column>& columns,
                              const std::optional<LoopState>& resumed, Table* table) {
  if (!resumed || resumed->windows == 0) return std::make_unique<History>(path, columns);
  Table before = read_table(path);
  std::size_t rows = 0;
  double windows = 0;
  if (before.columns.size() > 1)
    for (; rows < before.rows() && before.value[0][rows] <= static_cast<double>(resumed->windows); ++rows)
      windows = before.value[0][rows];
  if (windows != static_cast<double>(resumed->windows))
    throw Error(ExitCode::case_file, path.string(),
                fmt::format("ends with window {}, the checkpoint was taken after window {}", windows,
                            resumed->windows),
                "run it again with --force, or under another --tag");
  auto history = std::make_unique<History>(path, columns, rows);
  if (table == nullptr) return history;
  for (std::size_t column = 0; column < before.columns.size(); ++column) {
    before.value[column].resize(rows);
    table->value[column] = std::move(before.value[column]);
  }
  return history;
}

/// Whether a run that is continued writes a column: where it was begun by another version, that one decides.
/// otherwise: of a run that begins.
bool writes(const std::string& column, const std::filesystem::path& history,
            const std::optional<LoopState>& resumed, bool otherwise) {
  std::error_code none;
  if (!resumed || resumed->windows == 0 || !std::filesystem::exists(history, none)) return otherwise;
  return read_table(history).find(column).has_value();
}

void add_force(std::vector<double>& row, const Eigen::Vector3d& force, int dimension) {
  row.push_back(force.x());
  row.push_back(force.y());
  if (dimension == 3) row.push_back(force.z());
}

}  // namespace

RunFiles::RunFiles(Options options) : options_(std::move(options)) {
  const auto& folder = options_.folder;
  const std::filesystem::path history = folder / "history.csv";
  options_.tells_moment = writes("moment.z", history, options_.resumed, true);
  options_.mechanical = writes("force.y", history, options_.resumed, options_.mechanical);
  table_.columns = history_columns(options_);
  table_.value.resize(table_.columns.size());
  history_ = open(history, table_.columns, options_.resumed, &table_);
  if (!options_.coupled) return;
  iterations_ = open(folder / "iterations.csv", iteration_columns(options_), options_.resumed, nullptr);
  interface_ = std::make_unique<InterfaceRecorder>(folder, options_.mesh, options_.initial);
  if (options_.resumed) interface_->resume(options_.resumed->time);
}

void RunFiles::add_moment(std::vector<double>& row, const WindowReport& report) const {
  const Eigen::Vector3d moment =
      moment_about_middle(options_.mesh.position, report.displacement, report.force);
  if (options_.dimension == 3) row.insert(row.end(), {moment.x(), moment.y()});
  row.push_back(moment.z());
}

void RunFiles::append(const CommittedWindow& window, const std::vector<double>& values, double wall) {
  const WindowReport& report = window.report;
  std::vector<double> row = {static_cast<double>(window.number), window.time};
  if (options_.coupled) {
    row.push_back(report.iterations);
    row.push_back(report.residual);
  }
  if (options_.coupled && options_.mechanical) {
    add_force(row, report.total_force(), options_.dimension);
    if (options_.tells_moment) add_moment(row, report);
    row.push_back(report.work.gap());
  }
  row.insert(row.end(), values.begin(), values.end());
  history_->append(row);
  for (std::size_t i = 0; i < row.size(); ++i) table_.value[i].push_back(row[i]);

  for (const IterationReport& iteration : options_.coupled ? report.log : std::vector<IterationReport>{}) {
    std::vector<double> values_of = {static_cast<double>(window.number),
                                     window.time,
                                     static_cast<double>(iteration.iteration),
                                     iteration.residual,
                                     iteration.threshold,
                                     iteration.relaxation,
                                     static_cast<double>(iteration.columns),
                                     static_cast<double>(iteration.dropped)};
    if (options_.mechanical) add_force(values_of, iteration.force, options_.dimension);
    for (std::size_t k = 1; k < iteration.fields.size(); ++k) {
      values_of.push_back(iteration.fields[k].residual);
      values_of.push_back(iteration.fields[k].threshold);
    }
    iterations_->append(values_of);
  }
  if (interface_)
    interface_->append(report.window, report.displacement, report.velocity, report.force,
                       report.from_structure, report.from_fluid, report.from_attachments);
  append_timing(window, wall);
}

/// Opens timing.csv. It contains clock times only: if it cannot be continued, it is set aside and the run
/// continues.
std::unique_ptr<History> RunFiles::open_timing(const std::vector<Column>& columns) const {
  const std::filesystem::path path = options_.folder / "timing.csv";
  try {
    return open(path, columns, options_.resumed, nullptr);
  } catch (const Error& error) {
    if (error.code() != ExitCode::case_file) throw;
    std::filesystem::path aside;
    std::error_code none;
    for (int n = 1; aside.empty() || std::filesystem::exists(aside, none); ++n)
      aside = options_.folder / fmt::format("timing-{}.csv", n);
    std::filesystem::rename(path, aside, none);
    if (options_.say)
      options_.say(fmt::format("{}: {}; it begins anew{}", error.where(), error.problem(),
                               none ? "" : ", what it held is in " + aside.filename().string()));
    return std::make_unique<History>(path, columns);
  }
}

void RunFiles::append_timing(const CommittedWindow& window, double wall) {
  const WindowReport& report = window.report;
  if (!timing_) {
    std::vector<Column> columns = {{"window", "1"}, {"time", "s"}, {"wall", "s"}};
    for (const bool fluid : {true, false})
      for (const auto& [name, seconds] : fluid ? report.fluid : report.structure)
        if (name.starts_with("seconds.")) {
          stages_.emplace_back(fluid, name);
          columns.push_back({(fluid ? "fluid." : "structure.") + name.substr(name.find('.') + 1), "s"});
        }
    timing_ = open_timing(columns);
  }
  std::vector<double> row = {static_cast<double>(window.number), window.time, wall};
  for (const auto& [fluid, name] : stages_)
    row.push_back(at_or(fluid ? report.fluid : report.structure, name, std::nan("")));
  timing_->append(row);
}

void RunFiles::flush() {
  for (History* table : {history_.get(), iterations_.get()})
    if (table) table->sync();
  if (interface_) interface_->flush();
  sync_to_disk(options_.folder);
}

}  // namespace strake
