#pragma once

#include "structure/failure/failure_record.hpp"
#include "structure/particle/bonds.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace strake::structure {

/// Failure of particles (structure/THEORY.md (S32)–(S37)): bonds that break for good, and particles that
/// soften before.
///   bond_strain    a bond breaks when s = (|r| − |r⁰|)/|r⁰| exceeds s_c
///   max_principal, von_mises
///                  a particle softens from where that stress first reaches the strength (softening.hpp), Y
///                  with the energy of its hourglass form. The remaining share 1 − D is kept in
///                  Bonds::integrity; a bond of a particle that has lost all of it breaks when it is
///                  stretched by more than ½√(2/E') y_f: all that cross the opening do by then (E' = E/(1 −
///                  ν²) in plane strain). Bonds that neighbours have broken leave a particle a smaller F: so
///                  a bond breaks at the latest when it is longer by the opening at which a whole row would
///                  be through.
/// l_c: see crack_band.
template <int dim>
class Failure {
 public:
  struct State {
    std::vector<std::uint8_t> broken;  // m, both directions of a bond; empty: no failure
    Eigen::VectorXd onset, peak;       // n y_0 (0: not yet) and the largest y [√Pa]; empty with bond_strain
    std::int64_t bonds = 0;            // broken so far, each once
    double released = 0;               // [J] ([J/m]) strain energy that went with them
    FailureRecord record;
  };

  /// Refers to the lattice, and changes the bonds.
  Failure(const FailureKeys&, double hourglass, const Lattice<dim>&, Bonds<dim>&);
  State intact() const;
  /// True if a displacement adds damage. The damage is then in the state, and not yet in the bonds.
  bool look(const Vectors<dim>& displacement, double time, State&) const;
  /// Gives the bonds the damage of a state.
  void apply(const State&);
  /// D_i = 1 − (1 − D of softening) Σ_alive w⁰/Σ w⁰ of each particle.
  Eigen::RowVectorXd damage(const State&) const;
  /// What is asked for, and what it can and cannot represent.
  std::vector<std::string> lines(bool surface_coupling) const;

 private:
  double last(double onset) const;
  double softening(Eigen::Index i, const State&) const;
  double undamaged_energy(Eigen::Index i, const Eigen::Matrix<double, dim, dim>& H,
                          const Vectors<dim>& displacement) const;
  bool soften(const Vectors<dim>& displacement, State&) const;
  bool snap(const Vectors<dim>& displacement, State&) const;
  void note(double time, State&) const;
  double critical_strain(Eigen::Index i, Eigen::Index bond, const State&) const;

  FailureKeys keys_;
  double hourglass_;
  double band_, opening_;  // [m] l_c, and the opening at which a layer has lost all strength, per y_f/√E'
  const Lattice<dim>& lattice_;
  Bonds<dim>& bonds_;
  Eigen::VectorXd weight_;              // m, of the intact bonds
  std::vector<Eigen::Index> partner_;   // m, the bond from the other side
  std::vector<double> crack_constant_;  // of the parts
};

/// Computes C of s_c = √(G_c/(C μ l0)). C is the energy that separates two halves of the pair model's square
/// lattice along an axis, until every bond between them has broken. Lengths in spacings, opening Δ:
///   U(Δ)/(μ l0) = (4/n0) Σ_alive Δx w⁰ Δ²/|r⁰|² + (λ/μ) Σ_rows tr²,   tr_q = (2Δ/n0) Σ_alive,Δx>q w⁰
///   Δx/|r⁰|²
/// and a bond breaks at Δ = s_c |r⁰|²/Δx. With |u_ij| = s |r⁰| throughout, the first sum would neglect the
/// shear of bonds across the opening (1.33 in place of 1.92 at r_e = 2.1).
double crack_constant(double radius /* [spacing] */, double lambda_over_mu);

/// Width of the band in which a crack dissipates energy [spacing]. An opening δ between two layers gives the
/// particles of layer q beside it the strain h_q δ/l0 and the hourglass residuals of the bonds that cross, in
/// spacings
///   h_q = Σ_{Δx>q} w⁰ Δx/a,   Y_q/E = ½ h_q² + α/(4a) (Σ_{Δx>q} w⁰ − a h_q²),   a = Σ w⁰ Δx²
/// With η_q = √(Y_q/Y_0), layer 0 softens completely and dissipates y_0 y_f. Layer q then has y = η_q y_f; it
/// dissipated η_q y_0 y_f in softening and stores (1 − D) Y_q = η_q (1 − η_q) y_0 y_f. The stored part is
/// lost when the bonds across the opening break (y_f ≫ y_0). The band is therefore 2 Σ_q η_q (2 − η_q): 2.48
/// at r_e = 2.1, α = 1.
struct CrackBand {
  double width;    // [spacing]
  double opening;  // [spacing] of δ at which layer 0 has lost all strength, in units of y_f/√E'
};
CrackBand crack_band(int dimension, double radius /* [spacing] */, double hourglass);

}  // namespace strake::structure
