#pragma once

#include "proto/interface.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// A frame of a run that lies on disk.
struct FrameFile {
  double time = 0;  // [s]
  std::filesystem::path path;
};

/// The frames frames/<name>-000042.h5 of a run folder that can be read, in order of time; none is no error.
std::vector<FrameFile> list_frames(const std::filesystem::path& run_folder, const std::string& name);
/// Time of one of them [s]; nothing where it is damaged, not of ours, or gone.
std::optional<double> time_of_frame(const std::filesystem::path&);
/// The frame next to `time`, the earlier of two as near; nullptr where there is none.
const FrameFile* nearest(const std::vector<FrameFile>&, double time);
/// Throws Error(case_file) with the path when the file is not a frame of ours.
Frame read_frame(const std::filesystem::path&);

/// The frames of several bodies as one. Values that a body does not have are NaN. Bodies of cells beside bodies
/// of particles: all are points.
Frame joined(const std::vector<Frame>&);

/// The array of that name, or nullptr.
const Frame::Array* find(const std::vector<Frame::Array>&, const std::string& name);

}  // namespace strake
