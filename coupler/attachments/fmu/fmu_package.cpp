#include "coupler/attachments/fmu/fmu_package.hpp"

#include "proto/error.hpp"
#include "proto/files/whole_file.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <fcntl.h>
#include <fstream>
#include <memory>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace strake {

namespace fs = std::filesystem;

namespace {

constexpr zip_int64_t most_entries = 100'000;
const std::string is_zip = "an FMU is a zip archive with modelDescription.xml and binaries";

struct CloseZip {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_file_t* entry) const { zip_fclose(entry); }
};
using OpenZip = std::unique_ptr<zip_t, CloseZip>;
using OpenEntry = std::unique_ptr<zip_file_t, CloseZip>;

/// Whether a name stays below the folder that it is unpacked into.
bool stays_inside(const std::string& name) {
  if (name.empty() || name.front() == '/' || name.find('\\') != std::string::npos) return false;
  const fs::path path(name);
  return !path.is_absolute() && std::none_of(path.begin(), path.end(), [](const fs::path& part) {
    return part == ".." || part == ".";
  });
}

/// One archive, entry by entry.
class Unpacking {
 public:
  Unpacking(const fs::path& file, fs::path folder, std::uint64_t largest)
      : file_(file.string()), folder_(std::move(folder)), largest_(largest) {
    int code = 0;
    archive_.reset(zip_open(file_.c_str(), ZIP_RDONLY, &code));
    if (archive_) return;
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string why = zip_error_strerror(&error);
    zip_error_fini(&error);
    throw Error(ExitCode::case_file, file_, "cannot be unpacked: " + why, is_zip);
  }

  void run() {
    const zip_int64_t n = zip_get_num_entries(archive_.get(), 0);
    if (n > most_entries) refuse(fmt::format("holds {} files, at most {}", n, most_entries));
    for (zip_int64_t k = 0; k < n; ++k) take(static_cast<zip_uint64_t>(k));
  }

 private:
  [[noreturn]] void refuse(const std::string& problem, const std::string& fix = is_zip) const {
    throw Error(ExitCode::case_file, file_, problem, fix);
  }

  void take(zip_uint64_t index) {
    zip_stat_t about;
    if (zip_stat_index(archive_.get(), index, 0, &about) != 0 || (about.valid & ZIP_STAT_NAME) == 0)
      refuse(fmt::format("cannot be unpacked: {}", zip_strerror(archive_.get())));
    const std::string name = about.name, shown = visible(name, "");
    if (!stays_inside(name)) refuse(fmt::format("holds \"{}\", which leads out of it", shown));
    zip_uint8_t system = 0;
    zip_uint32_t attributes = 0;
    zip_file_get_external_attributes(archive_.get(), index, 0, &system, &attributes);
    const mode_t mode = system == ZIP_OPSYS_UNIX ? static_cast<mode_t>(attributes >> 16) & S_IFMT : 0;
    if (mode != 0 && mode != S_IFREG && mode != S_IFDIR)
      refuse(fmt::format("holds \"{}\", which is a link or a device", shown), "pack the file itself");
    std::error_code failed;
    const fs::path target = folder_ / name;
    const bool is_folder = name.back() == '/';
    fs::create_directories(is_folder ? target : target.parent_path(), failed);
    if (failed) refuse(fmt::format("\"{}\" cannot be unpacked: {}", shown, failed.message()));
    if (is_folder) return;
    if (fs::exists(target, failed)) refuse(fmt::format("holds \"{}\" twice", shown));
    copy(index, target, shown);
  }

  /// libzip compares the checksum at the end of the entry.
  void copy(zip_uint64_t index, const fs::path& target, const std::string& shown) {
    const OpenEntry entry(zip_fopen_index(archive_.get(), index, 0));
    if (!entry) refuse(fmt::format("\"{}\" cannot be unpacked: {}", shown, zip_strerror(archive_.get())));
    std::ofstream out(target, std::ios::binary);
    std::vector<char> bytes(1 << 16);
    zip_int64_t n = 0;
    while ((n = zip_fread(entry.get(), bytes.data(), bytes.size())) > 0) {
      total_ += static_cast<std::uint64_t>(n);
      if (total_ > largest_)
        refuse(fmt::format("unpacks to more than {} bytes", largest_),
               "leave out what the model does not need");
      out.write(bytes.data(), n);
    }
    if (n < 0)
      refuse(fmt::format("\"{}\" cannot be unpacked: {}", shown, zip_file_strerror(entry.get())), is_zip);
    if (!out.flush()) throw cannot_write(target, errno);
  }

  std::string file_;
  fs::path folder_;
  OpenZip archive_;
  std::uint64_t largest_, total_ = 0;  // [bytes] of all entries together; unpacked so far
};

const std::string prefix = "strake-fmu-";

/// An exclusive lock of a folder, which ends with its process however that ends; none: somebody has it.
Descriptor lock_of(const fs::path& folder) {
  Descriptor lock(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (lock.get() >= 0 && ::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) lock = Descriptor();
  return lock;
}

/// Removes our own folders that no process has locked. A young one may be about to be locked.
void remove_abandoned(const fs::path& place) {
  constexpr std::time_t young = 60;  // [s]
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(place, ignored)) {
    if (!entry.path().filename().string().starts_with(prefix)) continue;
    const Descriptor lock = lock_of(entry.path());
    struct stat about {};
    if (lock.get() < 0 || ::fstat(lock.get(), &about) != 0 || about.st_uid != ::geteuid()) continue;
    if (std::time(nullptr) - about.st_mtime < young) continue;
    std::error_code failed;
    fs::remove_all(entry.path(), failed);
  }
}

}  // namespace

std::string fmu_platform() {
#if defined(__x86_64__)
  return "x86_64-linux";
#elif defined(__aarch64__)
  return "aarch64-linux";
#else
  return "";
#endif
}

FmuPackage::FmuPackage(const fs::path& file, std::uint64_t largest) : file_(file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    folder_ = fs::absolute(file);
    return;
  }
  require_file(file, largest, file.string());
  fs::path place = fs::temp_directory_path(ignored);
  if (place.empty()) place = "/tmp";
  remove_abandoned(place);
  std::string name = (place / (prefix + "XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr) throw cannot_write(name, errno);
  folder_ = name;
  lock_ = lock_of(folder_);
  temporary_ = true;
  try {
    Unpacking(file, folder_, largest).run();
  } catch (...) {
    remove();  // no destructor runs
    throw;
  }
}

void FmuPackage::remove() {
  std::error_code ignored;
  if (std::exchange(temporary_, false)) fs::remove_all(folder_, ignored);
  lock_ = Descriptor();
}

fs::path FmuPackage::library(const std::string& model_identifier) const {
  const fs::path binaries = folder_ / "binaries",
                 wanted = binaries / fmu_platform() / (model_identifier + ".so");
  std::error_code ignored;
  if (!fmu_platform().empty() && fs::is_regular_file(wanted, ignored)) return wanted;
  std::vector<std::string> others;
  for (const fs::directory_entry& entry : fs::directory_iterator(binaries, ignored))
    others.push_back(visible(entry.path().filename().string(), ""));
  std::sort(others.begin(), others.end());
  throw Error(ExitCode::case_file, file_.string(),
              fmt::format("has no {}; its binaries are for: {}", wanted.lexically_relative(folder_).string(),
                          others.empty() ? "no platform" : joined(others)),
              "export it for " + fmu_platform() + ", the platform of this machine");
}

std::string FmuPackage::resources() const {
  std::error_code ignored;
  const fs::path place = folder_ / "resources";
  return fs::is_directory(place, ignored) ? place.string() + "/" : std::string();
}

}  // namespace strake
