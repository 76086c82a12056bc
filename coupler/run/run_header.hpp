#pragma once

#include "coupler/console/console.hpp"
#include "coupler/run/session.hpp"

#include <filesystem>
#include <vector>

namespace strake {

/// The head of console and log, before the first window. history: the columns of its file.
RunHeader header_of(const CaseView&, const Session&, const RunPlan&, const std::filesystem::path& folder,
                    const std::vector<Column>& history, bool resumed);

}  // namespace strake
