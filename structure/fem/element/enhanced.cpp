#include "structure/fem/element/enhanced.hpp"

#include "structure/material/symmetric.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::structure::fem {
namespace {

// Of the strain. Newton's method squares its error, so that what is left after such a step is round-off.
constexpr double small_step = 1e-9;
constexpr int most_steps = 60, most_halvings = 30;
constexpr double enough = 1e-4;      // of the fall that the slope promises
constexpr double round_off = 1e-14;  // of the energy

/// H⁻¹ r, with the magnitudes of H's eigenvalues where one is negative: −λ ln J stands in the shear's place
/// of a neo-Hookean's stiffness, and where it is stretched by far there is a saddle beside the minimum.
Eigen::VectorXd downhill(const Eigen::MatrixXd& H, const Eigen::VectorXd& r) {
  const auto factors = H.ldlt();
  if (factors.isPositive()) return factors.solve(r);
  const SymmetricEigen eigen = eigen_of(H);
  const Eigen::VectorXd size = eigen.values.cwiseAbs().cwiseMax(1e-6 * eigen.values.cwiseAbs().maxCoeff());
  return eigen.vectors * Eigen::VectorXd(Eigen::VectorXd(eigen.vectors.transpose() * r).cwiseQuotient(size));
}

/// J_0⁻ᵀ M J_0⁻¹ with `value` in ij and ji of M, half of it in each.
template <int dim>
Components<dim> mode(const Tensor<dim>& inverse, int i, int j, double value) {
  Tensor<dim> M = Tensor<dim>::Zero();
  M(i, j) += 0.5 * value;
  M(j, i) += 0.5 * value;
  return strain_components<dim>(inverse.transpose() * M * inverse);
}

void fill_shell(auto& G, const Tensor<3>& inverse, const auto& xi, int thin) {
  const int a = (thin + 1) % 3, b = (thin + 2) % 3;
  int k = 0;
  for (const int i : {a, b}) G.col(k++) = mode<3>(inverse, i, i, xi(i));
  for (const int i : {a, b}) G.col(k++) = mode<3>(inverse, a, b, xi(i));
  for (const double along : {1.0, xi(a), xi(b)}) G.col(k++) = mode<3>(inverse, thin, thin, xi(thin) * along);
}

template <int dim>
void fill_linear(auto& G, const Tensor<dim>& inverse, const auto& xi) {
  int k = 0;
  for (int i = 0; i < dim; ++i) G.col(k++) = mode<dim>(inverse, i, i, xi(i));
  for (int i = 0; i < dim; ++i)
    for (int j = i + 1; j < dim; ++j) {
      G.col(k++) = mode<dim>(inverse, i, j, xi(i));
      G.col(k++) = mode<dim>(inverse, i, j, xi(j));
    }
  if constexpr (dim == 3)
    for (int i = 0; i < dim; ++i)
      G.col(k++) = strain_components<dim>(xi(i) * xi((i + 1) % dim) * Tensor<dim>::Identity());
}

template <int dim>
void fill_quadratic(auto& G, const auto& xi) {
  const auto legendre = [](int degree, double x) {
    return degree == 0 ? 1 : degree == 1 ? x : 0.5 * (3 * x * x - 1);
  };
  int k = 0;
  for (int c = 0; c < (dim == 3 ? 3 : 1); ++c)
    for (int b = 0; b < 3; ++b)
      for (int a = 0; a < 3; ++a) {
        if (a + b + c < 2) continue;
        double p = legendre(a, xi(0)) * legendre(b, xi(1));
        if constexpr (dim == 3) p *= legendre(c, xi(2));
        G.col(k++) = strain_components<dim>(p * Tensor<dim>::Identity());
      }
}

}  // namespace

template <int dim, int n>
EnhancedStrain<dim, n>::EnhancedStrain(const Mesh<dim>& mesh, int cell, int thin)
    : weight_(mesh.weight.data() + cell * n) {
  constexpr int of_a_shell = 7;
  const double volume = Eigen::Map<const Eigen::VectorXd>(weight_, n).sum();
  const Tensor<dim> inverse = Eigen::Map<const Tensor<dim>>(mesh.centre_inverse.col(cell).data());
  for (int q = 0; q < n; ++q) {
    Modes& G = modes_[static_cast<std::size_t>(q)];
    G.resize(components<dim>, thin >= 0 ? of_a_shell : modes);
    if constexpr (n != (1 << dim)) {
      fill_quadratic<dim>(G, mesh.point.col(q));
    } else if constexpr (dim == 3) {
      thin >= 0 ? fill_shell(G, inverse, mesh.point.col(q), thin)
                : fill_linear<dim>(G, inverse, mesh.point.col(q));
    } else {
      fill_linear<dim>(G, inverse, mesh.point.col(q));
    }
    G *= volume * mesh.reference_weight(q) / weight_[q];
  }
}

template <int dim, int n>
Eigen::MatrixXd EnhancedStrain<dim, n>::stiffness(const Material& m, const Strains<dim, n>& E) const {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(count(), count());
  for (int q = 0; q < n; ++q) {
    H.noalias() += weight_[q] * at(q).transpose() * (moduli<dim>(m, E[static_cast<std::size_t>(q)]) * at(q));
  }
  return H;
}

template <int dim, int n>
void EnhancedStrain<dim, n>::add_to(Strains<dim, n>& E, const Material& m) const {
  if (m.model != MaterialModel::neo_hookean) {
    E = sum(E, -stiffness(m, E).ldlt().solve(force(m, E)));
    return;
  }
  // Newton's method for the minimum of the cell's energy, which must fall along each step.
  Amplitudes alpha = Amplitudes::Zero(count());
  double energy = energy_of(m, E);
  for (int i = 0; i < most_steps && std::isfinite(energy); ++i) {
    const Strains<dim, n> here = sum(E, alpha);
    const Amplitudes r = force(m, here);
    Amplitudes step = -downhill(stiffness(m, here), r);
    double largest = 0;
    for (int q = 0; q < n; ++q) largest = std::max(largest, (at(q) * step).cwiseAbs().maxCoeff());
    if (largest <= small_step) {
      E = sum(E, alpha + step);
      return;
    }
    double next = energy_of(m, sum(E, alpha + step));
    const auto falls = [&] { return next <= energy + enough * r.dot(step) + round_off * std::abs(energy); };
    for (int k = 0; k < most_halvings && !falls(); ++k) {
      step /= 2;
      next = energy_of(m, sum(E, alpha + step));
    }
    alpha += step;
    energy = next;
  }
  for (Tensor<dim>& strain : E) strain.setConstant(std::numeric_limits<double>::quiet_NaN());
}

/// Σ w G:S.
template <int dim, int n>
typename EnhancedStrain<dim, n>::Amplitudes EnhancedStrain<dim, n>::force(const Material& m,
                                                                          const Strains<dim, n>& E) const {
  Amplitudes r = Amplitudes::Zero(count());
  for (int q = 0; q < n; ++q)
    r.noalias() += weight_[q] * at(q).transpose() *
                   stress_components<dim>(second_piola_kirchhoff<dim>(m, E[static_cast<std::size_t>(q)]));
  return r;
}

/// ∫ ψ; infinite where 2E + 1 is not positive definite.
template <int dim, int n>
double EnhancedStrain<dim, n>::energy_of(const Material& m, const Strains<dim, n>& E) const {
  double energy = 0;
  for (int q = 0; q < n; ++q) {
    const Tensor<dim>& strain = E[static_cast<std::size_t>(q)];
    if (!strain.allFinite() ||
        Tensor<dim>(2 * strain + Tensor<dim>::Identity()).llt().info() != Eigen::Success)
      return std::numeric_limits<double>::infinity();
    energy += weight_[q] * energy_of_strain<dim>(m, strain);
  }
  return energy;
}

template <int dim, int n>
Strains<dim, n> EnhancedStrain<dim, n>::sum(const Strains<dim, n>& E, const Amplitudes& alpha) const {
  Strains<dim, n> result;
  for (int q = 0; q < n; ++q)
    result[static_cast<std::size_t>(q)] = E[static_cast<std::size_t>(q)] + strain_tensor<dim>(at(q) * alpha);
  return result;
}

template class EnhancedStrain<2, 4>;
template class EnhancedStrain<2, 9>;
template class EnhancedStrain<3, 8>;
template class EnhancedStrain<3, 27>;

}  // namespace strake::structure::fem
