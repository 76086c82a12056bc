#pragma once

#include "proto/descriptor.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace strake {

/// The folder of an FMU: one that is there, or a private temporary one into which the .fmu was unpacked, and
/// which is removed at the end. The next one removes those of processes that were killed.
class FmuPackage {
 public:
  /// Error(case_file) for what is no zip archive, is damaged, or has entries that lead out of the folder, are
  /// links, or hold more than `largest` bytes together.
  explicit FmuPackage(const std::filesystem::path& file, std::uint64_t largest = std::uint64_t{1} << 30);
  ~FmuPackage() { remove(); }
  FmuPackage(const FmuPackage&) = delete;
  FmuPackage& operator=(const FmuPackage&) = delete;

  const std::filesystem::path& file() const { return file_; }      // as the user named it
  const std::filesystem::path& folder() const { return folder_; }  // absolute
  /// The library for this machine. Error(case_file) that lists the platforms for which there is one.
  std::filesystem::path library(const std::string& model_identifier) const;
  /// Absolute, with '/' at its end, as FMI 3.0 wants it; empty: the FMU has none.
  std::string resources() const;
  /// Removes the temporary folder before the end. A library that was loaded from it stays loaded.
  void remove();

 private:
  std::filesystem::path file_, folder_;
  bool temporary_ = false;
  Descriptor lock_;  // of the temporary folder: held as long as its process lives
};

/// The folder of `binaries` for this machine; empty on one that FMI 3.0 does not name.
std::string fmu_platform();

}  // namespace strake
