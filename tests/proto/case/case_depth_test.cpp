#include "proto/case/case_depth.hpp"

#include "proto/case/case_file.hpp"
#include "proto/error.hpp"
#include "tests/proto/refusal.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace case_depth_test {

std::string repeated(const std::string& text, int n) {
  std::string all;
  for (int k = 0; k < n; ++k) all += text;
  return all;
}

std::string refusal(const std::string& toml, const std::vector<std::string>& sets = {}) {
  return text_of_error([&] { CaseFile::parse(toml, "case.toml", sets); }, ExitCode::case_file);
}

constexpr int many = 50'000;

TEST(CaseDepth, IsBoundedForTheNameOfATable) {
  EXPECT_NE(refusal("title = \"x\"\n[a" + repeated(".a", many) + "]\nx = 1\n")
                .find("case.toml:2: a key or value lies more than 64"),
            std::string::npos);
  refusal("[[a" + repeated(".a", many) + "]]\n");
}

TEST(CaseDepth, IsBoundedForDottedKeysAndValues) {
  EXPECT_NE(refusal("\n\na" + repeated(".a", many) + " = 1\n").find("case.toml:3:"), std::string::npos);
  refusal("a = " + repeated("[", many) + repeated("]", many));
  refusal("a = " + repeated("{a=", many) + "1" + repeated("}", many));
}

TEST(CaseDepth, IsBoundedForAllOfThemTogether) {
  const std::string twenty = "a" + repeated(".a", 19);
  CaseFile::parse("[" + twenty + "]\n" + twenty + " = { " + twenty + " = 1 }\n", "case.toml");
  refusal("[" + twenty + "]\n" + twenty + " = { " + twenty + " = [[[[[[1]]]]]] }\n");
  refusal("x = [{ " + twenty + " = [{ " + twenty + " = [\n{ " + twenty + " = [{ " + twenty +
          " = 1 }] }] }] }]\n");
}

TEST(CaseDepth, IsBoundedForSet) {
  const std::string set = refusal("", {"a" + repeated(".a", many) + "=1"});
  EXPECT_NE(set.find("the key has 50001 parts, expected at most 64"), std::string::npos) << set;
  EXPECT_LT(set.size(), 300u);
  refusal("", {"a=" + repeated("[", many) + repeated("]", many)});
  refusal("", {"a={a" + repeated(".a", many) + "=1}"});
}

TEST(CaseDepth, CountsNoDotsAndBracketsOfTextsAndComments) {
  const std::string dots = repeated(".", 200), brackets = repeated("[{", 200);
  CaseFile::parse("# " + dots + brackets + "\na = \"" + dots + "\\\"" + brackets + "\"\nb = '" + brackets +
                      "'\nc = \"\"\"\n" + brackets + "\n\"\" " + dots + "\"\"\"\nd = '''" + brackets +
                      "'''\n",
                  "case.toml");
  CaseFile::parse("title = \"x\"\n", "case.toml", {"title=" + dots, "title=" + repeated("a.", 100)});
  std::string numbers;
  for (int k = 0; k < 500; ++k) numbers += "1.5, [2.5, 3.5], ";
  CaseFile::parse("a = [\n" + numbers + "\n]\n", "case.toml");
  std::string tables;
  for (int k = 0; k < 500; ++k) tables += "[t" + std::to_string(k) + ".a.b.c]\nx.y = 0.5\n";
  CaseFile::parse(tables, "case.toml");
}

}  // namespace case_depth_test
}  // namespace strake
