#include "proto/files/history.hpp"

#include "proto/text.hpp"
#include "proto/visible.hpp"

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

/// Cuts the first cell off a line that has one.
std::string_view next_cell(std::optional<std::string_view>& line) {
  const std::size_t comma = line->find(',');
  const std::string_view cell = trimmed(line->substr(0, comma));
  if (comma == std::string_view::npos)
    line.reset();
  else
    line->remove_prefix(comma + 1);
  return cell;
}

/// The number in a cell, NaN in an empty one; nothing where it is none.
std::optional<double> number_of(std::string_view cell) {
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto value = number_from<double>(cell.substr(cell[0] == '+' ? 1 : 0));
  return value && !std::isnan(*value) ? value : std::nullopt;
}

constexpr const char* header_fix =
    "the first line holds a name and a unit for each column: time [s],force.y [N]";

std::string bytes_of(const std::filesystem::path& path, std::uintmax_t largest) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw Error(ExitCode::case_file, path.string(), "cannot be read", "check the path");
  return read_whole(path, largest, path.string());
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

std::optional<std::size_t> Table::find(std::string_view name) const {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == name) return i;
  return std::nullopt;
}

const std::vector<double>& Table::column(const std::string& name) const {
  if (const auto found = find(name)) return value[*found];
  std::vector<std::string> names;
  for (const Column& other : columns) names.push_back(other.name);
  const std::string near = did_you_mean(name, names);
  throw Error(ExitCode::case_file, path.string(), "has no column " + name,
              near.empty() ? "its columns are " + joined(names) : "did you mean " + near + "?");
}

std::optional<Table::BadLine> Table::add_header(std::string_view line) {
  std::vector<Column> named;
  for (std::optional<std::string_view> rest = line; rest;) {
    const std::string_view cell = next_cell(rest);
    const std::size_t bracket = cell.find('[');
    const bool bare = bracket == std::string_view::npos;  // "t;x": no unit either
    for (const auto& [mark, name] :
         {std::pair(bare ? ";" : "];", "';'"), {bare ? "\t" : "]\t", "tabs"}, {"] \t", "tabs"}})
      if (cell.find(mark) != std::string_view::npos)
        return BadLine{fmt::format("columns are separated by {}", name),
                       "separate columns by commas, and write numbers with a decimal point: 0.25,1.5"};
    if (bracket == std::string_view::npos || bracket == 0 || !cell.ends_with(']'))
      return BadLine{fmt::format("\"{}\" names no column", cell), header_fix};
    named.push_back({std::string(trimmed(cell.substr(0, bracket))),
                     std::string(cell.substr(bracket + 1, cell.size() - bracket - 2))});
  }
  columns = std::move(named);
  value.resize(columns.size());
  return std::nullopt;
}

std::optional<Table::BadLine> Table::add(std::string_view text) {
  const std::string_view line = trimmed(text);
  if (line.starts_with('#') || (line.empty() && columns.size() != 1)) return std::nullopt;
  if (columns.empty()) return add_header(line);
  const auto cells = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
  if (cells != columns.size())
    return BadLine{fmt::format("{} values in a table of {} columns", cells, columns.size()),
                   "each row holds one value for each name of the first line"};
  std::vector<double> row;
  row.reserve(cells);
  for (std::optional<std::string_view> rest = line; rest;) {
    const std::string_view cell = next_cell(rest);
    const auto number = number_of(cell);
    if (!number)
      return BadLine{fmt::format("\"{}\" is no number", cell), "a value that is not known is an empty cell"};
    row.push_back(*number);
  }
  for (std::size_t i = 0; i < row.size(); ++i) value[i].push_back(row[i]);
  return std::nullopt;
}

namespace {

Table read_table(const std::filesystem::path& path, std::uintmax_t largest, bool last_counts) {
  const std::string bytes = bytes_of(path, largest);
  Table table;
  table.path = path;
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";  // spreadsheets begin UTF-8 with it
  std::string_view rest = bytes;
  if (rest.starts_with(byte_order_mark)) rest.remove_prefix(byte_order_mark.size());
  if (rest.starts_with("\xff\xfe") || rest.starts_with("\xfe\xff"))
    throw Error(ExitCode::case_file, path.string(), "is text of 16 bits a character, UTF-16",
                "save it as UTF-8");
  int number = 0;
  const auto add = [&](std::string_view line) {
    ++number;
    if (const auto bad = table.add(line))
      throw Error(ExitCode::case_file, fmt::format("{}:{}", path.string(), number), bad->problem, bad->fix);
  };
  for (std::size_t end = rest.find('\n'); end != std::string_view::npos; end = rest.find('\n')) {
    add(rest.substr(0, end));
    rest.remove_prefix(end + 1);
  }
  if (last_counts && !rest.empty()) add(rest);
  if (table.columns.empty()) throw Error(ExitCode::case_file, path.string(), "holds no columns", header_fix);
  return table;
}

}  // namespace

Table read_table(const std::filesystem::path& path) {
  return read_table(path, any_size, false);
}

Table read_given_table(const std::filesystem::path& path) {
  return read_table(path, largest_table, true);
}

}  // namespace strake
