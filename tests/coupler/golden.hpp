#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace strake {

/// Texts against a stored file of blocks "==== name" and text. STRAKE_WRITE_TEXTS=1 writes the file anew:
/// read the difference before keeping it.
inline void expect_golden(const std::filesystem::path& file,
                          const std::vector<std::pair<std::string, std::string>>& texts) {
  std::map<std::string, std::string> stored;
  std::string head, *part = &head;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("==== "))
      part = &stored[line.substr(5)];
    else
      *part += line + "\n";
  std::ostringstream written;
  written << head;
  for (const auto& [name, text] : texts) {
    EXPECT_EQ(text, stored[name]) << name;
    written << "==== " << name << "\n" << text;
  }
  EXPECT_EQ(stored.size(), texts.size());
  in.close();
  if (std::getenv("STRAKE_WRITE_TEXTS")) std::ofstream(file) << written.str();
}

/// `text` with every `from` replaced by `to`: what differs from run to run.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); !from.empty() && at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace strake
