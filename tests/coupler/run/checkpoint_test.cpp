// The checkpoint from which a run resumes, and the content of its files: without processes.

#include "coupler/run/checkpoint.hpp"

#include "coupler/run/run_files.hpp"
#include "coupler/run/run_folder.hpp"
#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "tests/proto/temporary_folder.hpp"
#include "tests/text/golden.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>

namespace strake {
namespace checkpoint_test {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class CheckpointTest : public testing::Test {
 protected:
  fs::path folder(const std::string& name) const { return place_.path() / "checkpoint" / name; }
  void checkpoint(const std::string& name, bool latest = true) const {
    fs::create_directories(folder(name));
    Archive archive;
    archive.real["x"] = Eigen::MatrixXd::Constant(3, 100, 1.5);
    for (const char* file : {"fluid.h5", "coupler.h5"}) write_archive(folder(name) / file, archive);
    write_checksums(folder(name));
    fs::remove_all(folder("latest"));
    if (latest) fs::create_directory_symlink(name, folder("latest"));
  }
  void cut(const std::string& name, const std::string& file) const {
    fs::resize_file(folder(name) / file, fs::file_size(folder(name) / file) - 100);
  }
  std::string chosen() {
    return Checkpoints(place_.path())
        .choose([this](const std::string& line) { said_ += line + "\n"; })
        .filename();
  }
  void expect_refusal(ExitCode code, const std::function<void()>& act) {
    try {
      act();
      ADD_FAILURE() << "nothing is refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code);
      said_ += to_text(error);
    }
    expect_text();
  }
  void expect_text() const {
    std::string text = without_chance(said_, place_.path().string());
    const std::string name = place_.path().filename().string();
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name))
      text.replace(at, name.size(), "RUN");
    expect_stored("resume.txt", this_test(), text);
  }
  TemporaryFolder place_;
  std::string said_;
};

TEST_F(CheckpointTest, TheLatestIsTakenAndWhatLiesAfterItIsNot) {
  checkpoint("000010");
  checkpoint("000020");
  fs::create_directories(folder("000030"));  // was being written
  EXPECT_EQ(chosen(), "000020");
  EXPECT_EQ(said_, "");
}

TEST_F(CheckpointTest, AfterAMillionWindowsTheLargestNumberIsStillTheLatest) {
  checkpoint("999999");
  checkpoint("1000000", false);
  EXPECT_EQ(chosen(), "1000000");
}

TEST_F(CheckpointTest, ADamagedOneGivesWayToTheOneBeforeWithAWord) {
  checkpoint("000010");
  checkpoint("000020");
  cut("000020", "fluid.h5");
  EXPECT_EQ(chosen(), "000010");
  expect_text();
}

TEST_F(CheckpointTest, OneByteThatChangedIsDamage) {
  checkpoint("000010");
  checkpoint("000020");
  std::fstream file(folder("000020") / "coupler.h5", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(-5, std::ios::end);
  file.put('x');
  file.close();
  EXPECT_EQ(chosen(), "000010");
  expect_text();
}

TEST_F(CheckpointTest, OneThatIsMissingAFileIsDamaged) {
  checkpoint("000010");
  checkpoint("000020");
  fs::remove(folder("000020") / "coupler.h5");
  EXPECT_EQ(chosen(), "000010");
  expect_text();
}

TEST_F(CheckpointTest, WithoutTheLinkTheLargestThatIsWholeIsTaken) {
  checkpoint("000010");
  checkpoint("000020", false);
  fs::create_directories(folder("000030"));
  EXPECT_EQ(chosen(), "000020");
  expect_text();
}

/// A run that was copied with its links followed: `latest` is a folder like its neighbours.
TEST_F(CheckpointTest, WhereTheLinkHasBecomeAFolderTheLargestThatIsWholeIsTaken) {
  checkpoint("000010");
  checkpoint("000020", false);
  fs::copy(folder("000010"), folder("latest"));
  EXPECT_EQ(chosen(), "000020");
  cut("000020", "fluid.h5");
  EXPECT_EQ(chosen(), "000010");
}

TEST_F(CheckpointTest, WhereTheLinkHasBecomeAFolderTheNextOneIsALinkAgain) {
  checkpoint("000010");
  checkpoint("000020", false);
  fs::copy(folder("000010"), folder("latest"));
  Checkpoints(place_.path()).complete("000020");
  EXPECT_EQ(fs::read_symlink(folder("latest")), "000020");
  EXPECT_EQ(damage(folder("000010")), "");
  EXPECT_EQ(chosen(), "000020");
}

TEST_F(CheckpointTest, TheLatestIsNeverWrittenThrough) {
  const TemporaryFolder elsewhere;
  checkpoint("000010", false);
  fs::create_directory_symlink(elsewhere.path(), folder("latest"));
  Checkpoints(place_.path()).complete("000010");
  EXPECT_EQ(fs::read_symlink(folder("latest")), "000010");
  EXPECT_TRUE(fs::is_empty(elsewhere.path()));
}

TEST_F(CheckpointTest, ARunThatGoesOnKeepsTheDefaultsItBeganWith) {
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(place_.path() / name) << text;
    return place_.path() / name;
  };
  const fs::path given = write("given.toml", "end_time = 2.0\n");
  using Sets = std::vector<std::string>;
  EXPECT_EQ(settled_sets(given, {"a=1"}, place_.path()), Sets{"a=1"}) << "no case.toml there";
  write("case.toml", "[fluid.scheme]\ntime_step = inf\n[coupling.surface]\nwindow = 5e-05\n");
  EXPECT_EQ(
      settled_sets(given, {}, place_.path()),
      (Sets{"fluid.scheme.time_step=inf", "coupling.surface.window=5e-05", "output.default_probes=false"}));
  write("case.toml",
        "[fluid.scheme]\ntime_step = inf\n[coupling.surface]\nwindow = 5e-05\n[output]\ndefault_probes = "
        "true\n");
  const Sets own = {"coupling.surface.window=1e-5", "fluid.scheme.time_step=1e-6"};
  EXPECT_EQ(settled_sets(given, own, place_.path()), own) << "the user's own are compared, not replaced";
}

TEST_F(CheckpointTest, ADamagedCaseOfTheRunIsNamedWithItsFolder) {
  std::ofstream(place_.path() / "case.toml") << "title = \"a\x01\"\n";
  try {
    settled_sets("given.toml", {}, place_.path());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), (place_.path() / "case.toml").string() + ":1:11");
    EXPECT_TRUE(error.problem().starts_with("not TOML: ")) << error.problem();
    EXPECT_FALSE(error.fix().empty());
  }
}

TEST_F(CheckpointTest, NoneAtAllIsRefused) {
  expect_refusal(ExitCode::command_line, [&] { chosen(); });
}

TEST_F(CheckpointTest, NoneThatIsWholeIsRefusedWithTheReasonOfEach) {
  checkpoint("000010");
  checkpoint("000020");
  cut("000020", "fluid.h5");
  fs::remove(folder("000010") / checksums_name);
  expect_refusal(ExitCode::case_file, [&] { chosen(); });
}

/// history.csv, iterations.csv and interface/ of three windows.
class RunFilesTest : public CheckpointTest {
 protected:
  RunFiles files(std::optional<LoopState> resumed = std::nullopt) {
    return RunFiles({.folder = place_.path(),
                     .coupled = true,
                     .mechanical = mechanical_,
                     .dimension = 2,
                     .columns = {},
                     .mesh = {"structure", 2, Points::Zero(3, 2), {}, {}},
                     .initial = {},
                     .measured = {},
                     .resumed = resumed,
                     .say = [this](const std::string& line) { said_ += line + "\n"; }});
  }
  static CommittedWindow window(long number) {
    CommittedWindow made;
    made.number = number;
    made.time = 0.1 * static_cast<double>(number);
    made.report.window = {0.1 * static_cast<double>(number - 1), 0.1};
    made.report.displacement = made.report.force = Points::Constant(3, 2, static_cast<double>(number) / 3);
    made.report.log.resize(2);
    for (int k = 0; k < 2; ++k) made.report.log[static_cast<std::size_t>(k)].iteration = k + 1;
    return made;
  }
  LoopState after(long windows) const {
    LoopState state;
    state.time = 0.1 * static_cast<double>(windows);
    state.windows = windows;
    return state;
  }
  void record(long first, long last, std::optional<LoopState> resumed = std::nullopt) {
    RunFiles written = files(resumed);
    for (long n = first; n <= last; ++n) written.append(window(n), {}, 0.5);
    written.flush();
  }
  std::string bytes() const {
    std::string all;
    for (const char* name : {"history.csv", "iterations.csv", "timing.csv", "interface/000001.h5"})
      all += content(place_.path() / name);
    return all;
  }
  std::string head(const std::string& file) const {
    const std::string text = content(place_.path() / file);
    return text.substr(0, text.find('\n'));
  }
  bool mechanical_ = true;
};

TEST_F(RunFilesTest, OfARunWithoutForceHaveNoColumnsOfIt) {
  mechanical_ = false;
  record(1, 5);
  EXPECT_EQ(head("history.csv"), "window [1],time [s],iterations [1],residual [m]");
  EXPECT_EQ(
      head("iterations.csv"),
      "window [1],time [s],iteration [1],residual [m],threshold [m],relaxation [1],columns [1],dropped [1]");
  const std::string whole = bytes();
  record(4, 5, after(3));
  EXPECT_EQ(bytes(), whole);
}

TEST_F(RunFilesTest, OfARunWithoutForceThatAnEarlierVersionBeganKeepItsColumns) {
  record(1, 5);
  const std::string before = head("history.csv"), whole = bytes();
  mechanical_ = false;
  record(4, 5, after(3));
  EXPECT_EQ(head("history.csv"), before);
  EXPECT_EQ(bytes(), whole);
}

TEST_F(RunFilesTest, GoOnFromAWindowToTheSameBytes) {
  record(1, 5);
  const std::string whole = bytes();
  record(4, 5, after(3));
  EXPECT_EQ(bytes(), whole);
}

TEST_F(RunFilesTest, OfAKilledRunLoseTheRowThatWasCutShort) {
  record(1, 5);
  const std::string whole = bytes();
  std::ofstream(place_.path() / "history.csv", std::ios::app) << "6,0.";
  record(4, 5, after(3));
  EXPECT_EQ(bytes(), whole);
}

TEST_F(RunFilesTest, GoOnThoughTheTimesOfTheClockAreDamaged) {
  record(1, 5);
  const std::string history = content(place_.path() / "history.csv");
  std::ofstream(place_.path() / "timing.csv") << "window [1],time [s],wall [s]\n1,0.1,not a number\n";
  record(4, 5, after(3));
  EXPECT_EQ(content(place_.path() / "history.csv"), history);
  EXPECT_EQ(content(place_.path() / "timing.csv"), "window [1],time [s],wall [s]\n4,0.4,0.5\n5,0.5,0.5\n");
  EXPECT_NE(content(place_.path() / "timing-1.csv").find("not a number"), std::string::npos);
  fs::remove(place_.path() / "timing.csv");
  record(5, 5, after(4));
  EXPECT_EQ(content(place_.path() / "timing.csv"), "window [1],time [s],wall [s]\n5,0.5,0.5\n");
  expect_text();
}

TEST_F(RunFilesTest, GoOnThoughABlockAfterTheCheckpointIsDamaged) {
  record(1, 100);
  const std::string whole = content(place_.path() / "interface/000001.h5");
  std::ofstream(place_.path() / "interface/000002.h5") << "cut by the power";
  record(101, 102, after(100));
  EXPECT_EQ(content(place_.path() / "interface/000001.h5"), whole);
  EXPECT_EQ(read_interface_record(place_.path()).windows.size(), 102u);
}

TEST_F(RunFilesTest, ThatEndBeforeTheCheckpointAreRefused) {
  record(1, 2);
  expect_refusal(ExitCode::case_file, [&] { files(after(3)); });
}

TEST_F(RunFilesTest, WithAnInterfaceRecordThatEndsBeforeTheCheckpointAreRefused) {
  record(1, 5);
  fs::remove(place_.path() / "interface/000001.h5");
  expect_refusal(ExitCode::case_file, [&] { files(after(3)); });
}

TEST_F(RunFilesTest, OfAFolderInWhichARunIsUnderWayAreLeftAlone) {
  const FolderLock first(place_.path());
  expect_refusal(ExitCode::command_line, [&] { FolderLock second(place_.path()); });
}

TEST(FolderLockTest, IsFreeAgainWhenItsRunIsOver) {
  const TemporaryFolder place;
  { const FolderLock first(place.path()); }
  EXPECT_NO_THROW(FolderLock second(place.path()));
}

}  // namespace checkpoint_test
}  // namespace strake
