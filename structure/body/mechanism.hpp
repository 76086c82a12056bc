#pragma once

#include "structure/body/solid.hpp"

#include <string>

namespace strake::structure {

/// The rigid motions that the supports of a body leave, in words: "1 motion of the whole body that strains
/// nothing: it turns about (0.2, 0.05) m". Empty where the supports leave none, and for a body without
/// supports, which is known to move as a whole.
std::string motions_left(const Solid&);

}  // namespace strake::structure
