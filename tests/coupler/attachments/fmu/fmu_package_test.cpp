#include "tests/coupler/attachments/fmu/fmu_case.hpp"

#include <zip.h>

#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace strake {
namespace fmu_package_test {

/// A zip archive with one entry beside a description.
std::filesystem::path archive_with(const ScratchFolder& scratch, const std::string& name,
                                   const std::string& content, mode_t mode = S_IFREG | 0644) {
  const std::filesystem::path file = scratch / "made.fmu";
  int failed = 0;
  zip_t* archive = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &failed);
  const auto add = [&](const std::string& entry, const std::string& text) {
    return zip_file_add(archive, entry.c_str(), zip_source_buffer(archive, text.data(), text.size(), 0),
                        ZIP_FL_ENC_UTF_8);
  };
  const std::string description = "<x/>";
  EXPECT_GE(add("modelDescription.xml", description), 0);
  const zip_int64_t index = add(name, content);
  EXPECT_GE(index, 0);
  zip_file_set_external_attributes(archive, static_cast<zip_uint64_t>(index), 0, ZIP_OPSYS_UNIX,
                                   static_cast<zip_uint32_t>(mode) << 16);
  EXPECT_EQ(zip_close(archive), 0);
  return file;
}

std::string said_of(const std::filesystem::path& file) {
  return error_of([&] { const FmuPackage package(file); }, ExitCode::case_file);
}

TEST(FmuPackage, IsUnpackedAndRemoved) {
  std::filesystem::path folder;
  {
    const FmuPackage package(packed_fmu);
    folder = package.folder();
    EXPECT_EQ(text_of(folder / "modelDescription.xml"), text_of(fmu_folder / "modelDescription.xml"));
    EXPECT_EQ(text_of(package.library("oscillator")),
              text_of(fmu_folder / "binaries" / STRAKE_FMU_PLATFORM / "oscillator.so"));
    EXPECT_EQ(package.resources(), (folder / "resources").string() + "/");
    struct stat about {};
    ASSERT_EQ(stat(folder.c_str(), &about), 0);
    EXPECT_EQ(about.st_mode & 0777, 0700u);
  }
  EXPECT_FALSE(std::filesystem::exists(folder));
}

/// A folder as a process leaves it that is killed; it was made an hour ago.
std::filesystem::path left_over(const ScratchFolder& place, const std::string& name) {
  std::filesystem::create_directories(place / name / "binaries");
  std::ofstream(place / name / "modelDescription.xml") << "<x/>";
  std::filesystem::last_write_time(place / name,
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  return place / name;
}

TEST(FmuPackage, RemovesWhatAKilledProcessHasLeftAndNothingElse) {
  const ScratchFolder place;
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  setenv("TMPDIR", (place / "").c_str(), 1);
  const auto abandoned = left_over(place, "strake-fmu-aaaaaa"), used = left_over(place, "strake-fmu-bbbbbb"),
             foreign = left_over(place, "strake-other");
  const int lock = open(used.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(flock(lock, LOCK_EX | LOCK_NB), 0);
  const FmuPackage first(packed_fmu);
  std::filesystem::last_write_time(first.folder(),
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  const FmuPackage second(packed_fmu);
  EXPECT_FALSE(std::filesystem::exists(abandoned));
  EXPECT_TRUE(std::filesystem::exists(used / "modelDescription.xml")) << "its process lives";
  EXPECT_TRUE(std::filesystem::exists(foreign / "modelDescription.xml"));
  EXPECT_TRUE(std::filesystem::exists(first.folder() / "modelDescription.xml")) << "in use here";
  close(lock);
  if (before == nullptr)
    unsetenv("TMPDIR");
  else
    setenv("TMPDIR", kept.c_str(), 1);
}

TEST(FmuPackage, AFolderIsTakenAsItIs) {
  {
    const FmuPackage package(fmu_folder);
    EXPECT_EQ(package.folder(), std::filesystem::absolute(fmu_folder));
  }
  EXPECT_TRUE(std::filesystem::exists(fmu_folder / "modelDescription.xml"));
}

TEST(FmuPackage, RefusesWhatIsNoArchive) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "text.fmu") << "modelDescription.xml";
  EXPECT_NE(said_of(scratch / "text.fmu").find("cannot be unpacked: Not a zip archive"), std::string::npos);
  EXPECT_NE(said_of(scratch / "none.fmu"), "");
}

TEST(FmuPackage, RefusesADamagedArchive) {
  const ScratchFolder scratch;
  const std::string whole = text_of(packed_fmu);
  std::ofstream(scratch / "cut.fmu", std::ios::binary) << whole.substr(0, whole.size() / 2);
  EXPECT_NE(said_of(scratch / "cut.fmu").find("cannot be unpacked"), std::string::npos);
  std::string changed = whole;
  for (std::size_t at = changed.size() / 4; at < changed.size() / 4 + 40; ++at) changed[at] ^= 0x55;
  std::ofstream(scratch / "changed.fmu", std::ios::binary) << changed;
  EXPECT_NE(said_of(scratch / "changed.fmu").find("cannot be unpacked"), std::string::npos);
}

TEST(FmuPackage, RefusesEntriesThatLeadOutOfIt) {
  const ScratchFolder scratch;
  for (const std::string name : {"../evil", "binaries/../../evil", "/tmp/evil", "binaries\\..\\evil", "./x"})
    EXPECT_NE(said_of(archive_with(scratch, name, "x")).find("which leads out of it"), std::string::npos)
        << name;
  EXPECT_FALSE(std::filesystem::exists(scratch.path().parent_path() / "evil"));
}

TEST(FmuPackage, RefusesLinksAndNamesThatMeet) {
  const ScratchFolder scratch;
  EXPECT_NE(said_of(archive_with(scratch, "resources", "/etc", S_IFLNK | 0777)).find("is a link"),
            std::string::npos);
  EXPECT_NE(said_of(archive_with(scratch, "modelDescription.xml/x", "x")).find("cannot be unpacked"),
            std::string::npos);
}

TEST(FmuPackage, RefusesAnArchiveThatUnpacksToTooMuch) {
  const ScratchFolder scratch;
  const std::string zeros(1 << 20, '\0');
  const std::filesystem::path bomb = archive_with(scratch, "resources/zeros", zeros);
  EXPECT_LT(std::filesystem::file_size(bomb), 4096u);
  const std::string said =
      error_of([&] { const FmuPackage package(bomb, zeros.size()); }, ExitCode::case_file);
  EXPECT_NE(said.find("unpacks to more than 1048576 bytes"), std::string::npos) << said;
}

TEST(FmuPackage, RefusesAnArchiveWithoutDescription) {
  const ScratchFolder scratch;
  FmuParameters p = oscillator_of();
  p.file = scratch.path();
  EXPECT_NE(error_of([&] { FmuAttachment(p, setup_of()); }, ExitCode::case_file)
                .find("holds no modelDescription.xml, so it is no FMU"),
            std::string::npos);
}

}  // namespace fmu_package_test
}  // namespace strake
