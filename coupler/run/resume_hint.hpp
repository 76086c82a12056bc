#pragma once

#include "coupler/coupling/window_loop.hpp"
#include "coupler/summary/summary.hpp"
#include "proto/error.hpp"

#include <filesystem>

namespace strake {

/// Adds to the error that stopped a run the checkpoint to resume from, if there is one, and the loss.
/// checkpoint: the latest, as the user would type it; empty: none. saved: its content.
Error with_resume_hint(const Error&, const std::filesystem::path& checkpoint, const LoopState& saved,
                       const Summary&);

}  // namespace strake
