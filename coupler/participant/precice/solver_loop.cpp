#include "coupler/participant/precice/solver_loop.hpp"

#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

namespace strake {
namespace {

/// Parts of a window at whose ends a structure reads the partner's samples. Measured with
/// tests/precice/own/entry.toml, five steps of the fluid in a window, against samples that Strake's coupler
/// hands on. With 4, 6, 8, 10, 16 parts the deflection differs by 0.8, 0.4, 0.4, 0.03, 0.07 % (history), and
/// 0.5, 0.7, 1.2, 1.2, 1.6 % (mean).
constexpr int parts_with_samples = 8;
constexpr double round_off = 1e-9;  // of a window

/// The fields that a solver announces; a fluid that announces none begins with a force of zero.
std::vector<Field> first_fields(const Participant& solver) {
  const std::vector<Field>& announced = solver.description().initial;
  if (!announced.empty()) return announced;
  return {{"force", "N", true, Eigen::MatrixXd::Zero(3, solver.mesh().position.cols())}};
}

}  // namespace

SolverLoop::SolverLoop(const PreciceLibrary& library, const OwnPart& part, Participant& solver,
                       OwnResults& results, std::string side)
    : library_(library),
      part_(part),
      solver_(solver),
      results_(results),
      side_(std::move(side)),
      exchange_(library, part, solver.mesh()) {}

std::string SolverLoop::place(const Window& window) const {
  return fmt::format("{}, window {} (t = {:.6g} s)", side_, times_.windows() + 1, window.t);
}

/// The mean of a load over the window: of its values at the ends of equal parts, where the partner sends
/// samples. They are means themselves if the partner is a fluid of Strake.
std::vector<Field> SolverLoop::mean_load(const Window& window) const {
  std::vector<Field> mean = exchange_.read(window.dt);
  for (int k = 1; k < parts_with_samples; ++k) {
    const std::vector<Field> other = exchange_.read(k * window.dt / parts_with_samples);
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i].value.edit() += other[i].value;
  }
  for (Field& field : mean) field.value.edit() /= parts_with_samples;
  return mean;
}

/// A motion at the window's end. A load as its mean, or as a history if the solver takes one: at the window's
/// start and end, and between them if the partner sends samples.
Input SolverLoop::input_of(const Window& window) const {
  Input input;
  input.wants_history = part_.writes_samples;
  if (part_.reads.empty()) return input;
  const bool history = solver_.description().history, is_load = side_ == "structure";
  const double end = window.t + window.dt;
  if (is_load && part_.reads_samples && !history) {
    input.samples.push_back({end, mean_load(window)});
    return input;
  }
  const int parts = part_.reads_samples ? parts_with_samples : 1;
  for (int k = 0; history && k < parts; ++k) {
    const double from_now = k * window.dt / parts;
    input.samples.push_back({window.t + from_now, exchange_.read(from_now)});
  }
  input.samples.push_back({end, exchange_.read(window.dt)});
  return input;
}

void SolverLoop::check_length(const Window& window, double limit, const std::string& why,
                              const std::string& fix) const {
  std::string remedy = fmt::format(
      "a time-window-size of at most {:.3g} s in the configuration: no function of "
      "preCICE asks for a shorter window",
      limit);
  if (!fix.empty()) remedy = fix + "\n" + remedy;
  throw Error(ExitCode::solver_fault, place(window),
              fmt::format("cannot take a window of {:.6g} s{}{}", window.dt, why.empty() ? "" : ": ", why),
              remedy);
}

/// The samples of a window one after the other, each with a step to its time; without samples its end alone.
void SolverLoop::write_window(const Window& window, const Advanced& answer) const {
  double done = 0;
  for (const Sample& sample : answer.history) {
    const double step = sample.time - window.t - done;
    if (!part_.writes_samples || done + step >= window.dt * (1 - round_off)) break;
    exchange_.write(sample.fields, place(window));
    library_.advance(step);
    done += step;
  }
  const bool sampled = part_.writes_samples && !answer.history.empty();
  exchange_.write(sampled ? answer.history.back().fields : answer.output, place(window));
  library_.advance(library_.longest_step());
}

void SolverLoop::run() {
  if (library_.needs_initial_data() != 0) exchange_.write(first_fields(solver_), side_ + ", at the start");
  library_.initialize();
  int iterations = 0;
  double limit = solver_.description().dt_limit;
  while (library_.is_ongoing() != 0) {
    library_.needs_checkpoint();  // the last commit is the checkpoint
    const Window window = times_.begin(library_.longest_step());
    if (window.dt > limit * (1 + round_off)) check_length(window, limit, "the solver's limit", "");
    const Advanced answer = solver_.advance(window, input_of(window));
    if (answer.retry_smaller_dt) check_length(window, answer.dt_limit, answer.why, answer.fix);
    write_window(window, answer);
    ++iterations;
    ++iterations_;
    if (library_.needs_rewind() != 0) {
      solver_.rewind();
      continue;
    }
    const bool last = library_.is_ongoing() == 0;
    times_.end(window);
    solver_.commit(last || results_.frame_due(window));
    results_.append(times_.windows(), times_.time(), std::exchange(iterations, 0), answer.monitor);
    limit = answer.dt_limit;
  }
  solver_.flush();
}

namespace {

constexpr double slack = 1e-6;  // of a window, as in the coupler's loop

}  // namespace

OwnResults::OwnResults(std::filesystem::path folder, double every, const Description& description)
    : every_(every), columns_(description.columns) {
  if (folder.empty()) return;
  std::vector<Column> columns = {{"window", "1"}, {"time", "s"}, {"iterations", "1"}};
  columns.insert(columns.end(), columns_.begin(), columns_.end());
  history_.emplace(folder / "history.csv", std::move(columns));
}

bool OwnResults::frame_due(const Window& window) const {
  if (every_ <= 0) return false;
  const double tolerance = slack * window.dt, every = std::max(every_, tolerance);
  return std::floor((window.t + window.dt + tolerance) / every) > std::floor((window.t + tolerance) / every);
}

void OwnResults::append(long window, double time, int iterations,
                        const std::map<std::string, double>& monitor) {
  if (!history_) return;
  std::vector<double> row = {static_cast<double>(window), time, static_cast<double>(iterations)};
  for (const Column& column : columns_) row.push_back(at_or(monitor, column.name, std::nan("")));
  history_->append(row);
}

void make_results_folder(const std::filesystem::path& folder) {
  std::error_code failed;
  if (std::filesystem::exists(folder / "history.csv", failed))
    throw Error(ExitCode::command_line, "--into " + folder.string(), "holds the history of another run",
                "name a new folder, or remove that one");
  std::filesystem::create_directories(folder, failed);
  if (failed) throw cannot_write(folder, failed.value());
}

namespace {

using Eigen::Index;

std::string unit_of(const std::string& quantity) {
  if (quantity == "force") return "N";
  if (quantity == "displacement") return "m";
  return quantity == "velocity" ? "m/s" : "1";
}

/// The numbers of the vertices of all faces, one face after the other.
std::vector<int> corners_of(const Eigen::MatrixXi& faces, const std::vector<int>& ids) {
  std::vector<int> corners;
  for (Index f = 0; f < faces.cols(); ++f)
    for (Index k = 0; k < faces.rows(); ++k) corners.push_back(ids[static_cast<std::size_t>(faces(k, f))]);
  return corners;
}

}  // namespace

InterfaceExchange::InterfaceExchange(const PreciceLibrary& library, const OwnPart& part,
                                     const InterfaceMesh& mesh)
    : library_(library), part_(part), ids_(static_cast<std::size_t>(mesh.position.cols())) {
  if (ids_.empty())
    throw Error(ExitCode::case_file, fmt::format("mesh \"{}\"", part.mesh),
                "would have no points: no water meets the body",
                "is the body inside the tank? Has it faces? strake-structure-… CASE --interface prints them");
  const Eigen::MatrixXd position = mesh.position.topRows(part.dimension);
  const char* name = part.mesh.c_str();
  library.set_vertices(name, static_cast<int>(ids_.size()), position.data(), ids_.data());
  if (mesh.faces.cols() == 0 || library.needs_faces(name) == 0) return;
  const std::vector<int> corners = corners_of(mesh.faces, ids_);
  const auto set = part.dimension == 2 ? library.set_edges : library.set_triangles;
  set(name, static_cast<int>(mesh.faces.cols()), corners.data());
}

std::vector<Field> InterfaceExchange::read(double from_now) const {
  std::vector<Field> fields;
  const auto n = static_cast<Index>(ids_.size());
  for (const OwnPart::Data& data : part_.reads) {
    Eigen::MatrixXd value(data.components, n);
    library_.read(part_.mesh.c_str(), data.name.c_str(), static_cast<int>(n), ids_.data(), from_now,
                  value.data());
    if (data.components == 2) {
      value.conservativeResize(3, n);
      value.row(2).setZero();
    }
    fields.push_back({data.quantity, unit_of(data.quantity), data.quantity == "force", std::move(value)});
  }
  return fields;
}

void InterfaceExchange::write(const std::vector<Field>& fields, const std::string& when) const {
  const auto n = static_cast<Index>(ids_.size());
  for (const OwnPart::Data& data : part_.writes) {
    const Field* field = find(fields, data.quantity);
    if (!field || field->value.cols() != n || field->value.rows() < data.components)
      throw Error(
          ExitCode::solver_fault, when,
          fmt::format("the solver gives no {} there, which data \"{}\" stands for", data.quantity, data.name),
          fmt::format("leave \"{}\" out of the configuration", data.name));
    const Eigen::MatrixXd value = field->value.topRows(data.components);
    if (!all_finite(value))
      throw Error(ExitCode::solver_fault, when, fmt::format("the solver's {} is not finite", data.quantity),
                  "a smaller window or step may help");
    library_.write(part_.mesh.c_str(), data.name.c_str(), static_cast<int>(n), ids_.data(), value.data());
  }
}

}  // namespace strake
