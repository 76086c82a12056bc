#include "coupler/participant/launch.hpp"

#include <cstdlib>
#include <string>
#include <system_error>
#include <unistd.h>

namespace strake {
namespace {

/// True where every instruction of the level x86-64-v3 can be executed.
bool has_wide_vectors() {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  return __builtin_cpu_supports("x86-64-v3") != 0;
#else
  return false;  // the packages are built with GCC
#endif
}

}  // namespace

std::filesystem::path wide_program(const std::filesystem::path& program) {
  const char* vectors = std::getenv("STRAKE_VECTORS");
  if ((vectors && std::string(vectors) == "narrow") || !has_wide_vectors()) return {};
  const std::filesystem::path wide =
      program.parent_path().parent_path() / "lib/strake/x86-64-v3" / program.filename();
  std::error_code none;
  if (!std::filesystem::is_regular_file(wide, none) || access(wide.c_str(), X_OK) != 0) return {};
  return wide;
}

}  // namespace strake
