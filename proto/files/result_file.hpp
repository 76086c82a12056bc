#pragma once

#include "proto/archive_source.hpp"
#include "proto/interface.hpp"

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
/// The values of an archive, which must outlive it.
ArchiveSource source_of(const Archive&);
/// Throws Error(case_file) with the path and what was expected when the file is missing or not ours.
Archive read_archive(const std::filesystem::path&);
ArchiveUnits read_archive_units(const std::filesystem::path&);

/// frames/<name>-000042.h5, one file per frame, and <name>.xdmf that lists them (opens in ParaView 5.11).
/// Each file appears whole or not at all; the XDMF list is rewritten and renamed after each frame.
class FrameSeries {
 public:
  FrameSeries(std::filesystem::path run_folder, std::string name, int dimension);
  void write(const Frame&);
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
