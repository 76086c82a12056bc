#include "coupler/study/plan.hpp"
#include "coupler/study/results.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace strake::study {
namespace study_test {

class StudyFile : public testing::Test {
 protected:
  Plan read(const std::string& text) {
    std::ofstream(folder_.path() / "case.toml") << "title = \"c\"\n";
    std::ofstream(folder_.path() / "s.toml") << "title = \"t\"\ncase = \"case.toml\"\n" << text;
    return read_plan(folder_.path() / "s.toml");
  }
  std::string problem(const std::string& text) {
    return text_of_error([&] { read(text); }, ExitCode::case_file);
  }
  const std::string axes_ =
      "[[axis]]\nname = \"speed\"\nvalue = [{ label = \"1\", at = 1, set = [\"v=1\"] }, { label = \"2\", at "
      "= 2, set = "
      "[\"v=2\"] }]\n"
      "[[axis]]\nname = \"solver\"\nvalue = [{ label = \"fem\", set = [\"s=fem\"] }, { label = \"ccx\", set "
      "= [\"s=ccx\"], "
      "replay = \"fem\" }]\n";

 private:
  TemporaryFolder folder_;
};

TEST_F(StudyFile, IsTheProductOfItsAxesWithTheKeysOfEach) {
  const Plan plan = read("set = [\"a=0\"]\n" + axes_);
  ASSERT_EQ(plan.runs.size(), 4u);
  EXPECT_EQ(plan.runs[1].name, "1-ccx");
  EXPECT_EQ(plan.runs[1].sets, (std::vector<std::string>{"a=0", "v=1", "s=ccx"}));
  EXPECT_EQ(plan.runs[1].source, "1-fem");
  EXPECT_EQ(plan.runs[3].source, "2-fem");
  EXPECT_TRUE(plan.runs[2].source.empty());
}

TEST_F(StudyFile, LeavesOutWhatAllConditionsOfAnExcludeHoldFor) {
  const Plan plan = read(axes_ + "[[exclude]]\nwhere = [\"speed!=2\", \"solver=ccx\"]\n");
  ASSERT_EQ(plan.runs.size(), 3u);
  for (const PlannedRun& run : plan.runs) EXPECT_NE(run.name, "1-ccx");
}

TEST_F(StudyFile, IsRefusedWithItsPlaceWhenANameIsUnknown) {
  EXPECT_NE(problem(axes_ + "[[exclude]]\nwhere = [\"speeed=2\"]\n").find("name of an axis: speed, solver"),
            std::string::npos);
  EXPECT_NE(problem(axes_ + "[[exclude]]\nwhere = [\"speed=3\"]\n").find("a label of axis speed: 1, 2"),
            std::string::npos);
  EXPECT_NE(
      problem(
          axes_ +
          "[[check]]\naxis = \"solver\"\nof = \"fam\"\nagainst = \"fem\"\nmetric = \"wall\"\ntolerance = 1\n")
          .find("a label of axis solver"),
      std::string::npos);
  EXPECT_NE(problem(axes_ + "colum = 1\n").find("colum"), std::string::npos);
  EXPECT_NE(problem("jobs = 1\n").find("varies nothing"), std::string::npos);
  EXPECT_NE(problem("set = { \"fluid.spacing\" = 0.02, end_time = 0.01 }\n" + axes_)
                .find("set = [\"end_time=0.01\", \"fluid.spacing=0.02\"]"),
            std::string::npos)
      << problem("set = { \"fluid.spacing\" = 0.02, end_time = 0.01 }\n" + axes_);
  EXPECT_NE(problem("[[axis]]\nname = \"a\"\nvalue = [{ label = \"x/y\" }]\n").find("names a folder"),
            std::string::npos);
  EXPECT_NE(
      problem("[[axis]]\nname = \"a\"\nvalue = [{ label = \"x\", set = [\"fem\"] }]\n").find("KEY=VALUE"),
      std::string::npos);
  EXPECT_NE(problem("[[axis]]\nname = \"a\"\nvalue = [{ label = \"x\", replay = \"y\" }]\n")
                .find("stands before it"),
            std::string::npos);
  EXPECT_NE(problem(axes_ + "[[convergence]]\naxis = \"solver\"\nmetric = \"wall\"\n").find("number above 0"),
            std::string::npos);
  EXPECT_NE(problem(axes_ + "[[claim]]\nclaim = \"c\"\nsource = \"s\"\nrule = \"none\"\n")
                .find("why it cannot be judged"),
            std::string::npos);
}

TEST_F(StudyFile, ACaseIsRefusedAsSuchWithAStudyToBeginWith) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "hull.toml";
  std::ofstream(path) << "title = \"c\"\nend_time = 1\n[fluid]\nspacing = 0.01\n";
  const std::string text = text_of_error([&] { read_plan(path); }, ExitCode::case_file);
  EXPECT_NE(text.find("is a case, not a study"), std::string::npos) << text;
  EXPECT_NE(text.find("case = \"hull.toml\""), std::string::npos) << text;
  EXPECT_NE(text.find("[[axis]]"), std::string::npos) << text;
}

TEST_F(StudyFile, AnUnknownColumnIsAnErrorThatNamesWhatThereIs) {
  EXPECT_NE(problem(axes_ + "[[column]]\nprobe = \"mid.y\"\nmetric = \"first_paek\"\n")
                .find("time_of_first_peak, peak"),
            std::string::npos);
  EXPECT_NE(problem(axes_ + "[[column]]\nmetric = \"momentumgap\"\n").find("momentum_gap"),
            std::string::npos);
  const Plan plan = read(axes_ + "[[column]]\nprobe = \"force.y\"\nmetric = \"peak\"\n" +
                         "[[column]]\nprobe = \"mid.q\"\nmetric = \"peak\"\n");
  Results results = {.plan = &plan, .outcome = {}, .values = {}, .unit = {}};
  EXPECT_NO_THROW(refuse_unknown_probes(results)) << "while no run is done nobody knows";
  results.values["1-fem"] = {{"force.y:final", 1}, {"mid.y:final", 1}, {"wall", 2}};
  EXPECT_NE(text_of_error([&] { refuse_unknown_probes(results); }, ExitCode::case_file)
                .find("did you mean \"mid.y\"?"),
            std::string::npos);
  results.values["2-ccx"] = {{"mid.q:final", 1}};
  EXPECT_NO_THROW(refuse_unknown_probes(results)) << "one run has it";
}

TEST(GridConvergence, FindsTheOrderOfAPowerLawForAnyRatios) {
  for (const double p : {0.7, 1.0, 2.0, 3.3})
    for (const auto& h :
         {std::vector{4.0, 2.0, 1.0}, std::vector{3.0, 2.0, 1.5}, std::vector{8.0, 5.0, 1.0}}) {
      std::vector<double> values;
      for (const double x : h) values.push_back(3 + 0.1 * std::pow(x, p));
      const GridConvergence c = grid_convergence(h, values);
      ASSERT_TRUE(c.order) << p;
      EXPECT_NEAR(*c.order, p, 1e-6);
      EXPECT_NEAR(*c.extrapolated, 3, 1e-8);
      EXPECT_NEAR(*c.gci, 1.25 * (values[2] - 3) / values[2], 1e-8);
    }
}

TEST(GridConvergence, SaysWhenThereIsNoOrder) {
  EXPECT_EQ(grid_convergence({4, 2, 1}, {1, 2, 4}).remark, "does not converge");  // as 1/h
  EXPECT_EQ(grid_convergence({4, 2, 1}, {1, 2, 3}).remark, "does not converge");  // as -log h
  EXPECT_NE(grid_convergence({4, 2, 1}, {1, 2, 1.5}).remark.find("oscillates"), std::string::npos);
  EXPECT_NE(grid_convergence({2, 1}, {1, 2}).remark.find("fewer than three"), std::string::npos);
  EXPECT_NE(grid_convergence({4, 2, 1}, {1, 2, 2}).remark.find("round-off"), std::string::npos);
  EXPECT_FALSE(grid_convergence({4, 2, 1}, {1, 2, 4}).order);
  // Unequal ratios 1.5 and 2: of a result that goes as log h the differences have the ratio ln 2/ln 1.5.
  EXPECT_EQ(grid_convergence({3, 1.5, 1}, {3.5, 2, 1}).remark, "does not converge");
  EXPECT_NE(grid_convergence({3, 1.5, 1}, {1e9, 2, 1}).remark.find("faster than any order"),
            std::string::npos);
  EXPECT_EQ(grid_convergence({4, 2, 1}, {1, -1, 0}).remark, "oscillates about 0");
}

TEST_F(StudyFile, AClaimOfALimitIsJudgedRunByRun) {
  const Plan plan =
      read(axes_ +
           "[[claim]]\nclaim = \"c\"\nsource = \"s\"\nmetric = \"momentum_gap\"\nrule = \"at_most\"\n"
           "tolerance = 0.01\nwhere = [\"solver=ccx\"]\n");
  Results results = {.plan = &plan, .outcome = {}, .values = {}, .unit = {}};
  results.values["1-ccx"]["momentum_gap"] = 1e-3;
  EXPECT_EQ(judge_claims(results).front().verdict, "cannot be judged");  // the other speed is missing
  results.values["2-ccx"]["momentum_gap"] = -9e-3;
  EXPECT_EQ(judge_claims(results).front().verdict, "holds");
  results.values["2-ccx"]["momentum_gap"] = -2e-2;
  EXPECT_EQ(judge_claims(results).front().verdict, "does not hold");
}

TEST_F(StudyFile, ReferencesStandBesideTheRunsOfTheirLabel) {
  const std::string reference =
      "[[reference]]\ntitle = \"r\"\naxis = \"speed\"\nprobe = \"p\"\nmetric = \"peak\"\nkind = "
      "\"experiment\"\n"
      "source = \"somebody\"\ntolerance = 0.1\nfitted = [\"2\"]\nwhere = [\"solver=fem\"]\n";
  const Plan plan = read(axes_ + reference + "value = { \"1\" = 10.0, \"2\" = 20.0 }\n");
  Results results = {.plan = &plan, .outcome = {}, .values = {}, .unit = {{"p", "Pa"}}};
  for (const PlannedRun& run : plan.runs) results.outcome[run.name] = {};
  auto all = judge_checks(results);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].run, "1-fem");
  EXPECT_EQ(all[0].pass, false) << "a run that is missing does not pass";
  results.values["1-fem"]["p:peak"] = 10.9;
  results.values["2-fem"]["p:peak"] = 30.0;
  all = judge_checks(results);
  EXPECT_EQ(all[0].pass, true);
  EXPECT_NEAR(*all[0].deviation, 0.09, 1e-12);
  EXPECT_FALSE(all[1].pass) << "what the settings were fitted to is not judged";
  EXPECT_NE(all[1].source.find("fitted to it"), std::string::npos);
  results.values["1-fem"]["p:peak"] = 8.9;
  EXPECT_EQ(judge_checks(results)[0].pass, false);
  EXPECT_EQ(results.unit_of({"p", "impulse"}), "Pa s");

  EXPECT_NE(problem(axes_ + reference + "value = { \"3\" = 1.0 }\n").find("a label of axis speed: 1, 2"),
            std::string::npos);
  EXPECT_NE(problem(axes_ + reference).find("numbers beside it"), std::string::npos);
}

TEST(StudyResults, FailureOfEachOfSeveralBodiesIsANumberOfTheRun) {
  TemporaryFolder folder;
  std::ofstream(folder.path() / "summary.json")
      << R"({"failure": {"left": {"start": {"time": 1e-3, "x": 0.2}, "crack": null, "energy": 3.5},
             "right": null}})";
  Results results;
  const Values values = read_values(folder.path());
  EXPECT_EQ(values.at("failure.left.start.time"), 1e-3);
  EXPECT_EQ(values.at("failure.left.energy"), 3.5);
  EXPECT_EQ(results.unit_of({"", "failure.left.energy"}), "J");
  EXPECT_EQ(results.unit_of({"", "failure.left.start.time"}), "s");
  EXPECT_EQ(results.unit_of({"", "failure.left.start.x"}), "m");
  EXPECT_EQ(results.unit_of({"", "failure.energy"}), "J");
}

TEST_F(StudyFile, ClaimsFollowTheNumbers) {
  const std::string claim = "claim = \"c\"\nsource = \"s\"\nmetric = \"wall\"\n";
  const Plan plan = read(
      axes_ + "[[claim]]\n" + claim + "rule = \"increases\"\naxis = \"speed\"\n[[claim]]\n" + claim +
      "rule = \"same\"\naxis = \"speed\"\ntolerance = 0.1\n[[claim]]\n" + claim +
      "rule = \"agree\"\naxis = \"solver\"\nof = \"ccx\"\nagainst = \"fem\"\ntolerance = 0.02\n[[claim]]\n" +
      claim + "rule = \"differ\"\naxis = \"solver\"\nof = \"ccx\"\nagainst = \"fem\"\ntolerance = 0.02\n");
  Results results = {.plan = &plan, .outcome = {}, .values = {}, .unit = {}};
  results.values["1-fem"]["wall"] = 1.0;
  results.values["1-ccx"]["wall"] = 1.01;
  results.values["2-fem"]["wall"] = 2.0;
  results.values["2-ccx"]["wall"] = 2.02;
  const auto all = judge_claims(results);
  EXPECT_EQ(all[0].verdict, "holds");
  EXPECT_EQ(all[1].verdict, "does not hold");
  EXPECT_EQ(all[2].verdict, "holds");
  EXPECT_EQ(all[3].verdict, "does not hold");
  EXPECT_NE(all[2].measured.find("+1 %"), std::string::npos) << all[2].measured;
  results.values.erase("2-ccx");
  EXPECT_EQ(judge_claims(results)[2].verdict, "cannot be judged");
  results.values["2-ccx"]["wall"] = 2.2;
  EXPECT_EQ(judge_claims(results)[2].verdict, "does not hold");
  for (auto& [run, values] : results.values) values["wall"] = 0;
  EXPECT_EQ(judge_claims(results)[1].verdict, "holds") << "what is 0 everywhere is the same";
}

}  // namespace study_test
}  // namespace strake::study
