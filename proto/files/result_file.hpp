#pragma once

#include "proto/archive_source.hpp"
#include "proto/files/file_part.hpp"
#include "proto/interface.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// Writes an archive as one HDF5 file: aside, closed, renamed. Real arrays become double datasets
/// (rows×columns), integer arrays int64 datasets. Equal content is equal bytes. Throws Error(cannot_write).
/// unit: of real arrays by name, for whom it is of use; becomes the dataset's attribute. lasting: on the disk
/// when it returns.
using ArchiveUnits = std::map<std::string, std::string>;
void write_archive(const std::filesystem::path&, const Archive&, const ArchiveUnits& unit = {},
                   bool lasting = false);
/// Writes the same file from values that are made one after the other. Beside its sources it takes the memory
/// of the file, and of one value twice.
void write_archive(const std::filesystem::path&, const ArchiveSource&, const ArchiveUnits& unit = {},
                   bool lasting = false);
/// A file that has just been written, as a part of one in that folder.
FilePart part_of(const std::filesystem::path&, std::int64_t length, const std::filesystem::path& folder);
/// Writes an archive whose columns lie in parts, which are archives beside it. It has their names and holds
/// their entries one behind the other, and has values of its own. The first part must be there.
void join_archive(const std::filesystem::path&, const ArchiveSource& own, const std::vector<FilePart>& parts);
/// The values of an archive, which must outlive it.
ArchiveSource source_of(const Archive&);
/// Throws Error(case_file) with the path and what was expected when the file is missing or not ours.
Archive read_archive(const std::filesystem::path&);
/// Reads entries [first, last) of the named values alone, those of several ranges one behind the other.
/// Values of another length than `length` are read as a whole.
struct ArchiveSlice {
  std::vector<std::string> names;
  std::int64_t length = 0;
  std::vector<std::array<std::int64_t, 2>> ranges;
};
Archive read_archive(const std::filesystem::path&, const ArchiveSlice&);
/// Rows and columns of a real value, without reading it.
std::array<std::int64_t, 2> shape_in_archive(const std::filesystem::path&, const std::string& name);
ArchiveUnits read_archive_units(const std::filesystem::path&);

/// frames/<name>-000042.h5, one file per frame, and <name>.xdmf that lists them (opens in ParaView 5.11).
/// Each file appears whole or not at all; the XDMF list is rewritten and renamed after each frame.
class FrameSeries {
 public:
  FrameSeries(std::filesystem::path run_folder, std::string name, int dimension);
  void write(const Frame&);
  /// Writes a part of the frame of that number, a cloud of points. before: points of the parts before it.
  FilePart write_part(const Frame& own, int number, int part, std::int64_t before) const;
  /// Writes the next frame out of all its parts, which are on the disk: frames/<name>-000042.h5 joins
  /// frames/<name>-000042/0003.h5 and so on.
  void join(double time, const std::vector<FilePart>&);
  /// Removes the parts of a frame that could not be joined.
  void forget_parts(int number) const;
  int next() const { return next_; }  // number of the next frame
  int count() const { return static_cast<int>(entries_.size()); }
  /// Drops frames later than `time` (resume).
  void truncate(double time);

 private:
  struct Entry {
    double time = 0;
    long long n_points = 0, n_cells = 0;
    int nodes_per_cell = 0;
    std::vector<std::pair<std::string, int>> point_data, cell_data;  // name, components
    std::string file;
  };
  static std::optional<Entry> entry_of(const std::filesystem::path&);  // nothing where the file is damaged
  std::string file_of(int number) const;
  void write_xdmf() const;
  std::filesystem::path run_folder_;
  std::string name_;
  int dimension_ = 2;
  std::vector<Entry> entries_;
  int next_ = 0;  // number of the next file
};

/// Writes text whole or not at all, and on the disk when it returns. Throws Error(cannot_write).
void write_text(const std::filesystem::path&, const std::string&);

}  // namespace strake
