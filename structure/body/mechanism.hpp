#pragma once

#include "structure/body/parameters.hpp"
#include "structure/body/solid.hpp"

#include <string>
#include <vector>

namespace strake::structure {

/// What every elastic solver says of a body without supports.
inline constexpr const char* nothing_holds =
    "no supports   nothing holds the body: it moves by its inertia and its loads";

/// The rigid motions that the supports of a body leave, in words: "1 motion of the whole body that strains
/// nothing: it turns about (0.2, 0.05) m". Empty where the supports leave none, and for a body without
/// supports, which is known to move as a whole.
std::string motions_left(const Solid&);

/// What an elastic body without supports has to be told: finite elements and particles say themselves that
/// nothing holds it.
std::vector<std::string> notes_on_unheld(const Parameters&);

}  // namespace strake::structure
