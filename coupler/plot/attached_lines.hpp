#pragma once

#include "proto/interface.hpp"

#include <map>
#include <string>
#include <vector>

namespace strake::picture {

/// Springs and mooring lines of a body at one instant: places along each, 3×n [m], the anchor first. keys: of
/// case.toml, by full names. body: of several, its name.
std::vector<Points> attached_lines(const std::map<std::string, std::string>& keys, const Frame& structure,
                                   const std::string& body);

}  // namespace strake::picture
