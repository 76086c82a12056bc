#pragma once

#include "fluid/particles/state.hpp"
#include "fluid/pressure_solver/pressure_system.hpp"
#include "fluid/ranks/halo.hpp"
#include "fluid/ranks/subdomain.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// The unknowns of one rank's part of the pressure equation: all of its local water. The rank solves for its
/// own ones; the others are copies.
///
/// The buckets are the cells of the first grid. Each has one owner, which divides it into pieces. The ranks
/// that have a copy of it get the pieces from there, with the cells that each touches.
template <int dim>
struct RankedUnknowns {
  Communicator* communicator = nullptr;
  const Halo* halo = nullptr;           // gives the copies in the first ring the values of their owners
  std::span<const int> owner;           // rank of each
  std::span<const std::int64_t> place;  // of each in the order of the whole, ascending
  /// Those in own cells and in the first ring that have a neighbour, ascending.
  std::vector<std::int32_t> in_cells;
  /// Place of each of these in cells. Empty slabs of cells are left out, but for one.
  std::array<std::vector<float>, dim> at;
  std::array<std::int32_t, 3> cells{1, 1, 1};  // per axis
  bool has_grid = true;                        // else the water is too scattered for one, on some rank

  /// Reads the equation of local particles, in which copies have no rows.
  void take(const PressureSystem& local, const Subdomain<dim>&, const Vectors<dim>& position);

 private:
  void find_cells(const Subdomain<dim>&, const Vectors<dim>& position);
};

}  // namespace strake::fluid
