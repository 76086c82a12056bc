#pragma once

#include "proto/files/result_file.hpp"
#include "proto/interface.hpp"
#include "proto/ranks/communicator.hpp"

#include <filesystem>
#include <future>
#include <optional>
#include <string>

namespace strake {

/// Writes the frames of a participant on several ranks: each rank its own points as a part, in a thread of
/// its own, so that the ranks compute on meanwhile. When all parts are there, the first rank writes the
/// frame, which joins them. All ranks call each function together. Where one of them fails, all throw its
/// Error, and there is no frame of that instant. The threads send no messages, and no rank calls HDF5 beside
/// its thread.
class RankedFrames {
 public:
  RankedFrames(const std::filesystem::path& run_folder, const std::string& name, int dimension,
               Communicator&);
  /// Begins to write a frame. Waits for the one before it, and throws what that has thrown.
  void write(Frame own);
  /// Joins the frame under way where all ranks have written their parts. Never waits for a disk.
  void look();
  /// Waits until the frame under way is on the disk.
  void flush();
  /// Drops frames later than `time` (resume).
  void truncate(double time);

 private:
  Communicator& ranks_;
  std::optional<FrameSeries> series_;  // the first rank alone knows the frames
  struct Pending {
    int number = 0;   // of the frame
    double time = 0;  // [s]
    std::future<FilePart> part;
  };
  std::optional<Pending> pending_;
};

}  // namespace strake
