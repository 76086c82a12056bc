#pragma once

#include "coupler/plot/scene.hpp"
#include "coupler/report/recorded.hpp"

#include <string>
#include <vector>

namespace strake::report {

/// Draws tank, water at rest, structure, supports, entry speed and probes as inline SVG, from the settings.
/// The structure's outline is that of the first frame (`start`: nullptr if no frame can be read).
std::string sketch(const Recorded&, const picture::Scene* start);

/// "[[-1, 0, 0], [1, 0.5, 0]]" → the first two numbers of each point.
std::vector<picture::Place> places(const std::string& list);

/// The closed curves around a set of cells that share corners. They are chains of the edges that belong to
/// one cell only, without corners on straight lines. Particles count as squares of their spacing.
std::vector<std::vector<picture::Place>> outline(const picture::Scene&);

}  // namespace strake::report
