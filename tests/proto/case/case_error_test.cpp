// Error texts of the case file against tests/text/case_errors.txt, whole. STRAKE_WRITE_TEXTS=1 writes that
// file anew: read the difference before keeping it.
#include "proto/case/case_file.hpp"
#include "proto/error.hpp"
#include "tests/proto/plate_case.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

namespace strake {
namespace case_error_test {

const std::filesystem::path texts = std::filesystem::path(STRAKE_SOURCE_DIR) / "tests/text/case_errors.txt";

/// One block: a name, the case as it stands, the --set strings, the text that a program prints.
struct Sample {
  std::string name, toml, expected;
  std::vector<std::string> sets;
};

std::vector<Sample> samples() {
  std::vector<Sample> list;
  std::istringstream in(content(texts));
  std::string* part = nullptr;
  std::string ignored;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("==== ")) {
      list.push_back({line.substr(5), "", "", {}});
      part = &list.back().toml;
    } else if (line.starts_with("---- set ") && !list.empty()) {
      list.back().sets.push_back(line.substr(9));
    } else if (line == "----" && !list.empty()) {
      part = &list.back().expected;
    } else {
      *(part ? part : &ignored) += line + "\n";
    }
  }
  return list;
}

std::string text_of(const Sample& sample) {
  try {
    CaseFile file = CaseFile::parse(sample.toml, "case.toml", sample.sets);
    read_plate(file);
    file.refuse_unknown();
  } catch (const Error& error) {
    return to_text(error);
  }
  return "no error\n";
}

TEST(CaseError, ReadsAsTheStoredTextsSay) {
  const std::vector<Sample> list = samples();
  ASSERT_GT(list.size(), 40u);
  std::string written = content(texts);
  written.erase(written.find("==== "));
  for (const Sample& sample : list) {
    const std::string text = text_of(sample);
    EXPECT_EQ(text, sample.expected) << sample.name;
    EXPECT_NE(text, "no error\n") << sample.name;
    written += "==== " + sample.name + "\n" + sample.toml;
    for (const std::string& set : sample.sets) written += "---- set " + set + "\n";
    written += "----\n" + text;
  }
  if (std::getenv("STRAKE_WRITE_TEXTS")) put(texts, written);
}

TEST(CaseError, OfAnotherEncodingSaysSo) {
  try {
    CaseFile::parse("title = \"Spant f\xfcr\"\n", "case.toml");
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(error.fix().find("save the file as UTF-8"), std::string::npos) << to_text(error);
  }
}

TEST(CaseError, OfTheCaseExitsThreeAndOfTheCommandLineTwo) {
  for (const Sample& sample : samples()) {
    try {
      CaseFile file = CaseFile::parse(sample.toml, "case.toml", sample.sets);
      read_plate(file);
      file.refuse_unknown();
    } catch (const Error& error) {
      const bool command_line = error.problem() == "expected KEY=VALUE";
      EXPECT_EQ(error.code(), command_line ? ExitCode::command_line : ExitCode::case_file) << sample.name;
    }
  }
}

}  // namespace case_error_test
}  // namespace strake
