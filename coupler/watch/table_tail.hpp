#pragma once

#include "proto/files/history.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <vector>

namespace strake::watch {

/// When a file was last written [ns on the clock, since 1970]; 0 where there is none.
std::int64_t written_at(const std::filesystem::path&);
std::int64_t clock_now();  // [ns] likewise

/// A column file (proto/files/history.hpp) to which another process appends. Each update reads the new lines;
/// a line counts once its newline is written. A file that was cut (a resumed run) or replaced (a forced one)
/// is read from its beginning. Never throws: a run may be read while its files are made.
class TableTail {
 public:
  explicit TableTail(std::filesystem::path);

  /// Whether there is anything new.
  bool update();

  const std::filesystem::path& path() const { return path_; }
  const std::vector<Column>& columns() const { return table_.columns; }
  std::size_t rows() const { return table_.rows(); }
  /// One vector per column; NaN for an empty cell.
  const std::vector<std::vector<double>>& value() const { return table_.value; }
  /// Index of the column of that name.
  std::optional<std::size_t> find(std::string_view name) const { return table_.find(name); }
  /// The last value of a column; nothing where there is none.
  std::optional<double> last(std::string_view name) const;
  /// Grows whenever the file is read anew: lines that were read before are void then.
  std::uint32_t generation() const { return generation_; }
  /// Lines that are not of this table, left out.
  std::size_t damaged() const { return damaged_; }

 private:
  void begin_anew();

  std::filesystem::path path_;
  Table table_;
  std::uint32_t generation_ = 0;
  std::size_t damaged_ = 0;
  ino_t inode_ = 0;
  off_t read_ = 0;          // [bytes] up to the last newline that was read
  std::string last_bytes_;  // before `read_`: whether this is still the file that was read
};

}  // namespace strake::watch
