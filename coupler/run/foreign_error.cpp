#include "coupler/run/foreign_error.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace strake {

Error error_of(const std::exception& error, const std::string& where) {
  if (const auto* refused = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return {ExitCode::cannot_write, refused->path1().string(), refused->code().message(),
            "check the path, and what this user may do there"};
  return {ExitCode::our_bug, where, fmt::format("{}\nthis is a bug in Strake", error.what())};
}

}  // namespace strake
