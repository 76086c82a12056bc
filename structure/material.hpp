#pragma once

#include <Eigen/Core>

#include <cmath>

namespace strake::structure {

enum class MaterialModel { linear, saint_venant_kirchhoff };

struct Material {
  MaterialModel model = MaterialModel::saint_venant_kirchhoff;
  double density = 7800;  // [kg/m^3]
  double young = 2.1e11;  // [Pa]
  double poisson = 0.3;
  double lame_lambda() const {
    return young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  }  // plane strain and 3-D
  double lame_mu() const { return young / (2 * (1 + poisson)); }
};

/// Strain of the material's energy from the deformation gradient F (dim×dim; dim = 2 is plane strain):
///   saint_venant_kirchhoff  E = ½(FᵀF − 1)  (Green-Lagrange)
///   linear                  ε = ½(F + Fᵀ) − 1
template <int dim>
Eigen::Matrix<double, dim, dim> strain(const Material& m, const Eigen::Matrix<double, dim, dim>& F) {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  if (m.model == MaterialModel::linear) return 0.5 * (F + F.transpose()) - Matrix::Identity();
  return 0.5 * (F.transpose() * F - Matrix::Identity());
}

/// Energy density ψ = ½ λ (tr E)² + μ E:E  [J/m³].
template <int dim>
double energy_density(const Material& m, const Eigen::Matrix<double, dim, dim>& F) {
  const auto E = strain<dim>(m, F);
  const double trace = E.trace();
  return 0.5 * m.lame_lambda() * trace * trace + m.lame_mu() * E.squaredNorm();
}

/// First Piola-Kirchhoff stress P = ∂ψ/∂F [Pa]: F S with S = λ tr(E) 1 + 2μ E; the linear model has P = S.
template <int dim>
Eigen::Matrix<double, dim, dim> first_piola_kirchhoff(const Material& m,
                                                      const Eigen::Matrix<double, dim, dim>& F) {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  const Matrix E = strain<dim>(m, F);
  const Matrix S = m.lame_lambda() * E.trace() * Matrix::Identity() + 2 * m.lame_mu() * E;
  return m.model == MaterialModel::linear ? S : Matrix(F * S);
}

/// Speed of the P wave, plane strain and three dimensions: c_P = √((λ + 2μ)/ρ) [m/s].
inline double wave_speed(const Material& m) {
  return std::sqrt((m.lame_lambda() + 2 * m.lame_mu()) / m.density);
}

}  // namespace strake::structure
