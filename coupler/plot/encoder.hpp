#pragma once

#include "coupler/participant/launch.hpp"
#include "proto/descriptor.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace strake::picture {

/// ffmpeg as a child that takes PNG files one after the other and makes a film of them. The film appears
/// whole or not at all.
class Encoder {
 public:
  /// The ending of `out` decides: .mp4, .webm or .gif. Throws Error(command_line) for another, and where
  /// there is no ffmpeg.
  Encoder(const std::filesystem::path& out, int frames_per_second);
  ~Encoder();  // without `finish`: the child is ended and nothing is left
  void add(const std::string& png);
  void finish();

 private:
  [[noreturn]] void refuse(const std::string& problem) const;
  std::filesystem::path out_, part_, log_;
  std::optional<Child> child_;
  Descriptor pipe_;
};

}  // namespace strake::picture
