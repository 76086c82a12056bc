#include "proto/case/case_depth.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace strake {
namespace {

/// Reads a text character by character and counts its nesting. Brackets in strings and comments do not count.
class DepthMeter {
 public:
  explicit DepthMeter(const std::string& text) : text_(text) {}

  /// The line where the text nests too deep; 0: nowhere.
  std::size_t line_too_deep() {
    for (; at_ < text_.size(); ++at_) {
      take(text_[at_]);
      if (header_ + around_ + here_ > deepest_key) return line_;
    }
    return 0;
  }

 private:
  void take(char c) {
    const bool blank = c == ' ' || c == '\t' || c == '\r';
    const bool first = std::exchange(line_is_blank_, line_is_blank_ && blank) && !blank;
    if (c == '"' || c == '\'') skip_text(c);
    if (c == '#') at_ = std::min(text_.find('\n', at_), text_.size()) - 1;
    if (c == '\n') end_line();
    if (c == '[' && first && outer_.empty()) {
      in_header_ = true;
      header_ = here_ = 0;
    } else if ((c == '[' || c == '{') && !in_header_) {
      outer_.push_back(here_);
      around_ += here_ + 1;
      here_ = 0;
    }
    if ((c == ']' || c == '}') && !in_header_ && !outer_.empty()) {
      here_ = outer_.back();
      outer_.pop_back();
      around_ -= here_ + 1;
    }
    if (c == '.') ++here_;
    if (c == ',' && !outer_.empty()) here_ = 0;
  }

  void end_line() {
    ++line_;
    line_is_blank_ = true;
    if (std::exchange(in_header_, false)) header_ = here_ + 1;
    if (outer_.empty()) here_ = 0;
  }

  /// Skips a text from the quote at `at_` to its closing quote. Without one it skips to the end of the line.
  void skip_text(char quote) {
    const bool lines = text_.compare(at_, 3, std::string(3, quote)) == 0;
    const std::string end = lines ? std::string(3, quote) : std::string(1, quote);
    for (at_ += end.size(); at_ < text_.size() && text_.compare(at_, end.size(), end) != 0; ++at_) {
      if (text_[at_] == '\n' && !lines) {
        --at_;
        return;
      }
      if (text_[at_] == '\n') ++line_;
      if (text_[at_] == '\\' && quote == '"') ++at_;
    }
    at_ += end.size() - 1;
  }

  const std::string& text_;
  std::size_t at_ = 0, line_ = 1;
  std::size_t header_ = 0;          // levels of the [table] that the line stands in
  std::size_t around_ = 0;          // levels of the open brackets, and of the keys before them
  std::size_t here_ = 0;            // dots of the key under way
  std::vector<std::size_t> outer_;  // the same, of the keys before the open brackets
  bool in_header_ = false, line_is_blank_ = true;
};

}  // namespace

void require_shallow(const std::string& toml, const std::string& name) {
  const std::size_t line = DepthMeter(toml).line_too_deep();
  if (line == 0) return;
  throw Error(ExitCode::case_file, fmt::format("{}:{}", name, line),
              fmt::format("a key or value lies more than {} levels deep", deepest_key),
              "strake explain lists the keys; none lies deeper than five");
}

}  // namespace strake
