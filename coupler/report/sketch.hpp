#pragma once

#include "coupler/plot/scene.hpp"
#include "coupler/report/recorded.hpp"

#include <string>

namespace strake::report {

/// Tank, water at rest, structure, supports, entry speed and probes as inline SVG; from the settings, and the
/// structure's outline from the first frame (`start`: nullptr where no frame can be read).
std::string sketch(const Recorded&, const picture::Scene* start);

/// "[[-1, 0, 0], [1, 0.5, 0]]" → the first two numbers of each point.
std::vector<picture::Place> places(const std::string& list);

}  // namespace strake::report
