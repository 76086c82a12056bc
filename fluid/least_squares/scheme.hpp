#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/boundary/wall_wetting.hpp"
#include "fluid/least_squares/compressible_layer.hpp"
#include "fluid/least_squares/surface_model.hpp"
#include "fluid/mps/operators.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/shared_memory.hpp"
#include "fluid/particles/simd.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/scheme/acoustic_substepping.hpp"
#include "fluid/scheme/fluid_scheme.hpp"

#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace strake::fluid {

/// The scheme of `gradient = "least-squares"`: every operator is exact for linear fields however the
/// particles lie, at walls and at the free surface too. Unknowns are the water's pressures alone.
///
///   A wall or body is a condition on the pressure's slope: over its face, (u* − U)·n ρ/Δt = ∂p/∂n, U the
///   wall's
/// velocity at the end of the step, which holds g, the wall's acceleration and an impact alike. In the sums a
/// row behind the face stands for p_i + q, q = (ρ/Δt) (u* − U)·P r, P what the face holds of r.
///   The free surface, p = 0, lies half a row above the first particles. With m = Σ w r over water and wet
///   rows,
/// |m| is zero inside and known on the lattice for the first and the second row; p = |∇p| d at the depth d
/// below the surface makes Σ w (p_j − p_i) = κ p_i, κ = |m|/d: a condition without a decision which particle
/// is surface.
///   What is left of Σ w r by disorder takes the hydrostatic slope ρ g with it, which is moved to the right
///   side.
///
/// Still water stays at rest to the tolerance of the solver on any lattice with free places. Linear momentum
/// is not exact by construction: the gap is measured (momentum_gap).
template <int dim>
class LeastSquaresScheme final : public FluidScheme<dim> {
 public:
  LeastSquaresScheme(const Parameters&, const Boundary<dim>&, const State<dim>&);

  /// Where c Δt ≤ l0 steps follow sound and not the water. Walls of a moving tank take their velocity from
  /// the places that they come from, so there each step stands alone.
  bool may_substep(const StepData<dim>&, double dt) const override;
  typename FluidScheme<dim>::SpareMemory spare_memory() override { return {all_, motions_}; }
  void measure(StepData<dim>&) override;
  void predict(StepData<dim>&) override;
  void assemble(StepData<dim>&, PressureSystem&) override;
  void limit_pressure(StepData<dim>&, bool tension) override;
  void find_gradient(StepData<dim>&) override;
  Load<dim> load(StepData<dim>&) override;
  double correct(StepData<dim>&) override;
  void shift(StepData<dim>&) override;

  /// Sums over the neighbours at the present places; wet rows; State::surface of the water. far: rows of at
  /// least the Laplacian's radius; near: of at least 2 l0.
  void measure(const Boundary<dim>&, State<dim>&, const Neighbours& far, const Neighbours& near);
  /// ∇u* of the water, and the filter: u* += Δt Σ ν_ij (what ∇u* does not explain of u_j − u_i), the sum of
  /// the hold's first step.
  void filter(const Boundary<dim>&, State<dim>&, const Neighbours& near, double dt,
              const AcousticSubstepping&);
  void filter(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& near, double dt) {
    filter(boundary, state, near, dt, AcousticSubstepping::single_step(dt));
  }
  void assemble(const Boundary<dim>&, const State<dim>&, const Neighbours& far, const Vector<dim>& gravity,
                double dt, PressureSystem&);
  /// Harmonic pressure has no maximum at a free surface: next to it, away from walls, it is at most that of
  /// the water inside near by; a drop or a film in flight has none.
  void limit(const Boundary<dim>&, State<dim>&, const Neighbours& near);
  /// Water next to the free surface parts without tension. Deeper it holds what the air above it presses: the
  /// cores of vortices stay closed. More than turning water makes, ρ max|u|², it never bears: where nothing
  /// turns, a pull only parts it. A face pulls no particle more than its own water does.
  void release_tension(const Boundary<dim>&, State<dim>&, const Neighbours& far);
  /// ∇p of the water [Pa/m].
  const Vectors<dim>& pressure_gradient(const Boundary<dim>&, const State<dim>&, const Neighbours& near,
                                        double dt);
  const Vectors<dim>& pressure_gradient() const { return gradient_of_p_; }  // of the last call
  /// −p n A of each first row; also State::pressure of the rows. p is the mean of what the water near by says
  /// of the face, p_i + h ∂p/∂n with its own ∇p, and the reaction to what the rows push it beyond that.
  RowForces<dim> row_forces(const Boundary<dim>&, State<dim>&, const Neighbours& near) const;
  /// Particles move towards even spacing, along the surface where they are near it, and take ∇u* with them.
  /// near: of the places that they come from.
  void shift(const Boundary<dim>&, State<dim>&, const Neighbours& near, double dt) const;

  /// State::residual_divergence and State::residual_approach of the new velocity, before the particles move.
  void measure_residual(const Boundary<dim>&, State<dim>&, const Neighbours& far, const Neighbours& near,
                        double dt);
  /// ∇·u* of the last `filter` [1/s].
  double divergence(std::int64_t i) const { return velocity_gradient(i).trace(); }

 private:
  /// What the filter reads of a neighbour, side by side in memory.
  struct Motion {
    Column<dim> place, velocity, gradient[dim];  // columns of ∇u* [1/s]
  };
  void carry(Motion&, double time) const;
  Tensor<dim> velocity_gradient(std::int64_t i) const {
    Tensor<dim> gradient;
    for (int b = 0; b < dim; ++b)
      for (int a = 0; a < dim; ++a) gradient(a, b) = motion_[static_cast<std::size_t>(i)].gradient[b][a];
    return gradient;
  }
  /// u* over the face of row j as particle i sees it, less U [m/s]. A particle that lies beyond the face's
  /// end does not know that velocity: it takes the mean of those that lie over the face, and goes over to its
  /// own along the half spacing up to the first row's middle: at once would be a blow to the water.
  Vector<dim> approach(const Boundary<dim>&, const State<dim>&, std::int64_t i, std::int64_t j) const;
  /// What an absorbing wall's yielding adds to it, U = −(p_i − p_still)/(ρc) m, m its normals: a wave that
  /// goes out finds the water's own ρc [m/s].
  Vector<dim> yielding(const Boundary<dim>&, const State<dim>&, std::int64_t i, std::int64_t j) const;
  /// Of x under the water's upper edge at the start [m].
  double depth_of(const Boundary<dim>&, const Vector<dim>& x) const;
  /// ρ g times that depth [Pa].
  double still_pressure(const Boundary<dim>&, const Vector<dim>& x) const;
  /// Part of 1/(ρc²) that the water has there.
  double compressible(const Boundary<dim>& boundary, const Vector<dim>& x) const {
    return sound_.is_whole() ? 1.0 : sound_.compressible(depth_of(boundary, x));
  }
  /// What stands behind the face at row j over p_i: (ρ/Δt) (u*−U)·P r, of which the part that the last step
  /// was meant to leave is taken away. Without tension the face's own pressure is not below zero [Pa].
  double rise(const Boundary<dim>&, const State<dim>&, std::int64_t i, std::int64_t j,
              const Vector<dim>& held, double slope) const;
  /// Sums over the wet rows whose faces a particle lies over.
  struct Faces {
    Vector<dim> rises = Vector<dim>::Zero();  // Σ w q P r/r²
    Tensor<dim> held = Tensor<dim>::Zero();   // a = Σ w P r ⊗ P r/r²
    double weights = 0;                       // Σ w of the first rows
  };
  /// Reaction of the faces to what their rows push particle i beyond its own ∇p, per weight of a row [N].
  Vector<dim> reaction(std::int64_t i, const Faces&) const;
  /// (u−U) past the faces that the particle touches [m/s].
  Vector<dim> left_approach(const Boundary<dim>&, const State<dim>&, const Neighbours& near,
                            std::int64_t i) const;
  /// What the rows do to the water of particle i: Σ w (u−U)·P r [m²/s], and the diagonal's part of walls that
  /// absorb.
  struct Inflow {
    double flux = 0, yields = 0;
    Vector<dim> held = Vector<dim>::Zero();  // Σ w P r [m]
  };
  Inflow inflow(const Boundary<dim>&, const State<dim>&, const Neighbours& far, double dt,
                std::int64_t i) const;
  /// γ: part of the density error that a step takes away.
  double drift_share(double dt) const;
  /// max |u| past the tank: the same for an observer who falls or drives along with it [m/s].
  double fastest(const Boundary<dim>&, const State<dim>&) const;
  /// Part of the residual divergence that a step leaves as it is.
  double kept_residual(double dt) const;
  /// Part of what the moves of the last steps have left undone that a step of dt does: all of it unless it is
  /// shorter than they were.
  double part_of_step(const State<dim>&, double dt) const;
  /// Velocity past the faces that the step leaves as it is, where nothing holds it up [m/s].
  Vector<dim> left_past(const State<dim>& state, std::int64_t i, const Vector<dim>& approach) const {
    Vector<dim> left = eased_[i] * state.residual_approach.col(i);
    if (undone_ > 0) left += undone_ * soft_[i] * (approach - pull_);
    return left;
  }
  double wave_speed_squared() const;
  void fit_velocity(const Boundary<dim>&, const State<dim>&, const Neighbours& near);
  /// Whether the rows stand as the matrix's; else `entry_` does.
  bool shares_entries(const Neighbours& far) const {
    return far.data() == PairData::entries && far.scale() == 1 / laplacian_.radius;
  }
  bool over(const Boundary<dim>&, const State<dim>&, std::int64_t i, std::int64_t row) const;
  void approach_from_mean(const Boundary<dim>&, const State<dim>&, const Neighbours& far);
  void cover_rows(const Boundary<dim>&, const State<dim>&, const Neighbours& near);
  template <bool seams, bool shares>
  void fit(const Boundary<dim>&, State<dim>&, const Neighbours& far, const Neighbours& near, std::int64_t i);
  template <bool seams>
  void find_velocity_gradient(const Boundary<dim>&, const State<dim>&, const Neighbours& near);
  template <bool seams>
  void find_filter(const Boundary<dim>&, State<dim>&, const Neighbours& near, double dt,
                   const AcousticSubstepping&);
  template <bool seams>
  void find_pressure_gradient(const Boundary<dim>&, const State<dim>&, const Neighbours& near, double dt);
  /// Of an inverse of Σ w r⊗r/r² that can be inverted again: a millionth of the lattice's.
  double least_determinant() const { return 1e-6 * std::pow(dim / gradient_.n0, dim); }
  /// Share of the half spacing's slope that the face feels in one step: a sound wave goes through only c Δt
  /// of it.
  double slope_share(double dt) const;

  /// Pressure of the atmosphere less that of water's vapour: where water is torn [Pa].
  static constexpr double largest_tension = 0.99e5;

  Parameters p_;
  LatticeConstants gradient_, laplacian_;
  SurfaceLattice<dim> lattice_;
  WallContact<dim> walls_;
  SoundLayer sound_;
  bool full_;  // a closed tank without a gap or a body: no surface anywhere, whatever disorder shows
  using SingleVectors = Eigen::Matrix<float, dim, Eigen::Dynamic>;
  std::vector<Tensor<dim>> water_;        // [Σ_water w r⊗r/r²]⁻¹
  std::vector<Tensor<dim>> all_;          // the same with P r of wet rows and the free surface's part
  std::vector<float> entry_;              // −w_L of each pair, where far has not got it
  std::vector<std::int64_t> water_stop_;  // end of the water in each row of far
  SharedMemory motions_;
  std::span<Motion> motion_;  // of the last `filter`, before it, or of `measure_residual`
  // What enters as one factor or one term is as exact as the matrix, single precision.
  SingleVectors moment_;       // Σ w_L r over water, P r over wet rows [m]
  SingleVectors inward_;       // unit vector away from the free surface
  SingleVectors crowding_;     // Σ w r/r² [1/m]
  SingleVectors reaction_;     // of the faces [N], see `reaction`
  Eigen::VectorXf stiffness_;  // of l0² ∇C against the particle's place
  Eigen::VectorXf eased_;      // part of its residual that the step leaves as it is
  Eigen::VectorXf soft_;       // part of the equation's diagonal that no compressibility makes
  Eigen::VectorXf yielding_;   // of p_i in the equation, but for ∇²p and the surface
  Eigen::VectorXd meant_;      // of the right side, but for ∇·u* and g
  enum class Cut : std::uint8_t { none, limited, released };
  std::vector<Cut> cut_;                    // pressures that `limit` or `release_tension` has cut
  std::vector<std::uint8_t> sees_surface_;  // of `release_tension`: free surface within the far rows
  bool tension_ = true;                     // no `release_tension` in this step
  Eigen::VectorXd diagonal_;                // Σ w_L over water, the row's sum to the last bit
  Eigen::VectorXf volume_;                  // Σ W over water and wet rows, W = (1−q)⁴(1+4q), q = r/r_L
  Eigen::VectorXf surface_factor_;          // κ
  Eigen::VectorXf surface_pull_;            // weight/d of the surface in ∇p
  Eigen::VectorXf surface_share_;           // 0 inside … 1 in the rows next to the free surface
  Eigen::VectorXd cover_;                   // of the rows: part of the face that water covers, 0 … 1
  Eigen::VectorXd pressure_then_;           // of the hold's beginning [Pa]
  Vectors<dim> filtered_;                   // what the filter gave to the water there [m/s²]
  double age_ = 0;                          // of the places [s]
  double undone_ = 0;                       // 1 − part_of_step
  Vector<dim> pull_ = Vector<dim>::Zero();  // velocity that gravity_ gives in the step [m/s]
  double speed_ = 0;                        // `fastest` of the step
  Vector<dim> gravity_ = Vector<dim>::Zero();  // of the step, less the tank's acceleration [m/s²]
  Vectors<dim> gradient_of_p_, mean_approach_;
  SingleVectors undone_approach_;
};

}  // namespace strake::fluid
