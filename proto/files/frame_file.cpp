#include "proto/files/frame_file.hpp"

#include "proto/error.hpp"
#include "proto/files/hdf5_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace strake {
namespace {

Error damaged(const std::filesystem::path& path, const std::string& problem) {
  return {ExitCode::case_file, path.string(), problem, "run the case again"};
}

/// /point or /cell: a file has n×components, line by line; a frame components×n.
std::vector<Frame::Array> read_arrays(const hdf5::Reader& file, const std::string& group, Eigen::Index n,
                                      const std::filesystem::path& from) {
  std::vector<Frame::Array> arrays;
  for (const std::string& link : file.names(group)) {
    const std::string path = group + "/" + link;
    arrays.push_back({.name = hdf5::from_link_name(link),
                      .unit = file.text_of(path, "unit").value_or("1"),
                      .value = file.real(path).transpose()});
    if (arrays.back().value.cols() != n)
      throw damaged(from, fmt::format("{} has {} rows, not {}", path, arrays.back().value.cols(), n));
    if (arrays.back().value.rows() == 0) throw damaged(from, fmt::format("{} has no columns", path));
  }
  return arrays;
}

}  // namespace

std::vector<FrameFile> list_frames(const std::filesystem::path& run_folder, const std::string& name) {
  std::vector<FrameFile> frames;
  std::error_code error;
  for (const auto& item : std::filesystem::directory_iterator(run_folder / "frames", error)) {
    const std::filesystem::path& path = item.path();
    if (path.extension() != ".h5" || !path.filename().string().starts_with(name + "-")) continue;
    if (const auto time = time_of_frame(path))
      frames.push_back({*time, path});  // the others still show the run
  }
  std::sort(frames.begin(), frames.end(), [](const FrameFile& a, const FrameFile& b) {
    return std::pair(a.time, a.path) < std::pair(b.time, b.path);
  });
  return frames;
}

std::optional<double> time_of_frame(const std::filesystem::path& path) {
  try {
    const double time = hdf5::Reader(path, hdf5::frame_format).number("time");
    return std::isfinite(time) ? std::optional(time) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

const FrameFile* nearest(const std::vector<FrameFile>& frames, double time) {
  if (frames.empty()) return nullptr;
  if (std::isinf(time)) return time > 0 ? &frames.back() : &frames.front();
  const FrameFile* best = nullptr;
  for (const FrameFile& frame : frames)
    if (best == nullptr || std::abs(frame.time - time) < std::abs(best->time - time)) best = &frame;
  return best;
}

Frame read_frame(const std::filesystem::path& path) {
  const hdf5::Reader file(path, hdf5::frame_format);
  Frame frame;
  frame.time = file.number("time");
  const hdf5::RowMajor position = file.real("/position");
  if (position.cols() != 3) throw damaged(path, "the positions of a frame have three components");
  frame.position = position.transpose();

  const auto shape = file.shape("/cells");  // cells, nodes of each
  const std::vector<std::int64_t> cells = file.integer("/cells");
  if (shape[1] > 1) {
    frame.cells.resize(shape[1], shape[0]);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i] < 0 || cells[i] >= frame.position.cols())
        throw damaged(path, "a cell names a point that is not there");
      frame.cells.data()[i] = static_cast<int>(cells[i]);
    }
  }
  frame.point_data = read_arrays(file, "/point", frame.position.cols(), path);
  frame.cell_data = read_arrays(file, "/cell", shape[0], path);
  return frame;
}

const Frame::Array* find(const std::vector<Frame::Array>& arrays, const std::string& name) {
  for (const Frame::Array& array : arrays)
    if (array.name == name) return &array;
  return nullptr;
}

namespace {

/// The named array of all frames side by side; NaN where one lacks it. `columns` tells how many each has.
/// Empty where two have other components.
Eigen::MatrixXd beside(const std::vector<Frame>& frames, const Frame::Array& first,
                       std::vector<Frame::Array> Frame::*arrays, const std::vector<Eigen::Index>& columns) {
  const Eigen::Index sum = std::accumulate(columns.begin(), columns.end(), Eigen::Index{0});
  Eigen::MatrixXd all =
      Eigen::MatrixXd::Constant(first.value.rows(), sum, std::numeric_limits<double>::quiet_NaN());
  Eigen::Index before = 0;
  for (std::size_t f = 0; f < frames.size(); before += columns[f++]) {
    const Frame::Array* own = find(frames[f].*arrays, first.name);
    if (own == nullptr) continue;
    if (own->value.rows() != first.value.rows() || own->value.cols() != columns[f]) return {};
    all.middleCols(before, columns[f]) = own->value;
  }
  return all;
}

}  // namespace

Frame joined(const std::vector<Frame>& frames) {
  if (frames.size() == 1) return frames.front();
  Frame all;
  if (frames.empty()) return all;
  all.time = frames.front().time;
  const Eigen::Index corners = frames.front().cells.rows();
  const bool cells = std::all_of(frames.begin(), frames.end(), [&](const Frame& frame) {
    return frame.cells.cols() > 0 && frame.cells.rows() == corners;
  });
  if (cells) all.cells.resize(corners, 0);
  for (const Frame& frame : frames) {
    const Eigen::Index before = all.position.cols();
    if (cells) {
      all.cells.conservativeResize(corners, all.cells.cols() + frame.cells.cols());
      all.cells.rightCols(frame.cells.cols()) = frame.cells.array() + static_cast<int>(before);
    }
    all.position.conservativeResize(3, before + frame.position.cols());
    all.position.rightCols(frame.position.cols()) = frame.position;
  }
  const auto join = [&](std::vector<Frame::Array> Frame::*arrays, const std::vector<Eigen::Index>& columns) {
    for (const Frame& frame : frames)
      for (const Frame::Array& array : frame.*arrays) {
        if (find(all.*arrays, array.name) != nullptr) continue;
        if (Eigen::MatrixXd value = beside(frames, array, arrays, columns); value.size() > 0)
          (all.*arrays).push_back({array.name, array.unit, std::move(value)});
      }
  };
  std::vector<Eigen::Index> points, cells_of;
  for (const Frame& frame : frames) {
    points.push_back(frame.position.cols());
    cells_of.push_back(frame.cells.cols());
  }
  join(&Frame::point_data, points);
  if (cells) join(&Frame::cell_data, cells_of);
  return all;
}

}  // namespace strake
