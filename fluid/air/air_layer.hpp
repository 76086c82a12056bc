#pragma once

#include "fluid/air/air_columns.hpp"
#include "fluid/parameters/parameters.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace strake::fluid {

/// The gas (F77), and how it meets the surface below it (F82).
struct AirProperties : AirKeys {
  AirProperties() = default;
  AirProperties(const AirKeys& keys) : AirKeys(keys) {}  // NOLINT(google-explicit-constructor)
  double sound_speed() const;                            // c0 of the open air [m/s]
  double pressure_of(double mass, double gap) const;     // p = p0 (m/(ρ0 h))^γ [Pa]
  /// Energy of a column's air against the open air [J/m²], with its motion, u² = speed_squared (F83).
  double energy_of(double mass, double gap, double speed_squared) const;
  double sound_speed_of(double density) const;  // c = c0 (ρ/ρ0)^((γ−1)/2) [m/s]
  /// Returns the gap h > 0 that air and the surface below it agree on at the end of a step [m] (F82):
  ///   h − h* = C (p(m, h) − p0),
  /// h* = free_gap: where p0 on the surface would leave it; C: how far a pressure moves it in the step
  /// [m/Pa], > 0.
  double gap_of(double mass, double free_gap, double compliance) const;
};

/// What changes in time. mass: m = ρ h [kg/m²], 0 in a column that has none, past which no air flows;
/// momentum: q = m u [kg/(m s)], along the plane; gap: h [m].
template <int plane>
struct AirState {
  Eigen::VectorXd mass;
  Eigen::Matrix<double, plane, Eigen::Dynamic> momentum;
  Eigen::VectorXd gap;
  std::vector<std::uint8_t>
      vents;              // 1: a column without air of its own lies open to the air; empty: none does
  double mass_out = 0;    // what has left over the border [kg], on a line [kg/m]
  double energy_out = 0;  // has left over the border or went into friction [J], on a line [J/m]
};

/// Depth-averaged flow of compressible air in a thin gap (fluid/THEORY.md (F77) to (F81)):
///   ∂m/∂t + ∇·q = 0
///   ∂q/∂t + ∇·(q⊗u + p h I) = p ∇h − (λ/4) ρ |u| u
/// Finite volumes: van Leer's slopes of density and velocity, HLL fluxes through the narrower of two gaps,
/// two-stage steps (Heun). A uniform pressure at rest stays at rest over any gap. Mass is exact. Results do
/// not depend on the number of threads: there is none but the caller's.
template <int plane>
class AirLayer {
 public:
  using Place = typename AirColumns<plane>::Place;
  AirLayer(const AirProperties&, AirColumns<plane>);

  const AirProperties& air() const { return air_; }
  const AirColumns<plane>& columns() const { return columns_; }

  /// The flow that a gap closing with `speed` [m/s] drives if the air is incompressible (F81).
  AirState<plane> start(const Eigen::VectorXd& gap, const Eigen::VectorXd& speed) const;
  /// Longest step of the flow alone [s]: 0.45 Δx/(|u| + c).
  double stable_step(const AirState<plane>&) const;
  /// Advances by dt [s], in which the gaps go evenly to gap_end [m]. Divides dt into stable steps.
  void advance(AirState<plane>&, const Eigen::VectorXd& gap_end, double dt) const;
  /// p of each column [Pa].
  Eigen::VectorXd pressure(const AirState<plane>&) const;
  double mass(const AirState<plane>& state) const {
    return state.mass.dot(columns_.area);
  }  // [kg], on a line [kg/m]
  /// E = Σ A [½ q²/m + e(m, h)] [J], on a line [J/m] (F83).
  double energy(const AirState<plane>&) const;

 private:
  using Field = Eigen::Matrix<double, plane, Eigen::Dynamic>;
  struct Rates {
    Eigen::VectorXd mass;
    Field momentum;
    double out = 0, energy_out = 0;
  };
  struct Flux {
    double mass = 0;
    Place momentum = Place::Zero();
    double energy = 0;  // to the open air
  };
  struct Gas {
    double density = 0;
    Place velocity = Place::Zero();
  };
  /// Fluxes and gaps of the sides, what leaves each column [kg/s], and u.
  struct SideFlows {
    std::vector<Flux> flux;
    std::vector<double> gap;
    Eigen::VectorXd leaving;
    Field velocity;
  };
  SideFlows side_flows(const Eigen::VectorXd& mass, const Field& momentum, const Eigen::VectorXd& gap,
                       const std::vector<std::uint8_t>& vents) const;
  Rates rates(const Eigen::VectorXd& mass, const Field& momentum, const Eigen::VectorXd& gap,
              const std::vector<std::uint8_t>& vents, double dt) const;
  Flux hll(const Gas& left, const Gas& right, const Place& normal) const;
  Gas open_air(const Gas& last, const Place& normal) const;
  double energy_over_open_air(const Gas&) const;  // [J/kg]
  /// outward: 1 where the normal of the side leads to the open air, −1 where it leads from it.
  Flux border_flux(const Gas& last, const Place& normal, double outward) const;
  Field gradient(const Eigen::VectorXd& values, const Eigen::VectorXd& mass) const;
  /// Whether both columns of a side have air.
  static bool joins(const typename AirColumns<plane>::Side& side, const Eigen::VectorXd& mass) {
    return side.other >= 0 && mass[side.column] > 0 && mass[side.other] > 0;
  }
  /// Returns the column from which a side leads to the open air, −1 where it does not.
  static int outlet(const typename AirColumns<plane>::Side& side, const Eigen::VectorXd& mass,
                    const std::vector<std::uint8_t>& vents) {
    const int i = side.column, j = side.other;
    if (j < 0) return mass[i] > 0 ? i : -1;
    if (vents.empty() || (mass[i] > 0) == (mass[j] > 0)) return -1;
    const int with = mass[i] > 0 ? i : j, without = with == i ? j : i;
    return vents[static_cast<std::size_t>(without)] ? with : -1;
  }
  void brake(AirState<plane>&, double dt) const;
  double pressure_at(double density) const;

  AirProperties air_;
  AirColumns<plane> columns_;
  std::vector<Eigen::Matrix<double, plane, plane>> inverse_moments_;  // of the least-squares gradients
  Eigen::VectorXd width_;                                             // Δx of each column [m]
};

}  // namespace strake::fluid
