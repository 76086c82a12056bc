#pragma once

namespace strake {

/// Peak memory of this process [bytes].
double peak_memory();

}  // namespace strake
