#pragma once

#include "coupler/coupling/window_loop.hpp"
#include "coupler/summary/summary.hpp"
#include "proto/error.hpp"

#include <filesystem>

namespace strake {

/// The error that stopped a run, with the place to go on from, where there is one, and what is lost.
/// checkpoint: the latest, as the user would type it; empty: none. saved: what it holds.
Error with_way_on(const Error&, const std::filesystem::path& checkpoint, const LoopState& saved,
                  const Summary&);

}  // namespace strake
