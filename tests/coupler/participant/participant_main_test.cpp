#include "coupler/participant/participant_main.hpp"

#include "proto/case/case_file.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

namespace strake {
namespace participant_main_test {

/// A program with one number, so that the modes have something to show.
Program toy() {
  Program program{"strake-structure-toy", "toy", "0.1.0", "structure", {}, {}, {}};
  program.declare = [](CaseFile& file) {
    double young = 0;
    file.root()
        .table("structure")
        .number("young", young,
                {.unit = "Pa",
                 .min = 0,
                 .exclusive = true,
                 .required = true,
                 .paper = {},
                 .help = "Young's modulus"});
  };
  program.properties = [](CaseFile&) { return "toy   1 kg\n"; };
  program.check = [](CaseFile&) { return std::vector<std::string>{"f1 dry 699 Hz"}; };
  return program;
}

class ParticipantMain : public testing::Test {
 protected:
  std::string file(const std::string& text) const {
    const auto path = folder_ / "case.toml";
    put(path, text);
    return path.string();
  }
  /// Runs main with these words and keeps what it prints.
  int run(std::vector<std::string> words) {
    words.insert(words.begin(), "strake-structure-toy");
    std::vector<char*> argv;
    for (std::string& w : words) argv.push_back(w.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = participant_main(static_cast<int>(argv.size()), argv.data(), toy());
    out_ = testing::internal::GetCapturedStdout();
    err_ = testing::internal::GetCapturedStderr();
    return code;
  }
  TemporaryFolder folder_;
  std::string out_, err_;
};

TEST_F(ParticipantMain, VersionNamesProgramVersionAndSolver) {
  EXPECT_EQ(run({"--version"}), 0);
  EXPECT_EQ(out_, "strake-structure-toy 0.1.0 (toy)\n");
}

TEST_F(ParticipantMain, KeysComeBackAsTheyWereDeclared) {
  EXPECT_EQ(run({"--keys"}), 0);
  const auto keys = keys_from_json(out_);
  ASSERT_EQ(keys.size(), 1u);
  EXPECT_EQ(keys[0].path, "structure.young");
  EXPECT_EQ(keys[0].unit, "Pa");
}

TEST_F(ParticipantMain, EchoResolvesTheCaseWithItsSets) {
  const std::string path = file("[structure]\nyoung = 1.0\n");
  EXPECT_EQ(run({"--echo", "--case", path, "--set", "structure.young=2.5"}), 0) << err_;
  EXPECT_NE(out_.find("2.5"), std::string::npos) << out_;
  EXPECT_EQ(run({"--echo", path}), 0) << "the case may stand without --case: " << err_;
}

TEST_F(ParticipantMain, CheckPrintsDerivedNumbers) {
  EXPECT_EQ(run({"--check", "--case", file("[structure]\nyoung = 1.0\n[fluid]\nspacing = 1\n")}), 0) << err_;
  EXPECT_EQ(out_, "f1 dry 699 Hz\n");
}

// A run asks a program once before it starts, not once for its numbers and once for its values.
TEST_F(ParticipantMain, ACheckPrintsTheValuesOfTheEchoAsWell) {
  const std::string path = file("[structure]\nyoung = 1.0\n");
  EXPECT_EQ(run({"--echo", path}), 0);
  const std::string echo = out_;
  EXPECT_EQ(run({"--check", "--values", path}), 0) << err_;
  EXPECT_EQ(out_, "f1 dry 699 Hz\n" + std::string(values_line) + echo);
}

TEST_F(ParticipantMain, ACheckPrintsItsLineOfTheTableBeforeTheValues) {
  const std::string path = file("[structure]\nyoung = 1.0\n");
  EXPECT_EQ(run({"--properties", path}), 0);
  const std::string row = out_;
  EXPECT_EQ(row, "toy   1 kg\n");
  EXPECT_EQ(run({"--echo", path}), 0);
  const std::string echo = out_;
  EXPECT_EQ(run({"--check", "--values", "--table", path}), 0) << err_;
  EXPECT_EQ(out_, "f1 dry 699 Hz\n" + std::string(table_line) + row + values_line + echo);
}

TEST_F(ParticipantMain, ChecksRefuseWrongValuesAndUnknownKeysOfTheirPart) {
  EXPECT_EQ(run({"--check", "--case", file("[structure]\nyoung = 0.0\n")}), 3);
  EXPECT_NE(err_.find("case.toml:2:9: structure.young"), std::string::npos) << err_;
  EXPECT_EQ(run({"--check", "--case", file("[structure]\nyoung = 1.0\nyuong = 1.0\n")}), 3);
  EXPECT_NE(err_.find("did you mean young?"), std::string::npos) << err_;
}

TEST_F(ParticipantMain, AWrongCommandLineExitsWithTwo) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {},
           {"--nonsense"},
           {"--check", "--echo"},
           {"--values"},
           {"--echo", "--values"},
           {"--check", "--table"},
           {"--check"},
           {"--connect", "ipc:///x", "--name", "structure"},
           {"--participant", "Solid", "--check"},
           {"--precice-library", "libprecice.so.3"},
           {"--precice", "a.xml", "--check"},
           {"--precice", "a.xml", "--connect", "ipc:///x"},
           {"--connect", "ipc:///x", "--name", "a", "--case", "b", "--case-hash", "12"}})
    EXPECT_EQ(run(words), 2) << err_;
}

TEST_F(ParticipantMain, TheCommandLineOfARunIsUnderstood) {
  std::vector<std::string> words{"p",
                                 "--connect",
                                 "ipc:///tmp/x/hub",
                                 "--name",
                                 "fluid",
                                 "--case-hash",
                                 std::string(64, 'a'),
                                 "--case",
                                 "a.toml",
                                 "--set",
                                 "a.b=1",
                                 "--set",
                                 "c=[1, 2]"};
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  const ParticipantOptions o = parse_participant_options(static_cast<int>(argv.size()), argv.data());
  EXPECT_EQ(o.mode, ParticipantOptions::Mode::serve);
  EXPECT_EQ(o.endpoint, "ipc:///tmp/x/hub");
  EXPECT_EQ(o.name, "fluid");
  EXPECT_EQ(o.case_file, "a.toml");
  EXPECT_EQ(o.sets, (std::vector<std::string>{"a.b=1", "c=[1, 2]"}));
  EXPECT_EQ(o.case_hash.value()[31], 0xaa);
}

}  // namespace participant_main_test
}  // namespace strake
