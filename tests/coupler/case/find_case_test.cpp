// The case that a user names, and what a slip is answered with.

#include "coupler/case/find_case.hpp"

#include "proto/error.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace find_case_test {

namespace fs = std::filesystem;

class FindCase : public testing::Test {
 protected:
  FindCase() {
    put(folder_ / "still.toml", "");
    put(folder_ / "wedge.toml", "");
    for (const char* below : {"run", "floor", "empty"}) fs::create_directory(folder_ / below);
    put(folder_ / "run/case.toml", "");
    put(folder_ / "run/run.json", "");
    put(folder_ / "floor/floor.toml", "");
  }
  std::string refused(const std::string& name) const {
    try {
      return "found " + find_case(folder_ / name).string();
    } catch (const Error& error) {
      const std::string text = to_text(error), own = folder_.path().string();
      std::string kept;  // without the folder
      for (std::size_t at = 0; at < text.size();)
        if (text.compare(at, own.size(), own) == 0)
          at += own.size();
        else
          kept += text[at++];
      return kept;
    }
  }
  TemporaryFolder folder_;
};

TEST_F(FindCase, TakesAFileAsItIs) {
  EXPECT_EQ(find_case(folder_ / "still.toml"), folder_ / "still.toml");
  EXPECT_EQ(find_case(folder_ / "other.toml"), folder_ / "other.toml")
      << "who reads it says that it is not there";
}

TEST_F(FindCase, NamesTheFileThatASlipMeant) {
  EXPECT_EQ(refused("stil.toml"), "/stil.toml: no such file\n  fix: did you mean /still.toml?\n");
}

TEST_F(FindCase, SaysOfAFolderWhereItsCaseIs) {
  const std::string is_folder = ": is a folder, not a file\n  fix: ";
  EXPECT_EQ(refused("run"),
            "/run" + is_folder +
                "it is the folder of a run; its case once more: /run/case.toml; what came out: "
                "strake report /run\n");
  EXPECT_EQ(refused("floor"), "/floor" + is_folder + "its case is /floor/floor.toml\n");
  EXPECT_EQ(refused("floor/"), "/floor/" + is_folder + "its case is /floor/floor.toml\n");
  EXPECT_EQ(refused(""),
            "/" + is_folder + "name a case file of it: floor/floor.toml, still.toml, wedge.toml\n");
  EXPECT_EQ(refused("empty"), "/empty" + is_folder + "name a case file, with its path\n");
}

}  // namespace find_case_test
}  // namespace strake
