#include "proto/files/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace strake {
namespace {

std::string header_of(const std::vector<Column>& columns, const std::filesystem::path& path) {
  std::string header;
  for (const Column& column : columns) {
    if (column.name.empty() || (column.name + column.unit).find_first_of(",[]\n\r") != std::string::npos)
      throw Error(ExitCode::solver_fault, path.string(),
                  fmt::format("\"{}\" cannot be the name of a column", column.name),
                  "names and units hold no comma, bracket or line end");
    header += fmt::format("{}{} [{}]", header.empty() ? "" : ",", column.name, column.unit);
  }
  return header + "\n";
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',')
      cells.emplace_back();
    else
      cells.back() += c;
  }
  for (std::string& cell : cells) cell = trimmed(cell);
  return cells;
}

std::string bytes_of(const std::filesystem::path& path, std::uintmax_t largest) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw Error(ExitCode::case_file, path.string(), "cannot be read", "check the path");
  return read_whole(path, largest, path.string());
}

Column column_of(const std::string& cell, const std::string& where) {
  const std::size_t bracket = cell.find('[');
  if (bracket == std::string::npos || bracket == 0 || !cell.ends_with(']'))
    throw Error(ExitCode::case_file, where, fmt::format("\"{}\" names no column", cell),
                "the first line holds a name and a unit for each column: time [s],force.y [N]");
  return {trimmed(cell.substr(0, bracket)), cell.substr(bracket + 1, cell.size() - bracket - 2)};
}

double number_of(const std::string& cell, const std::string& where) {
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  double value = 0;
  const char* last = cell.data() + cell.size();
  const auto [end, error] = std::from_chars(cell.data() + (cell[0] == '+' ? 1 : 0), last, value);
  if (error != std::errc() || end != last || std::isnan(value))
    throw Error(ExitCode::case_file, where, fmt::format("\"{}\" is no number", cell),
                "a value that is not known is an empty cell");
  return value;
}

}  // namespace

History::History(const std::filesystem::path& path, std::vector<Column> columns)
    : path_(path), columns_(std::move(columns)) {
  const std::string header = header_of(columns_, path_);
  file_ = std::fopen(path_.c_str(), "wbe");
  if (!file_) throw cannot_write(path_, errno);
  write(header);
}

History::History(const std::filesystem::path& path, std::vector<Column> columns, std::size_t rows)
    : path_(path), columns_(std::move(columns)) {
  const std::string header = header_of(columns_, path_), bytes = bytes_of(path_, any_size);
  if (!bytes.starts_with(header))
    throw Error(ExitCode::case_file, path_.string(), "its columns are not those of this run",
                "resume with the case and the programs that began the run");
  std::size_t end = header.size();
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t newline = bytes.find('\n', end);
    if (newline == std::string::npos)
      throw Error(ExitCode::case_file, path_.string(),
                  fmt::format("holds {} rows, the checkpoint was taken after {}", row, rows),
                  "begin the run again with --force");
    end = newline + 1;
  }
  std::error_code error;
  std::filesystem::resize_file(path_, end, error);
  if (error) throw cannot_write(path_, error.value());
  file_ = std::fopen(path_.c_str(), "abe");
  if (!file_) throw cannot_write(path_, errno);
}

History::~History() {
  if (file_) std::fclose(file_);
}

void History::append(const std::vector<double>& row) {
  assert(row.size() == columns_.size());
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i > 0) line += ',';
    char buffer[32];
    if (!std::isnan(row[i])) line.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, row[i]).ptr);
  }
  write(line + "\n");
}

void History::write(const std::string& text) {
  assert(file_ && "a history that failed is not written to again");
  if (std::fwrite(text.data(), 1, text.size(), file_) == text.size() && std::fflush(file_) == 0) return;
  const int failed = errno;
  std::fclose(file_);
  file_ = nullptr;
  throw cannot_write(path_, failed);
}

void History::sync() {
  if (file_) sync_to_disk(::fileno(file_), path_);  // of one that failed the error was thrown
}

const std::vector<double>& Table::column(const std::string& name) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].name == name) return value[i];
    names.push_back(columns[i].name);
  }
  std::string list;
  for (const std::string& other : names) list += (list.empty() ? "" : ", ") + other;
  const std::string near = did_you_mean(name, names);
  throw Error(ExitCode::case_file, path.string(), "has no column " + name,
              near.empty() ? "its columns are " + list : "did you mean " + near + "?");
}

Table read_table(const std::filesystem::path& path, std::uintmax_t largest) {
  const std::string bytes = bytes_of(path, largest);
  Table table;
  table.path = path;
  std::size_t begin = 0;
  int number = 0;
  // A line counts once its newline is written.
  for (std::size_t end = bytes.find('\n'); end != std::string::npos;
       begin = end + 1, end = bytes.find('\n', begin)) {
    const std::string line = trimmed(bytes.substr(begin, end - begin));
    const std::string where = fmt::format("{}:{}", path.string(), ++number);
    if (line.starts_with('#') || (line.empty() && table.columns.size() != 1)) continue;
    const std::vector<std::string> cells = cells_of(line);
    if (table.columns.empty()) {
      for (const std::string& cell : cells) table.columns.push_back(column_of(cell, where));
      table.value.resize(table.columns.size());
      continue;
    }
    if (cells.size() != table.columns.size())
      throw Error(ExitCode::case_file, where,
                  fmt::format("{} values in a table of {} columns", cells.size(), table.columns.size()),
                  "each row holds one value for each name of the first line");
    for (std::size_t i = 0; i < cells.size(); ++i) table.value[i].push_back(number_of(cells[i], where));
  }
  if (table.columns.empty())
    throw Error(ExitCode::case_file, path.string(), "holds no columns",
                "the first line holds a name and a unit for each column: time [s],force.y [N]");
  return table;
}

}  // namespace strake
