#include "coupler/plot/encoder.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <map>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

extern char** environ;

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

}  // namespace

Encoder::Encoder(const std::filesystem::path& out, int frames_per_second) : out_(out) {
  const auto recipe = recipes().find(out.extension().string());
  if (recipe == recipes().end())
    throw Error(ExitCode::command_line, "-o " + out.string(), "a film is a .mp4, .webm or .gif",
                "-o film.mp4");
  part_ = out.string() + ".part";
  log_ = out.string() + ".log";
  std::vector<std::string> words = {"ffmpeg",
                                    "-hide_banner",
                                    "-loglevel",
                                    "error",
                                    "-y",
                                    "-f",
                                    "image2pipe",
                                    "-c:v",
                                    "png",
                                    "-framerate",
                                    fmt::format("{}", frames_per_second),
                                    "-i",
                                    "-"};
  words.insert(words.end(), recipe->second.begin(), recipe->second.end());
  words.push_back(part_.string());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  std::signal(SIGPIPE, SIG_IGN);  // an ffmpeg that died is an error of the next write
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) refuse(std::strerror(errno));
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[0], 0);
  posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, 2, log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t again;
  sigemptyset(&again);
  sigaddset(&again, SIGPIPE);
  posix_spawnattr_setsigdefault(&attributes, &again);
  posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl-C is ours to answer
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  const int failed = posix_spawnp(&child_, "ffmpeg", &files, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  close(ends[0]);
  pipe_ = ends[1];
  if (failed == 0) return;
  child_ = -1;
  close(pipe_);
  pipe_ = -1;
  std::error_code ignored;
  std::filesystem::remove(log_, ignored);
  if (failed != ENOENT) refuse(std::strerror(failed));
  throw Error(ExitCode::command_line, "strake film",
              "there is no ffmpeg on this machine, which makes the film",
              "apt-get install ffmpeg, or draw single frames: strake picture");
}

Encoder::~Encoder() {
  if (pipe_ >= 0) close(pipe_);
  if (child_ > 0) {
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }
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
    const ssize_t written = write(pipe_, png.data() + done, png.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) refuse(std::strerror(errno));
    done += static_cast<std::size_t>(written);
  }
}

void Encoder::finish() {
  close(pipe_);
  pipe_ = -1;
  int status = 0;
  while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  if (status != 0) refuse("it ended before its time");
  std::error_code error;
  std::filesystem::rename(part_, out_, error);
  if (error) refuse(error.message());
}

}  // namespace strake::picture
