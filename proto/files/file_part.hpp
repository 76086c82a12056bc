#pragma once

#include <cstdint>
#include <string>

namespace strake {

/// One of several files in which the values of another file lie. A rank writes each.
struct FilePart {
  std::string file;         // relative to the folder of the file that joins them
  std::int64_t length = 0;  // entries of each value
  std::int64_t bytes = 0;   // of the file
};

}  // namespace strake
