#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// The system A p = b, symmetric positive definite. It is the pressure equation times −n0 λ / (2d). The
/// off-diagonal entries of row k are column[start[k]] … column[stop[k] − 1], sorted; room behind stop[k] is
/// unused. They have single precision: a weight's seventh digit is without meaning, and a product is as fast
/// as its entries are read. The diagonal is their exact sum, so that a row has no other error. The views are
/// of `own`, or of the rows of another object (then valid as long as those).
struct PressureSystem {
  std::vector<std::int32_t> particle;  // of the unknown
  std::span<const std::int64_t> start, stop;
  std::span<const std::int32_t> column;
  std::span<const float> value;
  Eigen::VectorXd diagonal, right;
  struct {
    std::vector<std::int32_t> unknown_of;  // of the particle, −1: none
    std::vector<std::int64_t> start, stop;
    std::vector<std::int32_t> column;
    std::vector<float> value;
  } own;

  PressureSystem() = default;
  PressureSystem(PressureSystem&&) = default;
  PressureSystem& operator=(PressureSystem&&) = default;
  PressureSystem(const PressureSystem&) = delete;
  PressureSystem& operator=(const PressureSystem&) = delete;
  std::int64_t size() const { return static_cast<std::int64_t>(particle.size()); }
};

/// Makes the equation solvable in each block of unknowns without P = 0 and without compressibility. The
/// pressure of such a block is open by a constant. The mean of its right side is subtracted, and its first
/// unknown is pinned. Returns the number of blocks.
int close_sealed_blocks(PressureSystem&);

struct PressureSolution {
  Eigen::VectorXd pressure;  // one per unknown [Pa]
  int iterations = 0;
  double residual = 0;  // ‖b − A p‖₂ / ‖b‖₂
};

/// Returns ‖b − A p‖₂ / ‖b‖₂.
double pressure_residual(const PressureSystem&, const Eigen::VectorXd& pressure);

}  // namespace strake::fluid
