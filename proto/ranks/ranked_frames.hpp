#pragma once

#include "proto/files/result_file.hpp"
#include "proto/interface.hpp"
#include "proto/ranks/communicator.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace strake {

/// Writes the frames of a participant on several ranks: each rank its own points as a part. When all parts
/// are there, the first rank writes the frame, which joins them. All ranks call each function together. Where
/// one of them fails, all throw its Error, and there is no frame of that instant.
class RankedFrames {
 public:
  RankedFrames(const std::filesystem::path& run_folder, const std::string& name, int dimension,
               Communicator&);
  void write(const Frame& own);
  /// Drops frames later than `time` (resume).
  void truncate(double time);

 private:
  Communicator& ranks_;
  std::optional<FrameSeries> series_;  // the first rank alone knows the frames
};

}  // namespace strake
