#include "coupler/transport/curve_keys.hpp"

#include "coupler/transport/sockets.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

namespace strake {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t z85_length = 40;  // characters of a key of 32 bytes
constexpr mode_t others = 077;          // rights that only the owner may have

const char* const another = "make keys anew: strake keys DIR";

[[noreturn]] void cannot_write(const fs::path& path) {
  throw Error(ExitCode::cannot_write, path.string(),
              fmt::format("cannot be written: {}", std::strerror(errno)), "choose another folder");
}

/// Refuses what others than the owner may use, since a secret that may have been read is none.
void require_private(const fs::path& path, ExitCode code, bool folder) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0)
    throw Error(code, path.string(), fmt::format("cannot be read: {}", std::strerror(errno)),
                "strake keys makes the keys of a run");
  if (folder != S_ISDIR(found.st_mode) || (!folder && !S_ISREG(found.st_mode)))
    throw Error(code, path.string(), folder ? "is no folder" : "is no file",
                folder ? "name the folder that strake keys made" : "name the file that strake keys made");
  if (found.st_uid != geteuid() && found.st_uid != 0)
    throw Error(code, path.string(), "belongs to another user, who knows the secret in it", another);
  if ((found.st_mode & others) != 0)
    throw Error(code, path.string(),
                fmt::format("may be used by others than its owner (mode {:04o}), expected {}",
                            found.st_mode & 07777, folder ? "0700" : "0600"),
                fmt::format("chmod {} {}; if others could read it, {}", folder ? "700" : "600", path.string(),
                            another));
}

/// The lines `name = "value"` of a key file; '#' begins a comment.
std::map<std::string, std::string> read_entries(const fs::path& file, ExitCode code) {
  require_private(file, code, false);
  std::ifstream in(file);
  std::map<std::string, std::string> entries;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const std::size_t name_end = line.find(" = \"");
    if (name_end == std::string::npos || !line.ends_with('"') || line.size() < name_end + 5)
      throw Error(code, fmt::format("{}:{}", file.string(), number), "expected NAME = \"VALUE\"", another);
    entries[line.substr(0, name_end)] = line.substr(name_end + 4, line.size() - name_end - 5);
  }
  return entries;
}

std::string key_of(const std::map<std::string, std::string>& entries, const std::string& name,
                   const fs::path& file, ExitCode code) {
  const auto found = entries.find(name);
  if (found == entries.end() || found->second.size() != z85_length)
    throw Error(code, file.string(),
                fmt::format("{} {}: expected {} characters", name,
                            found == entries.end() ? "is missing" : "is no key", z85_length),
                another);
  return found->second;
}

KeyPair pair_of(const std::map<std::string, std::string>& entries, const fs::path& file, ExitCode code) {
  const KeyPair pair{key_of(entries, "public", file, code), key_of(entries, "secret", file, code)};
  if (!belong_together(pair))
    throw Error(code, file.string(), "the public key does not belong to the secret one", another);
  return pair;
}

void write_private(const fs::path& file, const std::string& text) {
  const int out = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (out < 0) cannot_write(file);
  const ssize_t n = write(out, text.data(), text.size());
  if (close(out) != 0 || n != static_cast<ssize_t>(text.size())) cannot_write(file);
}

bool is_name(const std::string& text) {
  return !text.empty() && text != "coupler" && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
}

}  // namespace

fs::path key_file(const fs::path& folder, const std::string& participant) {
  return folder / (participant + ".key");
}

void make_keys(const fs::path& folder, const std::vector<std::string>& participants) {
  for (const std::string& name : participants)
    if (!is_name(name))
      throw Error(ExitCode::command_line, fmt::format("\"{}\"", name), "is no name of a participant",
                  "letters, digits, '_' and '-'; \"coupler\" has a key of its own");
  std::error_code error;
  fs::create_directories(fs::absolute(folder).parent_path(), error);
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) cannot_write(folder);
  require_private(folder, ExitCode::command_line, true);
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".key")
      throw Error(ExitCode::command_line, folder.string(),
                  "holds keys already, and programs may be using them",
                  "name another folder, or remove this one");

  const KeyPair coupler = new_key_pair();
  std::string text = fmt::format(
      "# Keys of the coupler. They stay on its machine; the case names their folder: coupling.keys\n"
      "public = \"{}\"\nsecret = \"{}\"\n",
      coupler.public_key, coupler.secret_key);
  for (const std::string& name : participants) {
    const KeyPair pair = new_key_pair();
    text += fmt::format("admit.{} = \"{}\"\n", name, pair.public_key);
    write_private(key_file(folder, name),
                  fmt::format("# Keys of the participant \"{0}\", for its machine alone: STRAKE_KEY={0}.key\n"
                              "name = \"{0}\"\npublic = \"{1}\"\nsecret = \"{2}\"\ncoupler = \"{3}\"\n",
                              name, pair.public_key, pair.secret_key, coupler.public_key));
  }
  write_private(key_file(folder, "coupler"), text);
}

CouplerKeys read_coupler_keys(const fs::path& folder) {
  constexpr ExitCode code = ExitCode::case_file;
  require_private(folder, code, true);
  const fs::path file = key_file(folder, "coupler");
  const auto entries = read_entries(file, code);
  CouplerKeys keys{pair_of(entries, file, code), {}, folder};
  const std::string admit = "admit.";
  for (const auto& [name, value] : entries)
    if (name.starts_with(admit)) keys.admitted[name.substr(admit.size())] = key_of(entries, name, file, code);
  return keys;
}

ParticipantKeys read_participant_keys(const fs::path& file) {
  constexpr ExitCode code = ExitCode::command_line;
  const auto entries = read_entries(file, code);
  const auto name = entries.find("name");
  if (name == entries.end())
    throw Error(code, file.string(), "is not the key file of a participant",
                "the coupler's own key stays with the coupler; a participant has one that bears its name");
  return {name->second, pair_of(entries, file, code), key_of(entries, "coupler", file, code), file};
}

}  // namespace strake
