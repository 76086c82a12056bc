#pragma once

#include <string>
#include <vector>

namespace strake {

struct CaseView;
struct SideView;

/// Whether the user starts this side (--attach): it is named, or it is a body and "structure" is.
bool starts_by_hand(const std::vector<std::string>& by_hand, const SideView&);

/// Error(command_line) for a name that the case has not, or that has no solver.
void check_by_hand(const std::vector<std::string>& by_hand, const CaseView&);

}  // namespace strake
