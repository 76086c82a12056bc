#pragma once

#include <filesystem>
#include <string>

namespace strake {

/// A line in a participant's log that says where a resumed run goes on. What stands above it is of the run
/// before.
void note_resume(const std::filesystem::path& log, long window);

/// The last lines of a log, each on a line of its own behind its file's name; of the run since the last
/// resume alone, and without what is only information, which explains no end.
std::string log_tail(const std::filesystem::path& log);

}  // namespace strake
