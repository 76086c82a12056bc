#include "coupler/run_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace strake {
namespace {

namespace fs = std::filesystem;

class RunFolderTest : public testing::Test {
 protected:
  RunFolderOptions options(const std::string& tag = {}) const {
    RunFolderOptions made;
    made.runs = place_.path() / "runs";
    made.tag = tag;
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

TEST_F(RunFolderTest, IsReplacedByForceOnlyWhenItHoldsARun) {
  const fs::path folder = create_run_folder(case_file, options()).path;
  std::ofstream(folder / "run.json") << "{}";
  RunFolderOptions force = options();
  force.force = true;
  EXPECT_EQ(refusal(force), ExitCode::done);
  EXPECT_FALSE(fs::exists(folder / "run.json"));
  std::ofstream(folder / "thesis.tex") << "years of work";
  EXPECT_EQ(refusal(force), ExitCode::command_line);
  EXPECT_TRUE(fs::exists(folder / "thesis.tex"));
}

TEST_F(RunFolderTest, CannotBeMadeBelowAFile) {
  std::ofstream(place_.path() / "runs") << "a file";
  EXPECT_EQ(refusal(options()), ExitCode::cannot_write);
}

TEST_F(RunFolderTest, RefusesATagThatWouldLeaveTheFolder) {
  EXPECT_EQ(refusal(options("../up")), ExitCode::command_line);
}

}  // namespace
}  // namespace strake
