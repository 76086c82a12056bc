// What CTest gives each test: threads that wait without work leave the processor to other tests.

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace strake {
namespace environment_test {

TEST(Environment, HasBothVariablesOfATest) {
  const char* const policy = std::getenv("OMP_WAIT_POLICY");
  if (policy == nullptr) GTEST_SKIP() << "not started by ctest";
  EXPECT_EQ(std::string(policy), "passive");
  const char* const threads = std::getenv("OPENBLAS_NUM_THREADS");
  ASSERT_NE(threads, nullptr);
  EXPECT_EQ(std::string(threads), "1");
}

}  // namespace environment_test
}  // namespace strake
