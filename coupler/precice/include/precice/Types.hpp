#pragma once

namespace precice {

/// The number of a vertex in its mesh, from 0 in the order of setting.
using VertexID = int;

}  // namespace precice
