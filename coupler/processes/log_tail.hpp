#pragma once

#include <filesystem>
#include <string>

namespace strake {

/// The line in a participant's log at which a resumed run begins. Lines above it are of the run before.
void note_resume(const std::filesystem::path& log, long window);

/// The last lines of a log since the last resume, each behind the file's name. Lines that are only
/// information are left out, since they explain no end. Where a rank of several has said why it ends, its
/// line is returned, and not those that its launcher prints after it.
std::string log_tail(const std::filesystem::path& log);

/// What to do where a program in Python ended because it lacks a module, ending in "; "; else empty.
std::string missing_module(const std::filesystem::path& log);

/// Whether a rank has said in the log since the last resume why it ends.
bool has_words_of_ranks(const std::filesystem::path& log);

}  // namespace strake
