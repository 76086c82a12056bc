#pragma once

#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

namespace strake {

/// A stream whose text can be read back.
class TextStream {
 public:
  ~TextStream() { std::fclose(file_); }
  std::FILE* file() { return file_; }
  std::string text() const {
    std::rewind(file_);
    std::string text;
    for (int c = std::fgetc(file_); c != EOF; c = std::fgetc(file_)) text.push_back(static_cast<char>(c));
    return text;
  }

 private:
  std::FILE* file_ = std::tmpfile();
};

inline std::string golden(const std::string& name) {
  std::ifstream file(std::string(STRAKE_SOURCE_DIR) + "/tests/text/" + name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace strake
