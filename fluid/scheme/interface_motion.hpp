#pragma once

#include "proto/interface.hpp"

namespace strake::fluid {

/// The motion of the interface points over one step. displacement: from the reference mesh. The Neumann
/// condition uses the acceleration.
struct InterfaceMotion {
  Points displacement;  // 3×m [m] at the end of the step
  Points velocity;      // 3×m [m/s] at the end of the step
  Points acceleration;  // 3×m [m/s²] over the step
};

}  // namespace strake::fluid
