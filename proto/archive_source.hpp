#pragma once

#include "proto/interface.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace strake {

/// The values of an archive by name, made when they are written, one after the other. So a state is not
/// copied as a whole. What they are made of must outlive it.
struct ArchiveSource {
  std::map<std::string, std::function<Eigen::MatrixXd()>> real;
  std::map<std::string, std::function<std::vector<std::int64_t>()>> integer;
};

}  // namespace strake
