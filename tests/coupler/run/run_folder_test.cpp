#include "coupler/run/run_folder.hpp"

#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sys/stat.h>

namespace strake {
namespace run_folder_test {

namespace fs = std::filesystem;

class RunFolderTest : public testing::Test {
 protected:
  RunFolderOptions options(const std::string& tag = {}) const {
    RunFolderOptions made;
    made.runs = place_.path() / "runs";
    made.tag = tag;
    return made;
  }
  RunFolderOptions forced() const {
    RunFolderOptions made = options();
    made.force = true;
    return made;
  }
  ExitCode refusal(const RunFolderOptions& asked) const {
    try {
      create_run_folder(case_file, asked);
    } catch (const Error& error) {
      return error.code();
    }
    return ExitCode::done;
  }
  TemporaryFolder place_;
  const fs::path case_file = "cases/plate_entry.toml";
};

TEST_F(RunFolderTest, IsNamedAfterTheCaseAndTheTag) {
  EXPECT_EQ(create_run_folder(case_file, options()).path, place_.path() / "runs/plate_entry");
  EXPECT_EQ(create_run_folder(case_file, options("rigid")).path, place_.path() / "runs/plate_entry-rigid");
  EXPECT_TRUE(fs::is_directory(place_.path() / "runs/plate_entry-rigid"));
}

TEST_F(RunFolderTest, IsRefusedWhenItExists) {
  create_run_folder(case_file, options());
  EXPECT_EQ(refusal(options()), ExitCode::command_line);
}

TEST_F(RunFolderTest, TakesTheFirstFreeNumberWhenAsked) {
  RunFolderOptions free = options();
  free.first_free_tag = true;
  EXPECT_EQ(create_run_folder(case_file, free).path.filename(), "plate_entry");
  EXPECT_EQ(create_run_folder(case_file, free).path.filename(), "plate_entry-2");
  EXPECT_EQ(create_run_folder(case_file, free).path.filename(), "plate_entry-3");
  free.tag = "fine";
  EXPECT_EQ(create_run_folder(case_file, free).tag, "fine");
  EXPECT_EQ(create_run_folder(case_file, free).tag, "fine-2");
}

TEST_F(RunFolderTest, IsReplacedByForceWhenItHoldsARun) {
  const fs::path folder = create_run_folder(case_file, options()).path;
  RunRecord(folder, {"strake", "run", "cases/plate_entry.toml"}).write();
  EXPECT_EQ(refusal(forced()), ExitCode::done);
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(RunFolderTest, IsLeftAloneByForceWhenItsRecordIsNotThatOfARun) {
  const fs::path folder = create_run_folder(case_file, options()).path;
  std::ofstream(folder / "case.toml") << "title = 'a folder of the user'";
  std::ofstream(folder / "thesis.tex") << "years of work";
  for (const char* record : {"", "{", "[]", "{}", "{\"strake\": \"1.0\"}", "{\"command\": []}"}) {
    std::ofstream(folder / "run.json") << record;
    EXPECT_EQ(refusal(forced()), ExitCode::command_line) << record;
    EXPECT_TRUE(fs::exists(folder / "thesis.tex")) << record;
  }
  fs::remove(folder / "run.json");
  EXPECT_EQ(refusal(forced()), ExitCode::command_line);
  EXPECT_TRUE(fs::exists(folder / "thesis.tex"));
}

TEST_F(RunFolderTest, TakesAnEmptyFolderAsItIsUnderForce) {
  const fs::path folder = create_run_folder(case_file, options()).path;
  struct stat before {
  }, after{};
  ASSERT_EQ(::stat(folder.c_str(), &before), 0);
  EXPECT_EQ(refusal(forced()), ExitCode::done);
  ASSERT_EQ(::stat(folder.c_str(), &after), 0);
  EXPECT_EQ(before.st_ctim.tv_nsec, after.st_ctim.tv_nsec);  // not even made anew
}

TEST_F(RunFolderTest, IsNotFollowedByForceWhenItIsALink) {
  const fs::path elsewhere = place_.path() / "elsewhere";
  fs::create_directories(elsewhere);
  fs::create_directories(place_.path() / "runs");
  RunRecord(elsewhere, {"strake"}).write();
  fs::create_directory_symlink(elsewhere, place_.path() / "runs/plate_entry");
  EXPECT_EQ(refusal(forced()), ExitCode::command_line);
  EXPECT_TRUE(fs::exists(elsewhere / "run.json"));
  EXPECT_TRUE(fs::is_symlink(place_.path() / "runs/plate_entry"));
}

TEST_F(RunFolderTest, RefusesAFileUnderForce) {
  fs::create_directories(place_.path() / "runs");
  std::ofstream(place_.path() / "runs/plate_entry") << "a file";
  EXPECT_EQ(refusal(forced()), ExitCode::command_line);
  EXPECT_TRUE(fs::exists(place_.path() / "runs/plate_entry"));
}

TEST_F(RunFolderTest, RefusesANameThatTheDiskCannotHold) {
  EXPECT_EQ(refusal(options(std::string(300, 'x'))), ExitCode::command_line);
}

TEST_F(RunFolderTest, RefusesLinksThatLeadInACircle) {
  fs::create_symlink(place_.path() / "b", place_.path() / "a");
  fs::create_symlink(place_.path() / "a", place_.path() / "b");
  RunFolderOptions circle = options();
  circle.runs = place_.path() / "a";
  EXPECT_EQ(refusal(circle), ExitCode::cannot_write);
  EXPECT_THROW(find_run_folder(case_file, circle), Error);
}

TEST_F(RunFolderTest, CannotBeMadeBelowAFile) {
  std::ofstream(place_.path() / "runs") << "a file";
  EXPECT_EQ(refusal(options()), ExitCode::cannot_write);
}

TEST_F(RunFolderTest, RefusesATagThatWouldLeaveTheFolder) {
  EXPECT_EQ(refusal(options("../up")), ExitCode::command_line);
}

}  // namespace run_folder_test
}  // namespace strake
