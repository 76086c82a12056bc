#include "coupler/plot/encoder.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <map>
#include <unistd.h>
#include <vector>

namespace strake::picture {
namespace {

/// Options of ffmpeg for each kind of film: players want even sizes and 4:2:0; a GIF its own palette.
const std::map<std::string, std::vector<std::string>>& recipes() {
  static const std::map<std::string, std::vector<std::string>> known = {
      {".mp4",
       {"-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4"}},
      {".webm", {"-c:v", "libvpx-vp9", "-crf", "32", "-b:v", "0", "-pix_fmt", "yuv420p", "-f", "webm"}},
      {".gif", {"-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse", "-loop", "0", "-f", "gif"}}};
  return known;
}

std::string last_line(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::string last;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) last = line;
  return last;
}

std::filesystem::path ffmpeg() {
  try {
    return find_program("ffmpeg");
  } catch (const Error&) {
    throw Error(ExitCode::command_line, "strake film",
                "there is no ffmpeg on this machine, which makes the film",
                "apt-get install ffmpeg, or draw single frames: strake picture");
  }
}

}  // namespace

Encoder::Encoder(const std::filesystem::path& out, int frames_per_second) : out_(out) {
  const auto recipe = recipes().find(out.extension().string());
  if (recipe == recipes().end())
    throw Error(ExitCode::command_line, "-o " + out.string(), "a film is a .mp4, .webm or .gif",
                "-o film.mp4");
  part_ = out.string() + ".part";
  log_ = out.string() + ".log";
  std::vector<std::string> words = {
      "-hide_banner", "-loglevel", "error", "-y",         "-f",
      "image2pipe",   "-c:v",      "png",   "-framerate", fmt::format("{}", frames_per_second),
      "-i",           "-"};
  words.insert(words.end(), recipe->second.begin(), recipe->second.end());
  words.push_back(part_.string());
  std::signal(SIGPIPE, SIG_IGN);  // an ffmpeg that died is an error of the next write
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) refuse(std::strerror(errno));
  const Descriptor read_end(ends[0]);
  pipe_ = Descriptor(ends[1]);
  child_.emplace(Launch{.program = ffmpeg(),
                        .arguments = std::move(words),
                        .log = log_,
                        .threads = 1,
                        .environment = {},
                        .input = read_end.get()});
}

Encoder::~Encoder() {
  pipe_.close();
  child_.reset();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
  std::filesystem::remove(log_, ignored);
}

void Encoder::refuse(const std::string& problem) const {
  const std::string said = last_line(log_);
  throw Error(ExitCode::cannot_write, out_.string(), "ffmpeg: " + (said.empty() ? problem : said),
              "see that the disk has room, or try another ending: .mp4, .webm, .gif");
}

void Encoder::add(const std::string& png) {
  for (std::size_t done = 0; done < png.size();) {
    const ssize_t written = write(pipe_.get(), png.data() + done, png.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) refuse(std::strerror(errno));
    done += static_cast<std::size_t>(written);
  }
}

void Encoder::finish() {
  pipe_.close();
  const auto exit = child_->wait(std::chrono::hours(24));
  if (!exit || exit->code != 0 || exit->signal != 0) refuse("it ended before its time");
  std::error_code error;
  std::filesystem::rename(part_, out_, error);
  if (error) refuse(error.message());
}

}  // namespace strake::picture
