#pragma once

#include "coupler/plot/scene.hpp"
#include "proto/interface.hpp"

#include <vector>

namespace strake::picture {

/// The section of one cell by the plane z = `at`: corners in order, two for a facet, none without
/// intersection.
std::vector<Place> section(const Points& point, const Eigen::VectorXi& cell, double at);

}  // namespace strake::picture
