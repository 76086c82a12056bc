#include "proto/text.hpp"

#include "proto/visible.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

namespace strake {
namespace text_test {

TEST(Text, BytesAreTwoDigitsEach) {
  EXPECT_EQ(hexadecimal(std::array<std::uint8_t, 4>{0x00, 0x0a, 0x1f, 0xff}), "000a1fff");
  EXPECT_EQ(hexadecimal({}), "");
}

TEST(Text, WordsAreJoinedByTheSeparator) {
  EXPECT_EQ(joined({"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(joined({"a", "", "c"}, ";"), "a;;c");
  EXPECT_EQ(joined({"a"}), "a");
  EXPECT_EQ(joined({}), "");
}

TEST(Text, ATimeIsWrittenAsAskedFor) {
  std::tm time{};
  time.tm_year = 126;
  time.tm_mon = 10;
  time.tm_mday = 7;
  time.tm_hour = 9;
  time.tm_sec = 5;
  EXPECT_EQ(time_text("%Y-%m-%dT%H:%M:%SZ", time), "2026-11-07T09:00:05Z");
}

TEST(Text, ThousandsStandApart) {
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(-1234567), "-1 234 567");
}

}  // namespace text_test
}  // namespace strake
