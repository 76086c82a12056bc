#pragma once

#include "fluid/pressure_solver/coarse_level.hpp"
#include "fluid/ranks/halo.hpp"
#include "fluid/ranks/shared_grid.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace strake::fluid {

/// Solves the equation of the pressure's first grid by one V-cycle of ever coarser grids, as one rank does.
/// The last of them is left to another SharedGrid, whose equation is many times smaller.
///
/// A vertex of the next grid has an unknown for each connected set of own unknowns around it, so that each
/// rank interpolates from its own unknowns alone. Along the bound of two ranks both have one. The next grid
/// then represents all that one without ranks would, and a little more. Its equation is the Galerkin product,
/// with the rows of each rank on that rank.
class RankedLevels final : public SharedGrid {
 public:
  RankedLevels(Communicator& ranks, std::unique_ptr<SharedGrid> last)
      : ranks_(ranks), last_(std::move(last)) {}
  void build(const SharedRows&) override;
  /// Computes one symmetric V-cycle.
  void solve(std::span<const float> right, std::span<float> solution) override;
  /// Number of grids above the last one, of the last `build`.
  int levels() const { return used_; }

 private:
  struct Level {
    std::int64_t first = 0;            // number of the first own row
    std::vector<GridPlace> place;      // of the own rows
    std::vector<std::int64_t> number;  // of the own rows, then of the other columns
    SparseRows matrix;                 // own rows, local columns
    std::vector<float> diagonal, inverse;
    Halo halo;                 // of the other columns
    SparseRows restriction;    // row: own row of the next level
    SparseRows prolongation;   // its transpose
    std::vector<float> right;  // own rows
    std::vector<float> solution, rest;
    std::int32_t own() const { return static_cast<std::int32_t>(place.size()); }
    void prepare();
    SharedRows rows() const;
  };
  std::vector<std::int64_t> find_first(Level&) const;
  void assemble(const SharedRows&, Level&) const;
  void list_halo(Level&, const std::vector<std::int64_t>& starts) const;
  SparseRows interpolation_of_others(const Level&, Level& next) const;
  bool coarsen(Level&, Level& next) const;
  void descend(std::size_t level, std::span<const float> right, std::span<float> solution);

  Communicator& ranks_;
  std::unique_ptr<SharedGrid> last_;
  std::vector<Level> levels_{1};
  int used_ = 0;
};

}  // namespace strake::fluid
