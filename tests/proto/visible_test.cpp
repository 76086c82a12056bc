#include "proto/visible.hpp"

#include "proto/error.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace visible_test {

TEST(Visible, LeavesTextsOfAnyLanguageAlone) {
  for (const char* text : {"", "plate, 10 mm", "Δt = 1 µs → 2 µs", "水面冲击 🚢", "a\nb\tc"})
    EXPECT_EQ(visible(text), text);
}

TEST(Visible, ShowsControlCharactersAsText) {
  EXPECT_EQ(visible("a\x1b[31mb\x07\r\x7f"), R"(a\x1b[31mb\x07\x0d\x7f)");
  EXPECT_EQ(visible(std::string_view("a\0b", 3)), R"(a\x00b)");
  EXPECT_EQ(visible("\xc2\x9b"
                    "31m"),
            R"(\x9b31m)");  // U+009B begins a sequence as well
  EXPECT_EQ(visible("a\nb\tc", ""), R"(a\x0ab\x09c)");
}

TEST(Visible, ShowsBytesThatAreNoUtf8AsText) {
  EXPECT_EQ(visible("a\xff"
                    "b"),
            R"(a\xffb)");
  EXPECT_EQ(visible("\x9b"
                    "31m"),
            R"(\x9b31m)");
  EXPECT_EQ(visible("\xc3"), R"(\xc3)");                  // cut short
  EXPECT_EQ(visible("\xc0\x9b"), R"(\xc0\x9b)");          // longer than needed
  EXPECT_EQ(visible("\xed\xa0\x80"), R"(\xed\xa0\x80)");  // half of a pair
  EXPECT_EQ(visible("\xf4\x90\x80\x80"), R"(\xf4\x90\x80\x80)");
}

TEST(Visible, IsHowAnErrorIsPrinted) {
  const Error error(ExitCode::solver_fault, "fluid\x1b[2J", "lost\nat\x07", "look\x1b");
  EXPECT_EQ(to_text(error), "fluid\\x1b[2J: lost\n  at\\x07\n  fix: look\\x1b\n");
  EXPECT_STREQ(error.what(), to_text(error).c_str());
}

}  // namespace visible_test
}  // namespace strake
