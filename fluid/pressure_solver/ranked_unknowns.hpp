#pragma once

#include "fluid/particles/state.hpp"
#include "fluid/pressure_solver/pressure_system.hpp"
#include "fluid/ranks/halo.hpp"
#include "fluid/ranks/subdomain.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace strake::fluid {

/// The unknowns of one rank's part of the pressure equation: first the own ones, then the copies in the first
/// ring of buckets, then those in the second. The own ones have rows; the rows of the first copies are
/// complete as well, since all that they reach is here. The rows of all others are empty. A particle without
/// a neighbour of water is no unknown.
///
/// The buckets are the cells of the first grid. Each has one owner, and all ranks that have a cell and those
/// around it divide it into the same pieces.
template <int dim>
struct RankedUnknowns {
  Communicator* communicator = nullptr;
  std::int64_t own = 0, near = 0, all = 0;  // the first `own`, the first `near`, and all
  std::vector<std::int32_t> particle;       // local number of each
  std::vector<int> owner;                   // rank of each
  Halo halo;                                // gives the copies of the first ring the values of their owners
  /// Place of each, in cells. Empty slabs of cells are left out, but for one.
  std::array<std::vector<float>, dim> at;
  std::array<std::int32_t, 3> cells{1, 1, 1};  // per axis
  bool has_grid = true;                        // else the water is too scattered for one, on some rank

  /// Reads the rows of local particles and writes those of the unknowns to `system`; its entries stay the
  /// values of `local`.
  void take(const PressureSystem& local, const Subdomain<dim>&, const Vectors<dim>& position,
            PressureSystem& system);

 private:
  void number(const PressureSystem& local, const Subdomain<dim>&);
  void list_halo(const Subdomain<dim>&);
  void find_cells(const Subdomain<dim>&, const Vectors<dim>& position);
  std::vector<std::int32_t> unknown_of_;  // of each local water particle; −1: none
};

}  // namespace strake::fluid
