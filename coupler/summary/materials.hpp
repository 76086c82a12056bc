#pragma once

#include "coupler/case/case_view.hpp"

#include <string>
#include <vector>

namespace strake {

/// Adds one line for each material of an elastic body that no known material comes near: another unit, or one
/// key of two. Looked at are the body's own material and those of its boxes and parts. And one line for a
/// plate that is thicker than long.
void look_at_materials(const CaseView&, std::vector<std::string>& lines);

}  // namespace strake
