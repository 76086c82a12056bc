#include "coupler/participant/precice/own_results.hpp"

#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/lookup.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace strake {
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

}  // namespace strake
