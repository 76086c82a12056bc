// Threads of ranks, and whether this machine has processors for them.

#include "coupler/case/rank_threads.hpp"

#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>

namespace strake {
namespace rank_threads_test {

TEST(RankThreads, AreTheProcessorsOverTheRanksUnlessTheCaseGivesThem) {
  CommonKeys common;
  EXPECT_EQ(threads_of_rank(common, 2, 16), 8);
  EXPECT_EQ(threads_of_rank(common, 3, 8), 2);
  EXPECT_EQ(threads_of_rank(common, 4, 2), 1) << "never none";
  common.threads_given = true;
  common.threads = 5;
  EXPECT_EQ(threads_of_rank(common, 4, 2), 5);
}

TEST(RankThreads, AreGivenByTheCaseOrByASetting) {
  const std::string text = "end_time = 1\n[fluid]\nspacing = 0.1\n";
  const auto given = [&](const std::string& more, const std::vector<std::string>& sets) {
    CaseFile file = CaseFile::parse(text + more, "case.toml", sets);
    return read_common(file).threads_given;
  };
  EXPECT_FALSE(given("", {}));
  EXPECT_TRUE(given("[run]\nthreads = 2\n", {}));
  EXPECT_TRUE(given("", {"run.threads=1"}));
}

/// Water on four ranks that mpirun starts, each with three threads.
CaseView four_ranks() {
  CaseView view;
  view.fluid = SideView{.side = "fluid", .solver = "mps", .program = {}, .lines = {}, .echo = {}};
  view.common.threads = 3;
  view.common.threads_given = true;
  view.value = {{"fluid.ranks", "4"}, {"fluid.launcher", "mpirun -n {ranks}"}};
  return view;
}

TEST(RankThreads, ThatTakeTurnsAreNamedWithTheFix) {
  CaseView view = four_ranks();
  EXPECT_TRUE(crowd_lines(view, 12).empty());
  ASSERT_EQ(crowd_lines(view, 11).size(), 1u);
  EXPECT_EQ(crowd_lines(view, 11).front(),
            "fluid: 4 ranks of 3 threads take turns on 11 processors: --set run.threads=2");
  view.common.threads_given = false;
  EXPECT_TRUE(crowd_lines(view, 4).empty());
  ASSERT_EQ(crowd_lines(view, 2).size(), 1u);
  EXPECT_EQ(crowd_lines(view, 2).front(),
            "fluid: 4 ranks of 1 thread take turns on 2 processors: --set fluid.ranks=2");
  view.value["fluid.ranks"] = "1";
  view.common.threads_given = true;
  EXPECT_TRUE(crowd_lines(view, 2).empty()) << "threads of one process are as before";
}

TEST(RankThreads, OfABodyAreNamedByItsTable) {
  CaseView view = four_ranks();
  view.fluid.reset();
  view.common.threads_given = false;
  view.structures.push_back(
      SideView{.side = "left", .solver = "fem", .program = {}, .lines = {}, .echo = {}, .is_body = true});
  view.value = {{"structures.left.ranks", "4"}, {"structures.left.launcher", "mpirun -n {ranks}"}};
  ASSERT_EQ(crowd_lines(view, 2).size(), 1u);
  EXPECT_EQ(crowd_lines(view, 2).front(),
            "left: 4 ranks of 1 thread take turns on 2 processors: --set structures.left.ranks=2");
}

// What other machines have, this one does not know.
TEST(RankThreads, OfOtherMachinesAreNotJudged) {
  for (const char* launcher :
       {"srun -n {ranks}", "mpirun --hostfile nodes -n {ranks}", "mpirun -H a,b -n {ranks}", "./start.sh"}) {
    CaseView view = four_ranks();
    view.value["fluid.launcher"] = launcher;
    EXPECT_TRUE(crowd_lines(view, 2).empty()) << launcher;
  }
}

// The processors of the machine that runs the test, divided by four.
TEST(RankThreads, ThatDivideAreRecordedAsEachRankTakesThem) {
  CaseView view = four_ranks();
  view.common.threads_given = false;
  view.common.threads = 64;
  const int share = std::max(1, processors_here() / 4);
  const Json record = record_of(view, *view.fluid);
  EXPECT_EQ(number_of(record, "ranks"), 4);
  EXPECT_EQ(number_of(record, "threads"), share);
  EXPECT_EQ(most_threads_of(view), share) << "water alone";
  view.structures.push_back(
      SideView{.side = "structure", .solver = "fem", .program = {}, .lines = {}, .echo = {}});
  EXPECT_EQ(number_of(record_of(view, view.structures.front()), "threads"), 64) << "one process";
  EXPECT_EQ(number_of(record_of(view, view.structures.front()), "ranks"), std::nullopt);
  EXPECT_EQ(most_threads_of(view), 64);
  view.value["fluid.launcher"] = "srun -n {ranks}";
  EXPECT_EQ(number_of(record_of(view, *view.fluid), "threads"), std::nullopt) << "other machines";
  view.common.threads_given = true;
  EXPECT_EQ(number_of(record_of(view, *view.fluid), "threads"), 64);
}

TEST(RankThreads, ThatDivideAreToldInCaseTomlWhichDividesAgain) {
  const std::string text = "end_time = 1\n\n[run]\nthreads = 3  # default\ncheckpoint = 60  # s, default\n";
  CaseView view = four_ranks();
  view.resolved = text;
  say_shares(view);
  EXPECT_EQ(view.resolved, text) << "the case gives them";
  view.common.threads_given = false;
  say_shares(view);
  EXPECT_EQ(view.resolved,
            fmt::format("end_time = 1\n\n[run]\n# threads is not given: 3 for a solver, {} for each of the 4 "
                        "ranks of fluid\ncheckpoint = 60  # s, default\n",
                        std::max(1, processors_here() / 4)));
  view.resolved = text;
  view.value["fluid.launcher"] = "srun -n {ranks}";
  say_shares(view);
  EXPECT_NE(view.resolved.find("a share of the processors of its machine for each of the 4 ranks"),
            std::string::npos);
  view.resolved = text;
  view.value["fluid.ranks"] = "1";
  say_shares(view);
  EXPECT_EQ(view.resolved, text) << "one process";
}

TEST(RankThreads, OfAStudyAreDividedByTheMostRanks) {
  const TemporaryFolder folder;
  put(folder / "case.toml", "end_time = 1\n[fluid]\nspacing = 0.1\nranks = 2\n[structure]\nranks = 3\n");
  EXPECT_EQ(most_ranks_of(folder / "case.toml", {}), 3);
  EXPECT_EQ(most_ranks_of(folder / "case.toml", {"structure.ranks=1"}), 2);
  put(folder / "bodies.toml", "[[structures]]\nname = \"left\"\nranks = 4\n");
  EXPECT_EQ(most_ranks_of(folder / "bodies.toml", {}), 4);
}

}  // namespace rank_threads_test
}  // namespace strake
