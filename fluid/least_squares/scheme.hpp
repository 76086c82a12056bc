#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/boundary/wall_wetting.hpp"
#include "fluid/least_squares/compressible_layer.hpp"
#include "fluid/least_squares/constants.hpp"
#include "fluid/least_squares/face_images.hpp"
#include "fluid/least_squares/film.hpp"
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

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// The scheme of `gradient = "least-squares"` (fluid/THEORY.md, section 8), after the LSMPS of Tamai and
/// Koshizuka 2014. Every gradient is exact for linear fields however the particles lie, at walls and at the
/// free surface too. Unknowns are the pressures of the water alone.
///
/// A wall or body is a condition on the pressure's slope over its face, ∂p/∂n = (ρ/Δt) (u* − U)·n (F34). U is
/// the wall's velocity at the end of the step, so the condition includes gravity, the wall's acceleration and
/// an impact. In the sums a layer particle behind the face has the pressure p_i + q (F35).
///
/// The free surface, p = 0, lies half a spacing above the first particles. It enters through the depth D of
/// each particle, Σ w (p_j − p_i) = κ p_i (F39), without a decision which particle is surface. Disorder
/// leaves a remainder of Σ w r; the hydrostatic slope ρ g times it is moved to the right side.
///
/// Still water stays at rest to the tolerance of the solver, whatever the order of its inner particles.
/// Linear momentum is not exact by construction: the gap is measured (momentum_gap).
template <int dim>
class LeastSquaresScheme final : public FluidScheme<dim> {
 public:
  LeastSquaresScheme(const Parameters&, const Boundary<dim>&, const State<dim>&);

  /// Whether c Δt ≤ l0 and the tank is at rest. Walls of a moving tank get their velocity from the positions
  /// that they come from, so each step of theirs is a single one.
  bool may_substep(const StepData<dim>&, double dt) const override;
  typename FluidScheme<dim>::SpareMemory spare_memory() override {
    return {moments_.a_inverse, velocity_.memory};
  }
  void begin(StepData<dim>&) override;
  void set_water(const StepData<dim>&) override;
  void set_layers(const StepData<dim>&) override;
  void measure(StepData<dim>&) override;
  void predict(StepData<dim>&) override;
  void assemble(StepData<dim>&, PressureSystem&) override;
  void limit_pressure(StepData<dim>&, bool tension) override;
  void find_gradient(StepData<dim>&) override;
  Load<dim> load(StepData<dim>&) override;
  double correct(StepData<dim>&) override;
  void shift(StepData<dim>&) override;

  /// Computes the sums over neighbours at the present positions, the wet layers, and State::surface of the
  /// water. far: rows of the Laplacian's radius or more; near: of 2 l0 or more. time: until the next call.
  void measure(const Boundary<dim>&, State<dim>&, const Neighbours& far, const Neighbours& near, double time);
  /// ∇u* of the water (F33), and the filter (F48). Later steps of a group repeat the filter's acceleration of
  /// its first step.
  void filter(const Boundary<dim>&, State<dim>&, const Neighbours& near, double dt,
              const AcousticSubstepping&);
  void filter(const Boundary<dim>& boundary, State<dim>& state, const Neighbours& near, double dt) {
    filter(boundary, state, near, dt, AcousticSubstepping::single_step(dt));
  }
  /// The pressure equation (F40). Notes in the state what water may still approach newly met faces with.
  /// The state has the velocity u** of (F74) from here to `end_projection`, which gives it u* again.
  void assemble(const Boundary<dim>&, State<dim>&, const Neighbours& far, const Neighbours& near,
                const Vector<dim>& gravity, double dt, PressureSystem&);
  void end_projection(const Boundary<dim>&, State<dim>&, const Neighbours& far);
  /// Limits the pressure at the free surface, away from walls, to that of the inner water near by. A harmonic
  /// pressure has no maximum there. A drop or a film in flight gets p = 0.
  void limit_at_surface(const Boundary<dim>&, State<dim>&, const Neighbours& near);
  /// Limits the pressure at sharp corners under water to what the water around hands on (F89).
  void limit_at_corners(const Boundary<dim>&, State<dim>&, const Neighbours& near);
  /// Limits negative pressure (F46), and from then on how much a face pulls (EquationTerms::tension).
  void limit_tension(const Boundary<dim>&, State<dim>&, const Neighbours& far);
  /// ∇p of the water [Pa/m] (F47).
  const Vectors<dim>& pressure_gradient(const Boundary<dim>&, const State<dim>&, const Neighbours& near,
                                        double dt);
  /// Returns −p n A of each first-layer particle (F51), and sets State::pressure of the first layers.
  LayerForces<dim> layer_forces(const Boundary<dim>&, State<dim>&, const Neighbours& near) const;
  /// Moves particles towards even spacing (F49), (F50), and only along the surface where they are near it.
  /// near: rows at the positions that they come from.
  void shift(const Boundary<dim>&, State<dim>&, const Neighbours& near, double dt) const;
  /// Computes State::residual_divergence (F43) and State::residual_wall_velocity of the new velocity, before
  /// the particles move.
  void measure_residual(const Boundary<dim>&, State<dim>&, const Neighbours& far, const Neighbours& near,
                        double dt);
  /// ∇·u of the last `filter` or `measure_residual` [1/s].
  double divergence(std::int64_t i) const { return velocity_gradient(i).trace(); }

 private:
  using SingleVectors = Eigen::Matrix<float, dim, Eigen::Dynamic>;
  // Values that enter as one factor or one term have single precision, as the matrix has.

  /// Sums over the neighbours of each water particle, of the last `measure`.
  struct Moments {
    std::vector<Tensor<dim>> b_inverse;    // B⁻¹, B = Σ_water w r⊗r/r²
    std::vector<Tensor<dim>> a_inverse;    // A⁻¹ (F47)
    std::vector<float> entry;              // −(w_L + w_m) of each pair, where far does not have it
    bool own_entries = false;              // `entry` is the matrix
    std::vector<std::int64_t> water_stop;  // end of the water in each row of far
    SingleVectors m_projected;             // m_P: Σ w_L r over water, P r over wet layers [m]
    SingleVectors concentration;           // Σ w r/r² = ∇C n0/d [1/m]
    Eigen::VectorXf stiffness;             // S of (F66)
    Eigen::VectorXd diagonal;              // Σ (w_L + w_m) over water, the row's sum to the last bit
    Eigen::VectorXf volume;                // Σ W over water and wet layers
  };
  /// The free surface near each water particle (F37)–(F39), of the last `measure`.
  struct FreeSurface {
    SingleVectors normal;          // N, away from the surface
    Eigen::VectorXf kappa;         // κ
    Eigen::VectorXf slope_weight;  // b/D [1/m]
    Eigen::VectorXf share;         // σ
    Eigen::VectorXf deep;  // of `submerged`: 0 to 0.8 l0 from the surface, 1 from 3.1 l0 on; see `find_depth`
    std::vector<std::uint8_t> in_reach;  // scratch of `find_depth`: surface within the far rows
  };
  /// What one particle's equation gets from one face newly met, or from all of them.
  struct Meeting {
    std::int64_t particle;
    double weight, approach, time;  // Σ w |P r|, the same times u_n, least T [s]
  };
  /// Faces of walls and bodies.
  struct WallData {
    bool curved = false;              // a body has curved faces
    Eigen::VectorXd cover;            // of each layer particle: part of its face that water covers, 0 … 1
    Vectors<dim> mean_velocity;       // of the water over each face, less U [m/s]
    SingleVectors force;              // R_i of (F52) per weight of a layer particle [N]
    SingleVectors deferred_velocity;  // past the faces, left to the next steps [m/s]
    std::vector<Meeting> meeting;     // scratch of `meet_faces`
    Eigen::VectorXd passing;          // scratch: T of each layer particle newly wet [s]
    Vectors<dim> to_air, ahead;       // scratch on several ranks: those of each water particle
  };
  using Images = FaceImages<dim>;
  /// The configuration at the start, where it is packed; else empty. Columns are those of State::id.
  struct PackedStart {
    Vectors<dim> place;         // in the tank as the case gives it [m]
    Eigen::VectorXf deviation;  // δ of (F40)
    SingleVectors opening;      // m of (F37) under the level, else 0 [m]
  };
  enum class Limit : std::uint8_t { none, at_surface, tension };
  /// Terms of each water particle in (F40), of the last `assemble`.
  struct EquationTerms {
    Eigen::VectorXf carried;            // ε_i of (F44)
    double kept = 0;                    // π η_0 of (F94)
    Eigen::VectorXf incompressible;     // 1 − s/(c²Δt² A_ii)
    Eigen::VectorXf own;                // factor of p_i beside ∇²p and κ: s/(c²Δt²) + Y_i
    Eigen::VectorXd source;             // right side without walls, ∇·u* and g
    Eigen::VectorXd pressure_at_start;  // of the group of sub-steps [Pa]
    std::vector<Limit> limited;         // which limit has changed the pressure
    Eigen::VectorXf tension;            // share to which a face may pull it; 1 without `limit_tension`
  };
  /// Numbers of the present step.
  struct StepNumbers {
    double projection = 0;                               // Δt_p (F74) [s]
    double deferred = 0;                                 // 1 − π (F45)
    double largest_speed = 0;                            // max|u| past the tank [m/s]
    Vector<dim> gravity = Vector<dim>::Zero();           // less the tank's acceleration [m/s²]
    Vector<dim> gravity_velocity = Vector<dim>::Zero();  // Δt times it [m/s]
    double fading = 0;                                   // Δt by which a lag (F71) fades [s]
  };
  /// What the filter reads of a neighbour, side by side in memory.
  struct Motion {
    VecD<dim> place, velocity, gradient[dim];  // columns of ∇u [1/s]
  };
  struct VelocityFit {
    SharedMemory memory;        // of `motion`
    std::span<Motion> motion;   // of the last `filter`, before it, or of `measure_residual`
    Vectors<dim> filtered;      // acceleration by the filter at the start of the group [m/s²]
    double age = 0;             // of the configuration [s]
    std::vector<Motion> start;  // u* and ∇u* while the state has u**; else empty
  };
  /// Sums over one particle's neighbours, before they are stored.
  struct ParticleSums {
    double diagonal, volume, stiffness;  // Σ w_L, Σ W, Σ (2 r_e/r − 1)/r²
    Tensor<dim> b, a = Tensor<dim>::Zero();
    Vector<dim> m, concentration;  // Σ w_L r, Σ w r/r²
    Vector<dim> m_projected;       // with P r of the layers
    double weights, filled;        // Σ w_L and 1 + Σ W with the layers
    double bodies = 0;             // tr a of bodies' faces
    bool beside_wall = false;      // over a wet face
  };
  template <bool seams, bool shares>
  void sum_water(const Boundary<dim>&, const State<dim>&, const Neighbours& far, std::int64_t i,
                 ParticleSums&);
  void add_layers(const Boundary<dim>&, const State<dim>&, const Neighbours& far, const Neighbours& near,
                  std::int64_t i, ParticleSums&) const;
  void leave_out_past_faces(const Boundary<dim>&, const State<dim>&, const Neighbours& far, std::int64_t i,
                            ParticleSums&) const;
  void find_images(const Boundary<dim>&, const State<dim>&, const Neighbours& far);
  void find_image_faces(const Boundary<dim>&, const State<dim>&, const Neighbours& far, std::int64_t i);
  void pair_images(const Boundary<dim>&, const State<dim>&, const Neighbours& far);
  template <class Visit>
  void for_each_mirrored(const Boundary<dim>&, const State<dim>&, const Neighbours& far, std::int64_t i,
                         const Visit&) const;
  void add_images(const Neighbours& far, std::int64_t i);
  void find_image_velocities(const Boundary<dim>&, const State<dim>&, const Vector<dim>& steady, double dt);
  void share_image_faces(const Boundary<dim>&);
  void update_image_velocities();
  double image_factor() const;
  /// Returns τ of (F72), the share of the free surface in particle i beside a face with the normal n.
  float open_share(std::int64_t i, const typename Images::Face& face, const Vector<dim>& n) const {
    const float behind = surface_.normal.col(i).dot(n.template cast<float>());
    return surface_.share[i] * (1 - face.end * std::max(0.0F, behind));
  }
  /// Calls visit(e, w_m, r, n, slope) for each pair of row i that is mirrored in a face. e: its number in the
  /// row; r: to the neighbour; n: the normal; slope: mean of both particles' normal_velocity [m/s].
  template <class Visit>
  void for_each_image(std::int64_t i, const Visit&) const;
  double surface_share(double m) const;
  void resize(std::int64_t water);
  bool is_full(const Boundary<dim>&, const State<dim>&, std::int64_t water) const;
  /// Whether particle i starts deeper than two rows in packed water.
  bool starts_under_level(const State<dim>&, std::int64_t i) const;
  double fit_surface(std::int64_t i, const ParticleSums&);
  template <bool seams, bool shares>
  void fit(const Boundary<dim>&, State<dim>&, const Neighbours& far, const Neighbours& near, std::int64_t i);
  /// Notes `start_` at the present configuration, of the last `measure`.
  void note_start(const Boundary<dim>&, const State<dim>&, const Neighbours& far);
  bool starts_packed() const { return start_.deviation.size() > 0; }
  /// Returns the part of `start_` that still counts: 1 at the particle's place at the start, 0 a spacing from
  /// it (F68).
  double start_share(const Boundary<dim>&, const State<dim>&, std::int64_t i) const;
  void find_depth(const Boundary<dim>&, const Neighbours& far);
  void list_films(const Boundary<dim>&, const State<dim>&, const Neighbours& far);
  void share_surface(State<dim>&) const;
  void limit_film(State<dim>&, const Neighbours& near);
  void share_films(const Boundary<dim>&, const Neighbours& near);
  void stop_films(const Boundary<dim>&, State<dim>&, const Neighbours& near);
  double film_impulse(const Boundary<dim>&, const State<dim>&, const Neighbours& near, std::int64_t i) const;
  void cover_layers(const Boundary<dim>&, const State<dim>&, const Neighbours& near);
  /// Whether the rows of far are those of the matrix; else Moments::entry has them.
  bool shares_entries(const Neighbours& far) const {
    return far.data() == PairData::entries && far.scale() == 1 / laplacian_.radius;
  }
  /// Smallest determinant of an inverse of Σ w r⊗r/r² that can be inverted again.
  double least_determinant() const {
    return least_squares_constants().singular * std::pow(dim / gradient_.n0, dim);
  }
  // Velocity.
  void fit_velocity(const Boundary<dim>&, const State<dim>&, const Neighbours& near);
  template <bool seams>
  void find_velocity_gradient(const Boundary<dim>&, const State<dim>&, const Neighbours& near);
  template <bool seams>
  void find_filter(const Boundary<dim>&, State<dim>&, const Neighbours& near, double dt,
                   const AcousticSubstepping&);
  void advance_gradient(Motion&, double time) const;
  Tensor<dim> velocity_gradient(std::int64_t i) const {
    Tensor<dim> gradient;
    for (int b = 0; b < dim; ++b)
      for (int a = 0; a < dim; ++a)
        gradient(a, b) = velocity_.motion[static_cast<std::size_t>(i)].gradient[b][a];
    return gradient;
  }

  // Walls and bodies.
  /// Returns how far inside the end of a layer particle's face particle i lies [l0]; infinity without an end.
  double inside_end(const Boundary<dim>&, const State<dim>&, std::int64_t i,
                    std::int64_t layer_particle) const;
  /// Whether particle i lies over the face of a layer particle: not past the face's end.
  bool is_over(const Boundary<dim>&, const State<dim>&, std::int64_t i, std::int64_t layer_particle) const;
  /// Returns the share with which that face counts for it (F92): 0 past its end, less than 1 beside a chine.
  double share_of(const Boundary<dim>&, const State<dim>&, std::int64_t i, std::int64_t layer_particle) const;
  /// w |P r| of particle i and layer particle j [m], of that pair of far.
  double face_weight(const Boundary<dim>& boundary, const State<dim>& state, const Neighbours& far,
                     std::int64_t i, std::int64_t j, std::int64_t pair) const {
    const Vector<dim> r = boundary.tank().periodic().separation(state.position.col(i), state.position.col(j));
    return (laplacian_.radius * far.inverse_of(pair) - 1) * walls_.projection(j, r).norm();
  }
  void fade_lag(State<dim>&, std::int64_t i) const;
  void fade_lags(const Boundary<dim>&, State<dim>&) const;
  Vector<dim> to_air(const Boundary<dim>&, const State<dim>&, const Neighbours&, std::int64_t i) const;
  Vector<dim> ahead(const Boundary<dim>&, const State<dim>&, const Neighbours&, std::int64_t i) const;
  void share_to_air(const Boundary<dim>&, const State<dim>&, const Neighbours& far);
  double passing_time(const Boundary<dim>&, const State<dim>&, const Neighbours& far,
                      const typename WallContact<dim>::Joined&) const;
  void meet_faces(const Boundary<dim>&, State<dim>&, const Neighbours& far);
  void set_lag(const Boundary<dim>&, State<dim>&, const Neighbours& far, const Meeting&);
  /// Returns the velocity along the normal of layer particle j that it lacks for particle i [m/s] (F71).
  Vector<dim> lag(const Boundary<dim>& boundary, const State<dim>& state, std::int64_t i,
                  std::int64_t j) const {
    if (j < boundary.first_of_bodies() || boundary.volume()) return Vector<dim>::Zero();
    return state.face_lag[i] * walls_.normal(j);
  }
  void average_wall_velocity(const Boundary<dim>&, const State<dim>&, const Neighbours& far);
  /// Returns the part of particle i's own velocity at j's face (F87). from_layer: j to i; height over it [m].
  double own_part(const Boundary<dim>&, std::int64_t i, std::int64_t j, const Vector<dim>& from_layer,
                  double height) const;
  /// Returns u* − U at the face of layer particle j for particle i [m/s]. Past a face's end it is the mean
  /// over the particles over the face. Within 0.5 l0 of the end the two are blended.
  Vector<dim> relative_wall_velocity(const Boundary<dim>&, const State<dim>&, std::int64_t i,
                                     std::int64_t j) const;
  /// Returns −U = (p_i − p_still)/(ρc) n of an absorbing wall [m/s] (F60). A wave that goes out meets the
  /// impedance ρc of the water. With a SoundLayer it is multiplied by the compressible part at the particle.
  Vector<dim> absorbing_velocity(const Boundary<dim>&, const State<dim>&, std::int64_t i,
                                 std::int64_t j) const;
  /// Returns u − U of particle i past the faces that it lies over [m/s].
  Vector<dim> residual_wall_velocity(const Boundary<dim>&, const State<dim>&, const Neighbours& near,
                                     std::int64_t i) const;
  /// Returns the velocity past faces that the step does not correct [m/s]: at walls what E_i is.
  Vector<dim> carried_wall_velocity(const State<dim>&, std::int64_t i, const Vector<dim>& relative) const;
  /// Returns q_ij of (F35) less the carried residual [Pa]. Without tension no face has a pressure below zero.
  double wall_pressure_increment(const Boundary<dim>&, const State<dim>&, std::int64_t i, std::int64_t j,
                                 const Vector<dim>& projected, double slope) const;
  /// χ (F36).
  double slope_share(double dt) const;
  /// Sums over the wet layer particles whose faces a particle lies over.
  struct FaceSums {
    Vector<dim> q_moment = Vector<dim>::Zero();  // Σ w q P r/r²
    Tensor<dim> a = Tensor<dim>::Zero();         // Σ w P r ⊗ P r/r²
    double weights = 0;                          // Σ w of the first layer
  };
  /// R_i of (F52) per weight of a layer particle [N].
  Vector<dim> wall_force(std::int64_t i, const FaceSums&) const;
  /// Whose faces are among the walls of a particle: none of a body, those of plates and boxes, which end at
  /// corners of at most a right angle and have images (F72), or others.
  enum class Beside : std::uint8_t { no_body, plate, other_face };
  /// Walls in the equation of particle i.
  struct WallTerms {
    double flux = 0,
           absorption = 0;                        // Σ w (u*−U)·P r [m²/s]; absorbing walls' part of Y_i
    Vector<dim> projected = Vector<dim>::Zero();  // Σ w P r [m]
    Vector<dim> images = Vector<dim>::Zero();     // Σ w_m r of images, r along the face [m]
    Beside beside = Beside::no_body;
  };
  WallTerms wall_terms(const Boundary<dim>&, const State<dim>&, const Neighbours& far, std::int64_t i) const;

  // Pressure.
  /// δ of particle i (F40).
  double volume_deviation(std::int64_t i) const { return moments_.volume[i] / lattice_.volume - 1; }
  double counted_deviation(const Boundary<dim>&, const State<dim>&, std::int64_t i) const;
  void begin_projection(const Boundary<dim>&, State<dim>&, const Neighbours& far, const Neighbours& near,
                        double dt);
  void note_acceleration(const Boundary<dim>&, State<dim>&) const;
  void begin_equation(const Boundary<dim>&, const State<dim>&, const Vector<dim>& gravity);
  void share_rows(const Neighbours& far, PressureSystem&) const;
  template <bool seams>
  void find_pressure_gradient(const Boundary<dim>&, const State<dim>&, const Neighbours& near, double dt);
  /// Returns the depth of x under the water's upper edge at the start [m].
  double depth_of(const Boundary<dim>&, const Vector<dim>& x) const;
  /// ρ g times that depth [Pa].
  double still_pressure(const Boundary<dim>&, const Vector<dim>& x) const;
  /// Returns the part of 1/(ρc²) that the water has at x.
  double compressible(const Boundary<dim>& boundary, const Vector<dim>& x) const {
    return sound_.is_whole() ? 1.0 : sound_.compressible(depth_of(boundary, x));
  }
  /// Returns max|u| past the tank [m/s]. An observer who moves with the tank finds the same value.
  double fastest(const Boundary<dim>&, const State<dim>&) const;
  double wave_speed_squared() const;
  double drift_share(double dt) const;
  /// ε of (F44) but for the particle's own factors.
  struct CarriedFraction {
    double elsewhere = 0, beside_plate = 0, at_edge = 0;
    double of(Beside beside) const {
      if (beside == Beside::other_face) return 0;
      return beside == Beside::plate ? beside_plate : elsewhere;
    }
  };
  CarriedFraction carried_fraction(double dt) const;
  double corrected_fraction(const State<dim>&) const;

  Parameters p_;
  LatticeConstants gradient_, laplacian_;
  SurfaceLattice<dim> lattice_;
  WallContact<dim> walls_;
  SoundLayer sound_;
  bool oblique_;  // a body has faces other than those of plates and boxes
  bool full_;     // a closed tank without a gap or a body: no free surface, whatever the disorder
  Moments moments_;
  Images images_;
  FreeSurface surface_;
  WallData wall_;
  Films<dim> film_;
  EquationTerms equation_;
  StepNumbers now_;
  VelocityFit velocity_;
  PackedStart start_;
  static inline const SurfaceAir no_air;
  const SurfaceAir* air_ = &no_air;  // that of the step
  RankExchange<dim> ranks_;
  Vectors<dim> pressure_gradient_;  // of the last call [Pa/m]
};

}  // namespace strake::fluid
