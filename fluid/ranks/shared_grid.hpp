#pragma once

#include <cstdint>
#include <span>

namespace strake::fluid {

/// Parts of the rows of a matrix that is spread over ranks. Rows and columns have numbers that hold for all
/// ranks; each rank owns the rows [first, first + own). Parts of one entry, from several ranks, are added.
struct SharedRows {
  std::int64_t first = 0, own = 0;
  std::span<const std::int64_t> number;  // of each local row or column
  std::span<const std::int32_t> start;   // of each local row in column and value, and one more
  std::span<const std::int32_t> column;  // local
  std::span<const float> value;
  std::span<const float> diagonal;  // of each local row
};

/// Solves the equation of the pressure's first grid, which all ranks share. All of them call it together.
class SharedGrid {
 public:
  SharedGrid() = default;
  SharedGrid(const SharedGrid&) = delete;
  SharedGrid& operator=(const SharedGrid&) = delete;
  virtual ~SharedGrid() = default;
  virtual void build(const SharedRows&) = 0;
  /// Computes solution ≈ A⁻¹ right by a symmetric operator; both hold the own rows.
  virtual void solve(std::span<const float> right, std::span<float> solution) = 0;
};

}  // namespace strake::fluid
