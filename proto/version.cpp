#include "proto/version.hpp"

#include "proto/commit.hpp"

namespace strake {

std::string strake_version() {
  return STRAKE_VERSION;
}
std::string strake_commit() {
  return STRAKE_COMMIT;
}
std::string build_date() {
  return STRAKE_COMMIT_DATE;
}
std::string library_versions() {
  return STRAKE_LIBRARIES;
}
std::string build_text() {
  const bool known = !build_date().empty();
  return (known ? "commit " + strake_commit() + " of " + build_date()
                : std::string("commit unknown: the sources were no git checkout")) +
         "\nbuilt with " + library_versions();
}

}  // namespace strake
