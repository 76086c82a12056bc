#pragma once

#include <filesystem>
#include <string>
#include <sys/types.h>

namespace strake::picture {

/// ffmpeg as a child that takes PNG files one after the other and makes a film of them. The film appears
/// whole or not at all.
class Encoder {
 public:
  /// The ending of `out` decides: .mp4, .webm or .gif. Throws Error(command_line) for another, and where
  /// there is no ffmpeg.
  Encoder(const std::filesystem::path& out, int frames_per_second);
  ~Encoder();  // without `finish`: the child is ended and nothing is left
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  void add(const std::string& png);
  void finish();

 private:
  [[noreturn]] void refuse(const std::string& problem) const;
  std::filesystem::path out_, part_, log_;
  pid_t child_ = -1;
  int pipe_ = -1;
};

}  // namespace strake::picture
