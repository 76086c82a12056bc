#pragma once

#include "fluid/mps/operators.hpp"
#include "fluid/particles/shared_memory.hpp"
#include "fluid/particles/simd.hpp"
#include "fluid/viscosity/turbulence.hpp"
#include "fluid/viscosity/viscous_walls.hpp"

#include <Eigen/Core>

#include <span>
#include <type_traits>
#include <vector>

namespace strake::fluid {

/// Computes ν∇²u + ∇·τ of every particle [m/s²] (fluid/THEORY.md (F2)). The object is kept by the caller, so
/// that no step allocates. At a layer particle the value is the reaction of the water per mass of a water
/// particle; times that mass it is the force on it.
///
/// `joint` is one sum for ν and the model. With the corrected velocity gradient G = ∇u, the stress per
/// density τ_i = (ν + ν_t)_i (G_i + G_iᵀ) − (2/3) k_i I and ν̄ = ν + (ν_t,i + ν_t,j)/2,
///   f_ij = (d/n0) (τ_i + τ_j)·r_ij w/r² + (2d/(n0 λ)) ν̄ (u_j − u_i − ½ (G_i + G_j) r_ij) w ,
///   a_i = Σ_j f_ij .
/// The first part is the stress through the pair. Alone it does not see a velocity that alternates from
/// particle to particle. The second is the compact Laplacian of what G leaves out: zero in a linear or
/// quadratic flow, all of the alternating one.
///
/// f is antisymmetric, so linear momentum is exact. A rigid rotation has no force. This is so at a free
/// surface too, where missing neighbours mean that no stress acts; ∇u·n = 0 of the Laplacian alone would
/// brake it. A pair of water i and layer particle j reads G_i, ν_i, k_i for both, and the velocity that
/// continues the flow behind the face. A smooth face feels only the force along its normal.
///
/// With the least-squares and the corrected pressure gradient water inside sums (τ_j − τ_i)·C_i r_ij instead.
/// A uniform stress then has no force however the particles lie, and momentum is no longer exact.
///
/// `stress_pair` is the form of the paper's time: `viscous_acceleration` for ν and `sps_acceleration` for the
/// model.
template <int dim>
class ViscousStage {
 public:
  /// Computes `acceleration`. k: the energy at the start of the step [m²/s²], advanced by dt with the k
  /// model, else overwritten.
  void compute(const Parameters&, const ViscousFlow<dim>&, double dt, Eigen::VectorXd& k);

  /// Exchanges memory that its owners do not need during `compute`. A second call gives it back.
  void exchange(std::vector<Tensor<dim>>& tensors, SharedMemory& one, SharedMemory& other) {
    correction_.swap(tensors);
    stresses_.swap(one);
    samples_.swap(other);
  }

  /// ν + ν_t of the water, of the last `compute` with `joint` [m²/s].
  std::span<const double> viscosity() const { return viscosity_; }

  Vectors<dim> acceleration;  // [m/s²]

 private:
  /// Data of a neighbour are side by side in memory: place and velocity in a Sample. A Stress has the rows of
  /// τ, then those of G.
  using Sample = std::conditional_t<dim == 2, Four, Eight>;
  static constexpr int width = dim == 2 ? 2 : 4, parts = dim * width / 4;
  struct Stress {
    Double8 part[parts];
    void set(int row, int b, double x) { part[(row * width + b) / 8][(row * width + b) % 8] = x; }
    double tau(int a, int b) const { return part[(a * width + b) / 8][(a * width + b) % 8]; }
    double g(int a, int b) const { return part[((dim + a) * width + b) / 8][((dim + a) * width + b) % 8]; }
  };
  void take_samples(const ViscousFlow<dim>&);
  void gather_gradient(const ViscousFlow<dim>&, Eigen::VectorXd& k);
  static void update_gradients(const ViscousFlow<dim>&, std::span<Tensor<dim>> gradient,
                               std::span<std::int32_t> neighbours);
  void update_gradient(const ViscousFlow<dim>&, Eigen::VectorXd& k);
  /// Of a ghost it computes the same numbers as of its owner: the machine's code is one.
  [[gnu::noinline]] void close(std::int64_t i, const Tensor<dim>& gradient, double energy, double production,
                               const ViscousFlow<dim>&);
  void transport(const ViscousFlow<dim>&, const LatticeConstants&, double dt, Eigen::VectorXd& k);
  void gather_force(bool corrected, const ViscousFlow<dim>&);
  template <bool corrected>
  Vector<dim> force_on_water(std::int64_t i, const ViscousFlow<dim>&) const;
  template <bool corrected>
  Vector<dim> pair_with_layer(std::int64_t i, std::int64_t j, double w, double inverse,
                              const ViscousFlow<dim>&) const;
  Vector<dim> force_on_layer(std::int64_t j, const ViscousFlow<dim>&) const;
  void separate(const Parameters&, const ViscousFlow<dim>&, double dt, Eigen::VectorXd& k);

  SpsModel model_;
  double radius_ = 0, stress_scale_ = 0, laplacian_scale_ = 0;  // r_e [m], d/n0, 2d/(n0 λ) [1/m²]
  Turbulence kind_ = Turbulence::none;
  VelocityBehind<dim> behind_;
  SharedMemory samples_, stresses_;
  std::span<Sample> sample_;  // of the last `compute`, as `stress_`
  std::span<Stress> stress_;
  std::vector<Tensor<dim>> correction_;
  std::vector<std::int32_t> neighbours_;  // of the water; −1: too few or too flat for a gradient
  std::vector<std::uint8_t> seen_;
  std::vector<double> viscosity_;
  bool keeps_production_ = false;
  Eigen::VectorXd production_, eddy_viscosity_,
      scratch_;  // of the k model, ranks: Pr = 2 S:S [1/s²], ν_t [m²/s]
};

}  // namespace strake::fluid
