#pragma once

#include "fluid/particles/state.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace strake::fluid {

/// Faces in which a water particle and its neighbours are mirrored (F72), of the last `measure`.
template <int dim>
struct FaceImages {
  struct Face {
    std::int32_t layer;      // particle of the first layer behind the face
    float end;               // e of (F72), how near the face's free end is: 0 … 1
    double height, part;     // of the particle over the face [m]; part of the face's end, 0 … 1
    double normal_velocity;  // slope of the pressure over ρ/Δt at that height [m/s]
  };
  struct Pair {
    std::uint32_t entry;       // number of the neighbour in the row
    std::int32_t other;        // the neighbour
    std::uint8_t own, theirs;  // face of the particle, and of the neighbour
    double w;                  // w_m of (F72)
    Vector<dim> r, n;          // to the neighbour [m]; the face's normal
  };
  std::vector<std::array<Face, dim>> faces;  // of each water particle
  std::vector<std::uint8_t> count;           // how many of them
  std::vector<std::uint8_t> at_edge;      // whether it is in the last column before a face's free end (F84)
  std::vector<std::int64_t> particles;    // those that have a face, ascending
  std::vector<std::int64_t> first, last;  // of the pairs of each of those, by water particle: [first, last)
  std::vector<Pair> pairs;
  bool any = false;
  double factor = 1;  // f
};

}  // namespace strake::fluid
