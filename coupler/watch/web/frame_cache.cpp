#include "coupler/watch/web/frame_cache.hpp"

#include "coupler/plot/scene.hpp"
#include "coupler/watch/table_tail.hpp"
#include "proto/error.hpp"
#include "proto/files/frame_file.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace strake::watch {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_bytes = std::size_t(256) << 20;  // of frames that are kept

/// "fluid-000042.h5" → ("fluid", 42).
std::optional<std::pair<std::string, int>> named(const std::string& file) {
  const auto dash = file.rfind('-'), end = file.size() - std::min<std::size_t>(3, file.size());
  if (!file.ends_with(".h5") || dash == std::string::npos || dash + 1 >= end) return std::nullopt;
  const auto number = number_from<int>(file.substr(dash + 1, end - dash - 1));
  return number ? std::optional(std::pair(file.substr(0, dash), *number)) : std::nullopt;
}

std::size_t bytes_of(const Frame& frame) {
  Eigen::Index numbers = frame.position.size() + frame.cells.size();
  for (const auto* arrays : {&frame.point_data, &frame.cell_data})
    for (const Frame::Array& array : *arrays) numbers += array.value.size();
  return static_cast<std::size_t>(numbers) * sizeof(double);
}

Error no_such_frame(const fs::path& path) {
  return {ExitCode::case_file, path.string(), "there is no such frame", "choose one of the list of frames"};
}

}  // namespace

fs::path FrameCache::path_of(const Key& key) const {
  return folder_ / fmt::format("{}-{:06}.h5", key.first, key.second);
}

void FrameCache::update() {
  const std::int64_t changed = written_at(folder_);
  if (changed == updated_) return;
  // The clock of a file system has coarse ticks. Files of the same tick as the last one may still be missing.
  constexpr std::int64_t tick = 100'000'000;  // [ns]
  updated_ = clock_now() - changed > tick ? changed : -1;
  std::map<std::string, std::set<int>> there;
  std::error_code error;
  for (const auto& item : fs::directory_iterator(folder_, error))
    if (const auto name = named(item.path().filename().string())) there[name->first].insert(name->second);
  for (auto& [side, series] : series_) {
    const auto& numbers = there[side];
    if (std::erase_if(series.entries, [&](const Entry& entry) { return !numbers.contains(entry.number); }) >
        0) {
      ++series.generation;
      interface_.reset();  // a resumed run writes it anew from there
    }
  }
  for (const auto& [side, numbers] : there) {
    Series& series = series_[side];
    bool any = false;
    for (const int number : numbers) {
      const auto known = std::lower_bound(series.entries.begin(), series.entries.end(), number,
                                          [](const Entry& entry, int n) { return entry.number < n; });
      if (known != series.entries.end() && known->number == number) continue;
      const fs::path path = path_of({side, number});
      const std::int64_t when = written_at(path);
      const auto bad = damaged_.find(path.string());
      if (bad != damaged_.end() && bad->second == when) continue;
      if (const auto time = time_of_frame(path)) {
        any = any || known != series.entries.end();  // it belongs between others that were already reported
        series.entries.insert(known, {number, *time});
      } else {
        damaged_[path.string()] = when;
      }
    }
    if (any) ++series.generation;
  }
}

const FrameCache::Series& FrameCache::series(const std::string& side) const {
  static const Series none;
  const auto found = series_.find(names_of(side).front());
  if (found != series_.end()) return found->second;
  return has_interface_alone() ? series_.at("fluid") : none;
}

// A structure with frames writes its first one with the fluid's, before the second.
bool FrameCache::has_interface_alone() const {
  std::error_code none;
  const auto fluid = series_.find("fluid");
  return series_.size() == 1 && fluid != series_.end() && fluid->second.entries.size() > 1 &&
         fs::exists(folder_.parent_path() / "interface", none);
}

std::shared_ptr<const Frame> FrameCache::read_interface(int number) {
  const fs::path run = folder_.parent_path();
  const std::vector<Entry>& entries = series_.at("fluid").entries;
  const auto entry = std::ranges::find(entries, number, &Entry::number);
  if (entry == entries.end()) throw no_such_frame(path_of({"fluid", number}));
  if (!interface_ || interface_->end() < entry->time) interface_ = picture::record_of(run);
  if (!interface_)
    throw Error(ExitCode::case_file, (run / "interface").string(), "holds no record that can be read");
  auto frame = std::make_shared<Frame>();
  frame->time = entry->time;
  frame->position = interface_->mesh.position;
  frame->cells = interface_->mesh.faces;
  if (!interface_->displacement.empty()) {
    const Points moved = interface_->displacement_at(frame->time);
    frame->position += moved;
    frame->point_data = {{"displacement", "m", moved},
                         {"velocity", "m/s", interface_->velocity_at(frame->time)}};
  }
  parts_ = interface_->mesh.parts;
  return frame;
}

std::vector<std::string> FrameCache::names_of(const std::string& side) const {
  if (side == "fluid" || series_.contains(side)) return {side};
  std::vector<std::string> bodies;
  for (const auto& [name, series] : series_)
    if (name != "fluid") bodies.push_back(name);
  return bodies.empty() ? std::vector{side} : bodies;
}

std::shared_ptr<const Frame> FrameCache::read(const std::string& side, int number) {
  if (side != "fluid" && has_interface_alone()) return read_interface(number);
  const Key key = {side, number};
  const std::vector<std::string> names = names_of(side);
  const fs::path path = path_of({names.front(), number});
  const std::int64_t when = written_at(path);
  if (when == 0) throw no_such_frame(path);
  const auto found =
      std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.key == key; });
  if (found != kept_.end() && found->written == when) {
    kept_.splice(kept_.begin(), kept_, found);
    parts_ = kept_.front().parts;
    return kept_.front().frame;
  }
  if (found != kept_.end()) kept_.erase(found);
  std::vector<Frame> frames;
  parts_.clear();
  Eigen::Index first = 0;
  for (const std::string& name : names) {
    frames.push_back(read_frame(path_of({name, number})));
    if (names.size() > 1 || name != side) parts_.push_back({.name = name, .first_point = first});
    first += frames.back().position.cols();
  }
  auto frame = std::make_shared<const Frame>(joined(frames));
  kept_.push_front({.key = key, .written = when, .bytes = bytes_of(*frame), .frame = frame, .parts = parts_});
  std::size_t bytes = 0;
  for (auto kept = kept_.begin(); kept != kept_.end();) {
    bytes += kept->bytes;
    kept = bytes > most_bytes && kept != kept_.begin() ? kept_.erase(kept) : std::next(kept);
  }
  return frame;
}

}  // namespace strake::watch
