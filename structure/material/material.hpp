#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include <cmath>

namespace strake::structure {

enum class MaterialModel { linear, saint_venant_kirchhoff, neo_hookean };

struct Material {
  MaterialModel model = MaterialModel::saint_venant_kirchhoff;
  double density = 7800;  // [kg/m^3]
  double young = 2.1e11;  // [Pa]
  double poisson = 0.3;
  bool plane_stress = false;  // two dimensions: σ_zz = 0 instead of ε_zz = 0
  /// λ [Pa] of three dimensions and plane strain; in plane stress 2λμ/(λ + 2μ), which leaves σ_zz = 0.
  double lame_lambda() const {
    const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), mu = lame_mu();
    return plane_stress ? 2 * lambda * mu / (lambda + 2 * mu) : lambda;
  }
  double lame_mu() const { return young / (2 * (1 + poisson)); }
  /// Stiffness of a strip against bending per width and thickness³/12: E/(1 − ν²), in plane stress E [Pa].
  double bending_modulus() const { return plane_stress ? young : young / (1 - poisson * poisson); }
};

/// Strain of the material's energy from the deformation gradient F (dim×dim; dim = 2 is plane strain or
/// stress):
///   saint_venant_kirchhoff, neo_hookean  E = ½(FᵀF − 1)  (Green-Lagrange)
///   linear                               ε = ½(F + Fᵀ) − 1
template <int dim>
Eigen::Matrix<double, dim, dim> strain(const Material& m, const Eigen::Matrix<double, dim, dim>& F) {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  if (m.model == MaterialModel::linear) return 0.5 * (F + F.transpose()) - Matrix::Identity();
  return 0.5 * (F.transpose() * F - Matrix::Identity());
}

/// ln J = ½ ln det(1 + 2E), without the round-off that a determinant near one has. Never inlined: with it in
/// the body of its callers the compiler inlines less of them, and the last bits of sums depend on that.
template <int dim>
[[gnu::noinline]] double log_jacobian(const Eigen::Matrix<double, dim, dim>& E) {
  const Eigen::Matrix<double, dim, dim> A = 2 * E;
  double excess = A.trace() + A.determinant();  // det(1 + A) − 1
  if constexpr (dim == 3) excess += 0.5 * (A.trace() * A.trace() - (A * A).trace());
  return 0.5 * std::log1p(excess);
}

/// Energy density of a strain [J/m³]:
///   linear, saint_venant_kirchhoff  ψ = ½ λ (tr E)² + μ E:E
///   neo_hookean                     ψ = ½ μ (tr C − dim − 2 ln J) + ½ λ (ln J)²,  C = 2E + 1,  J² = det C
/// (Bonet & Wood 1997, eq. 5.28; out of the plane C_zz = 1). Not finite for a state that is turned inside
/// out.
template <int dim>
double energy_of_strain(const Material& m, const Eigen::Matrix<double, dim, dim>& E) {
  const double trace = E.trace();
  if (m.model != MaterialModel::neo_hookean)
    return 0.5 * m.lame_lambda() * trace * trace + m.lame_mu() * E.squaredNorm();
  const double log_j = log_jacobian<dim>(E);
  return m.lame_mu() * (trace - log_j) + 0.5 * m.lame_lambda() * log_j * log_j;
}

/// Neo-Hookean S = μ (1 − C⁻¹) + λ ln J C⁻¹ [Pa]. Never inlined: with an inverse and a logarithm in its body
/// the quadratic law beside it would not be inlined into the loops over particles, which costs them 45 %.
/// All that it calls is, whatever stands beside it: the same bits in every program.
template <int dim>
[[gnu::noinline, gnu::flatten]] Eigen::Matrix<double, dim, dim> neo_hookean_stress(
    const Material& m, const Eigen::Matrix<double, dim, dim>& E) {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  const Matrix C = 2 * E + Matrix::Identity(), inverse = C.inverse();
  return m.lame_mu() * (Matrix::Identity() - inverse) + m.lame_lambda() * log_jacobian<dim>(E) * inverse;
}

/// Second Piola-Kirchhoff stress S = ∂ψ/∂E [Pa]: λ tr(E) 1 + 2μ E, or the neo-Hookean stress above.
template <int dim>
Eigen::Matrix<double, dim, dim> second_piola_kirchhoff(const Material& m,
                                                       const Eigen::Matrix<double, dim, dim>& E) {
  if (m.model == MaterialModel::neo_hookean) return neo_hookean_stress<dim>(m, E);
  Eigen::Matrix<double, dim, dim> S = 2 * m.lame_mu() * E;
  S.diagonal().array() += m.lame_lambda() * E.trace();
  return S;
}

template <int dim>
double energy_density(const Material& m, const Eigen::Matrix<double, dim, dim>& F) {
  return energy_of_strain<dim>(m, strain<dim>(m, F));
}

/// First Piola-Kirchhoff stress P = ∂ψ/∂F = F S [Pa]; the linear model has P = S.
template <int dim>
Eigen::Matrix<double, dim, dim> first_piola_kirchhoff(const Material& m,
                                                      const Eigen::Matrix<double, dim, dim>& F) {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  const Matrix S = second_piola_kirchhoff<dim>(m, strain<dim>(m, F));
  if (m.model == MaterialModel::linear) return S;
  return F * S;
}

/// σ_zz of a body in the plane [Pa], `trace` that of its Cauchy stress in the plane. In plane strain it is
/// λ ln J/J for neo-Hookean, times the share that is intact, else ν (σ_xx + σ_yy), right to the order of the
/// strain.
inline double stress_across(const Material& m, const Eigen::Matrix2d& F, double trace, double intact = 1) {
  if (m.plane_stress) return 0;
  if (m.model != MaterialModel::neo_hookean) return m.poisson * trace;
  const double J = F.determinant();
  return intact * m.lame_lambda() * std::log(J) / J;
}

/// Speed of the P wave, plane strain and three dimensions: c_P = √((λ + 2μ)/ρ) [m/s].
inline double wave_speed(const Material& m) {
  return std::sqrt((m.lame_lambda() + 2 * m.lame_mu()) / m.density);
}

}  // namespace strake::structure
