#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// A p = b, symmetric positive definite: the pressure equation times −ρ n0 λ / (2d), ρ the water's density.
/// Off-diagonal entries of row k: column[start[k]] … column[stop[k] − 1], sorted; room behind stop[k] is
/// unused. They are numbers of single precision, since a weight's seventh digit says nothing and a product is
/// as fast as its entries are read; the diagonal holds their exact sum, so that a row has no other error. The
/// views are of `own`, or of whoever has the same rows already (then valid as long as those).
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

/// Gives each block of unknowns that touches no P = 0 particle one: only c = ∞ leaves the pressure of such a
/// block open. Its right side is made compatible (mean removed) and its first unknown pinned. Returns the
/// number of blocks.
int close_sealed_blocks(PressureSystem&);

struct PressureSolution {
  Eigen::VectorXd pressure;  // one per unknown [Pa]
  int iterations = 0;
  double residual = 0;  // ‖b − A p‖₂ / ‖b‖₂
};

/// ‖b − A p‖₂ / ‖b‖₂.
double pressure_residual(const PressureSystem&, const Eigen::VectorXd& pressure);

}  // namespace strake::fluid
