#pragma once

#include <filesystem>

namespace strake {

/// Finds the same program, compiled for wider vectors: lib/strake/x86-64-v3/NAME beside the folder of
/// `program`. Empty if there is none, if this processor lacks those instructions (AVX2, FMA), or if
/// STRAKE_VECTORS is "narrow". The last bits of results differ between the two.
std::filesystem::path wide_program(const std::filesystem::path& program);

}  // namespace strake
