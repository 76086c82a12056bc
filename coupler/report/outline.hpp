#pragma once

#include "coupler/plot/scene.hpp"

#include <vector>

namespace strake::report {

/// The closed curves around a set of cells that share corners. They are chains of the edges that belong to
/// one cell only, without corners on straight lines. Particles count as squares of their spacing.
std::vector<std::vector<picture::Place>> outline(const picture::Scene&);

}  // namespace strake::report
