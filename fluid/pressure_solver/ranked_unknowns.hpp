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
/// The buckets are the cells of the first grid. Each has one owner. A rank divides its own cells and those of
/// the first ring into pieces. It has the columns of their rows in full; which cells a row touches comes from
/// the owner. So all ranks that have a cell divide it alike.
template <int dim>
struct RankedUnknowns {
  Communicator* communicator = nullptr;
  const Halo* halo = nullptr;  // gives the copies in the first ring the values of their owners
  std::span<const int> owner;  // rank of each
  /// Those in own cells and in the first ring that have a neighbour, ascending.
  std::vector<std::int32_t> in_cells;
  /// Place of each of these in cells. Empty slabs of cells are left out, but for one.
  std::array<std::vector<float>, dim> at;
  std::array<std::int32_t, 3> cells{1, 1, 1};  // per axis
  bool has_grid = true;                        // else the water is too scattered for one, on some rank

  /// Reads the equation of local particles. own: the equation of this rank, where other rows are empty. grid:
  /// the rows of `in_cells`. Both refer to `local`.
  void take(const PressureSystem& local, const Subdomain<dim>&, const Vectors<dim>& position,
            PressureSystem& own, PressureSystem& grid);

 private:
  void find_cells(const Subdomain<dim>&, const Vectors<dim>& position);
};

}  // namespace strake::fluid
