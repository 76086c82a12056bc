#include "tests/text/golden.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <regex>

namespace strake {

std::string without_chance(std::string text, const std::string& folder) {
  if (!folder.empty())
    for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder, at))
      text.replace(at, folder.size(), "FOLDER");
  text = std::regex_replace(text, std::regex("process [0-9]+"), "process PID");
  text = std::regex_replace(text, std::regex("\\[20[0-9]{2}-[0-9-]+ [0-9:.]+\\]"), "[TIME]");
  text = std::regex_replace(text, std::regex("the machine [^ \n]+"), "the machine HOST");
  return std::regex_replace(text, std::regex("(for|after) [0-9.e+-]+ s"), "$1 N s");
}

void expect_stored(const std::string& file, const std::string& name, const std::string& text) {
  const std::string path = std::string(STRAKE_SOURCE_DIR) + "/tests/text/" + file;
  std::map<std::string, std::string> block;
  std::string head, *part = &head;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("==== "))
      part = &block[line.substr(5)];
    else
      *part += line + "\n";
  }
  const bool ends = text.ends_with('\n');
  const std::string whole = ends ? text : text + "\n";
  if (std::getenv("STRAKE_WRITE_TEXTS")) {
    block[name] = whole;
    std::ofstream out(path);
    out << head;
    for (const auto& [title, stored] : block) out << "==== " << title << "\n" << stored;
    return;
  }
  EXPECT_EQ(block.contains(name) ? block[name] : "no such text", whole)
      << "tests/text/" << file << ", " << name;
}

std::string this_test() {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  return std::string(info->test_suite_name()) + "." + info->name();
}

bool matches(const std::string& text, const std::string& expression) {
  return std::regex_match(text, std::regex(expression));
}

Found find_expression(const std::string& text, const std::string& expression) {
  std::smatch found;
  if (!std::regex_search(text, found, std::regex(expression))) return {};
  return {found[1], static_cast<std::size_t>(found.length())};
}

}  // namespace strake
