#pragma once

#include <span>
#include <string_view>

namespace strake::watch {

/// A file of the page, as it is built into the program.
struct PageFile {
  std::string_view name, type, bytes;
};
std::span<const PageFile> page_files();

}  // namespace strake::watch
