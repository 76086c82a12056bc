// Tests what is on the disk at each moment. This program has an fsync, a rename and a symlink of its own,
// which record the calls and perform them.

#include "coupler/run/checkpoint.hpp"
#include "coupler/run/run_files.hpp"
#include "coupler/run/run_folder.hpp"
#include "proto/files/result_file.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/syscall.h>
#include <unistd.h>
#include <vector>

namespace {

std::vector<std::string> asked;  // "fsync FILE", "rename FILE", "symlink FILE": last part of each path

std::string last_part(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

}  // namespace

extern "C" int fsync(int file) {
  std::error_code ignored;
  asked.push_back(
      "fsync " +
      std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file), ignored).filename().string());
  return static_cast<int>(::syscall(SYS_fsync, file));
}

extern "C" int rename(const char* from, const char* to) noexcept {
  asked.push_back("rename " + last_part(to));
  return static_cast<int>(::syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to));
}

extern "C" int symlink(const char* to, const char* link) noexcept {
  asked.push_back("symlink " + last_part(link));
  return static_cast<int>(::syscall(SYS_symlinkat, to, AT_FDCWD, link));
}

namespace strake {
namespace {

namespace fs = std::filesystem;

class PowerCut : public testing::Test {
 protected:
  PowerCut() { asked.clear(); }
  std::ptrdiff_t place_of(const std::string& what) const {
    const auto found = std::find(asked.begin(), asked.end(), what);
    if (found != asked.end()) return found - asked.begin();
    ADD_FAILURE() << what << " was not asked of the system";
    return -1;
  }
  std::ptrdiff_t last_of(const std::string& what) const {
    const auto found = std::find(asked.rbegin(), asked.rend(), what);
    return found == asked.rend() ? -1 : asked.rend() - found - 1;
  }
  std::string name() const { return place_.path().filename().string(); }
  TemporaryFolder place_;
};

TEST_F(PowerCut, LeavesTheOldTextOrTheNewOne) {
  write_text(place_.path() / "summary.json", "{}");
  EXPECT_EQ(asked,
            (std::vector<std::string>{"fsync summary.json.part", "rename summary.json", "fsync " + name()}));
}

TEST_F(PowerCut, LeavesTheRecordOfARun) {
  RunRecord(place_.path(), {"strake"}).write();
  EXPECT_EQ(asked, (std::vector<std::string>{"fsync run.json.part", "rename run.json", "fsync " + name()}));
}

TEST_F(PowerCut, FindsACheckpointOnTheDiskBeforeItIsTheLatest) {
  const fs::path target = place_.path() / "checkpoint/000010";
  fs::create_directories(target);
  Archive archive;
  archive.real["x"] = Eigen::MatrixXd::Constant(3, 10, 1.5);
  write_archive(target / "coupler.h5", archive);
  std::ofstream(target / "fluid.h5") << "of a participant that does not wait for the disk";
  asked.clear();
  Checkpoints(place_.path()).complete("000010");
  const auto sealed = place_of("rename checksums"), link = place_of("rename latest");
  for (const char* file : {"coupler.h5", "fluid.h5", "checksums.part"})
    EXPECT_LT(place_of(std::string("fsync ") + file), sealed) << file;
  EXPECT_GT(place_of("fsync 000010"), sealed);  // the names in it
  for (const std::string& folder : {std::string("000010"), std::string("checkpoint"), name()})
    EXPECT_LT(place_of("fsync " + folder), link) << folder;
  EXPECT_GT(last_of("fsync checkpoint"), link);
}

TEST_F(PowerCut, LeavesTheRowsThatACheckpointGoesOnFrom) {
  RunFiles files({.folder = place_.path(),
                  .coupled = true,
                  .dimension = 2,
                  .columns = {},
                  .mesh = {"structure", 2, Points::Zero(3, 2), {}, {}},
                  .initial = {},
                  .measured = {},
                  .resumed = {},
                  .say = {}});
  const auto append = [&](int number) {
    CommittedWindow window;
    window.number = number;
    window.time = 0.1 * number;
    window.report.window = {0.1 * (number - 1), 0.1};
    window.report.displacement = window.report.force = Points::Zero(3, 2);
    files.append(window, {}, 0.5);
  };
  for (int number = 1; number <= 110; ++number) append(number);
  asked.clear();
  files.flush();
  for (const std::string& file :
       {std::string("history.csv"), std::string("iterations.csv"), std::string("000001.h5"),
        std::string("000002.h5"), std::string("interface"), name()})
    EXPECT_GE(place_of("fsync " + file), 0);
  // A block that was written in part is replaced by one that is on the disk.
  asked.clear();
  for (int number = 111; number <= 200; ++number) append(number);
  EXPECT_LT(place_of("fsync 000002.h5.part"), place_of("rename 000002.h5"));
}

}  // namespace
}  // namespace strake
