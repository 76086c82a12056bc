#pragma once

#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>

namespace strake {

/// The whole text of the error that `act` ends with, which has this code.
inline std::string text_of_error(const std::function<void()>& act, ExitCode code) {
  try {
    act();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code);
    return to_text(error);
  }
  ADD_FAILURE() << "no error";
  return {};
}

/// `act` attempts what no case may contain, and the error says so with these words.
inline void expect_refused(const std::function<void()>& act, const std::string& words) {
  const std::string text = text_of_error(act, ExitCode::case_file);
  EXPECT_NE(text.find(words), std::string::npos) << "expected: " << words << "\n" << text;
}

}  // namespace strake
