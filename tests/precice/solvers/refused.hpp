#pragma once

#include <precice/precice.hpp>

#include <cstdio>
#include <functional>
#include <string>

inline int tried = 0, failed = 0;

/// The call must throw precice::Error with this text in it, and with the function's name.
inline void refused(const std::string& function, const std::string& text, const std::function<void()>& call) {
  std::string told = "nothing was refused";
  try {
    call();
  } catch (const precice::Error& error) {
    told = error.what();
  }
  const bool right = told.find(function) != std::string::npos && told.find(text) != std::string::npos;
  std::printf("%s %s: %s\n", right ? "ok  " : "FAIL", function.c_str(), told.c_str());
  ++tried;
  if (!right) ++failed;
}

inline void print_count() {
  std::printf("%d refused, %d not\n", tried - failed, failed);
}
