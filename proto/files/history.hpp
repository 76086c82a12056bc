#pragma once

#include "proto/files/whole_file.hpp"
#include "proto/interface.hpp"

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace strake {

/// A column file: one header line `name [unit],…`, then lines of numbers; flushed after each line. Numbers in
/// the C locale, the shortest text that reads back to the same double, so that equal results are equal bytes.
/// Throws Error(cannot_write).
class History {
 public:
  History(const std::filesystem::path&, std::vector<Column> columns);
  /// Continues a file: keeps the header, which must name these columns, and its first `rows` lines (resume).
  /// Throws Error(case_file) if the file is not there, has other columns or fewer lines.
  History(const std::filesystem::path&, std::vector<Column> columns, std::size_t rows);
  ~History();
  History(const History&) = delete;
  History& operator=(const History&) = delete;
  void append(const std::vector<double>& row);  // one value per column; NaN is written as an empty cell
  const std::vector<Column>& columns() const { return columns_; }
  /// Waits until the lines so far are on the disk.
  void sync();

 private:
  void write(const std::string& text);
  std::filesystem::path path_;
  std::vector<Column> columns_;
  std::FILE* file_ = nullptr;
};

/// A column file read back. A last line without its newline (a killed run) is left out.
struct Table {
  std::vector<Column> columns;
  std::vector<std::vector<double>> value;  // one vector per column; NaN for an empty cell
  std::filesystem::path path = {};         // where it was read
  std::size_t rows() const { return value.empty() ? 0 : value.front().size(); }
  std::optional<std::size_t> find(std::string_view name) const;
  /// The column of that name; throws Error naming the file's columns.
  const std::vector<double>& column(const std::string& name) const;

  /// What is wrong with a line, and what it should hold.
  struct BadLine {
    std::string problem, fix;
  };
  /// Takes the file's next line, without its newline: the header, a row or a note. A bad line changes
  /// nothing.
  std::optional<BadLine> add(std::string_view line);

 private:
  std::optional<BadLine> add_header(std::string_view line);
};
/// Lines that begin with # are notes (origin, licence). Throws Error(case_file) with file:line for a bad
/// header, a bad number or a line of wrong length. Of a run's file a last line without its newline was cut
/// off and does not count.
Table read_table(const std::filesystem::path&);
/// The same of a table that a user has written, up to `largest_table`. Its last line counts in any case.
Table read_given_table(const std::filesystem::path&);

}  // namespace strake
