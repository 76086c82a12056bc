#include "proto/files/history.hpp"

#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

namespace strake {
namespace history_test {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
const std::vector<Column> columns{{"time", "s"}, {"force.y", "N"}, {"CFL", "1"}};

TEST(History, WritesNamesWithUnitsThenOneLinePerRow) {
  const TemporaryFolder folder;
  History history(folder / "history.csv", columns);
  EXPECT_EQ(content(folder / "history.csv"), "time [s],force.y [N],CFL [1]\n");
  history.append({0.1, nothing, 1e-300});
  EXPECT_EQ(content(folder / "history.csv"),
            "time [s],force.y [N],CFL [1]\n0.1,,1e-300\n");  // at once: flushed
}

TEST(History, ReadsBackTheSameDoubles) {
  const TemporaryFolder folder;
  const std::vector<double> hard{0.1 + 0.2,
                                 1.0 / 3,
                                 -5e-324,
                                 1.7976931348623157e308,
                                 -0.0,
                                 nothing,
                                 std::numeric_limits<double>::infinity()};
  {
    History history(folder / "a.csv", {{"x", "m/s^2"}, {"y z", "1"}});
    for (const double x : hard) history.append({x, -x});
  }
  const Table table = read_table(folder / "a.csv");
  ASSERT_EQ(table.rows(), hard.size());
  EXPECT_EQ(table.columns[0].unit, "m/s^2");
  EXPECT_EQ(table.columns[1].name, "y z");
  for (std::size_t i = 0; i < hard.size(); ++i) {
    if (std::isnan(hard[i]))
      EXPECT_TRUE(std::isnan(table.column("x")[i]));
    else
      EXPECT_EQ(table.column("x")[i], hard[i]);
    EXPECT_EQ(std::signbit(table.column("x")[i]),
              std::signbit(std::isnan(hard[i]) ? table.value[0][i] : hard[i]));
  }
}

TEST(History, ContinuesAfterARowAsIfNothingHadCome) {
  const TemporaryFolder folder;
  {
    History history(folder / "whole.csv", columns);
    for (int i = 0; i < 6; ++i) history.append({i * 0.1, 1.0 / i, nothing});
  }
  {
    History history(folder / "cut.csv", columns);
    for (int i = 0; i < 5; ++i) history.append({i * 0.1, i < 3 ? 1.0 / i : -1, nothing});
  }
  put(folder / "cut.csv", content(folder / "cut.csv") + "0.5,0.3");  // killed in the middle of a line
  {
    const auto history = std::make_unique<History>(folder / "cut.csv", columns, 3);
    for (int i = 3; i < 6; ++i) history->append({i * 0.1, 1.0 / i, nothing});
  }
  EXPECT_EQ(content(folder / "cut.csv"), content(folder / "whole.csv"));
}

TEST(History, RefusesToContinueAFileOfOtherColumnsOrTooFewRows) {
  const TemporaryFolder folder;
  History(folder / "a.csv", columns).append({0, 0, 0});
  EXPECT_NE(text_of_error(
                [&] {
                  History(folder / "a.csv", {{"time", "s"}}, 1);
                },
                ExitCode::case_file)
                .find("its columns are not those of this run"),
            std::string::npos);
  EXPECT_NE(text_of_error([&] { History(folder / "a.csv", columns, 2); }, ExitCode::case_file)
                .find("holds 1 rows, the checkpoint was taken after 2"),
            std::string::npos);
  EXPECT_NE(
      text_of_error([&] { History(folder / "b.csv", columns, 0); }, ExitCode::case_file).find("no such file"),
      std::string::npos);
}

TEST(History, SaysWhyItCannotWrite) {
  const TemporaryFolder folder;
  EXPECT_NE(text_of_error([&] { History(folder / "no/a.csv", columns); }, ExitCode::cannot_write)
                .find("a.csv: cannot be written: No such file or directory"),
            std::string::npos);
  EXPECT_NE(text_of_error([&] { History("/dev/full", columns); }, ExitCode::cannot_write)
                .find("/dev/full: cannot be written: No space left on device"),
            std::string::npos);
}

TEST(History, RefusesANameThatWouldBreakItsHeader) {
  const TemporaryFolder folder;
  text_of_error([&] { History(folder / "a.csv", {{"a,b", "1"}}); }, ExitCode::solver_fault);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.csv"));
}

TEST(ReadTable, LeavesOutALastLineWithoutItsNewline) {
  const TemporaryFolder folder;
  put(folder / "a.csv", "time [s],x [m]\n1,2\n3,4");
  EXPECT_EQ(read_table(folder / "a.csv").rows(), 1u);
}

TEST(ReadTable, OfAUserTakesALastLineWithoutItsNewline) {
  const TemporaryFolder folder;
  put(folder / "a.csv", "time [s],x [m]\n1,2\n3,4");
  const Table table = read_given_table(folder / "a.csv");
  ASSERT_EQ(table.rows(), 2u);
  EXPECT_EQ(table.column("x")[1], 4);
  put(folder / "a.csv", "time [s],x [m]\n1,2\n");
  EXPECT_EQ(read_given_table(folder / "a.csv").rows(), 1u);
}

TEST(ReadTable, TakesNotesBlanksAndCarriageReturns) {
  const TemporaryFolder folder;
  put(folder / "a.csv",
      "# origin: own theory\r\n# licence: CC0\r\n time [s] , x [m] \r\n 1e-3 ,\r\n\r\n+2, 4 \r\n");
  const Table table = read_table(folder / "a.csv");
  ASSERT_EQ(table.rows(), 2u);
  EXPECT_EQ(table.columns[1].name, "x");
  EXPECT_EQ(table.column("time")[0], 1e-3);
  EXPECT_TRUE(std::isnan(table.column("x")[0]));
  EXPECT_EQ(table.column("x")[1], 4);
}

// A spreadsheet's "CSV UTF-8" begins with three bytes that no editor shows.
TEST(ReadTable, TakesAByteOrderMark) {
  const TemporaryFolder folder;
  put(folder / "a.csv", "\xef\xbb\xbftime [s],x [m]\n0,1\n");
  const Table table = read_table(folder / "a.csv");
  ASSERT_EQ(table.rows(), 1u);
  EXPECT_EQ(table.column("time")[0], 0);
}

TEST(ReadTable, NamesFileAndLineOfWhatIsWrong) {
  const TemporaryFolder folder;
  const auto text = [&](const std::string& bytes) {
    put(folder / "a.csv", bytes);
    return text_of_error([&] { read_table(folder / "a.csv"); }, ExitCode::case_file);
  };
  EXPECT_NE(text("time [s],x [m]\n1,2\n3,nan\n").find("a.csv:3: \"nan\" is no number"), std::string::npos);
  EXPECT_NE(text("time [s],x [m]\n1,2 m\n").find("a.csv:2: \"2 m\" is no number"), std::string::npos);
  EXPECT_NE(text("time [s],x [m]\n1,2\n3\n").find("a.csv:3: 1 values in a table of 2 columns"),
            std::string::npos);
  EXPECT_NE(text("time,x\n1,2\n").find("a.csv:1: \"time\" names no column"), std::string::npos);
  EXPECT_NE(text("time [s];x [m]\n1;2,5\n").find("a.csv:1: columns are separated by ';'"), std::string::npos);
  EXPECT_NE(text("t;x\n1;2\n").find("a.csv:1: columns are separated by ';'"), std::string::npos);
  EXPECT_NE(text("time [s]\tx [m]\n1\t2\n").find("a.csv:1: columns are separated by tabs"),
            std::string::npos);
  EXPECT_NE(text(std::string("\xff\xfet\0i\0", 6)).find("UTF-16"), std::string::npos);
  EXPECT_NE(text("").find("holds no columns"), std::string::npos);
  EXPECT_NE(text_of_error([&] { read_table(folder.path()); }, ExitCode::case_file).find("cannot be read"),
            std::string::npos);
}

TEST(Table, NamesItsColumnsWhenAskedForAnother) {
  const TemporaryFolder folder;
  put(folder / "a.csv", "time [s],force.y [N]\n");
  const Table table = read_table(folder / "a.csv");
  EXPECT_EQ(table.rows(), 0u);
  EXPECT_NE(text_of_error([&] { table.column("forcey"); }, ExitCode::case_file).find("did you mean force.y?"),
            std::string::npos);
  EXPECT_NE(text_of_error([&] { table.column("depth"); }, ExitCode::case_file)
                .find("its columns are time, force.y"),
            std::string::npos);
}

}  // namespace history_test
}  // namespace strake
