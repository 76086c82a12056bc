#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace strake {

/// What a file seems to be that is no case file, and what to do with it.
struct FileKind {
  std::string name;  // "is a program in Python"
  std::string fix;
};

/// Judges by the first bytes, then by the ending of the name. Nothing where the file may be a damaged case.
std::optional<FileKind> foreign_kind(const std::filesystem::path& file, const std::string& bytes);

}  // namespace strake
