#pragma once

#include <precice/export.h>

#include <stdexcept>
#include <string>

namespace precice {

/// A call that cannot be carried out. The text names the function, the reason and a remedy.
class PRECICE_API Error : public std::runtime_error {
 public:
  explicit Error(const std::string& text) : std::runtime_error(text) {}
};

}  // namespace precice
