#include "structure/failure/softening.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace strake::structure {

double integrity_after(double first, double largest, double last) {
  if (first == 0) return 1;
  if (largest >= last) return 0;
  return first / largest * (last - largest) / (last - first);
}

double equivalent_stress(FailureCriterion criterion, const Eigen::Matrix3d& stress) {
  if (criterion == FailureCriterion::max_principal)
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(0.5 * (stress + stress.transpose()),
                                                          Eigen::EigenvaluesOnly)
        .eigenvalues()
        .maxCoeff();
  const Eigen::Matrix3d deviator = stress - stress.trace() / 3 * Eigen::Matrix3d::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

Eigen::Vector3d principal_direction(const Eigen::Matrix3d& stress) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(0.5 * (stress + stress.transpose()))
      .eigenvectors()
      .col(2);
}

template <int dim>
Eigen::Matrix3d cauchy_stress(const Material& material, const Eigen::Matrix<double, dim, dim>& F) {
  const Eigen::Matrix<double, dim, dim> P = first_piola_kirchhoff<dim>(material, F);
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
  stress.template topLeftCorner<dim, dim>() = P * F.transpose() / F.determinant();
  if constexpr (dim == 2) stress(2, 2) = stress_across(material, F, stress.trace());
  return stress;
}

double uniaxial_modulus(const Material& m, int dimension) {
  return dimension == 2 ? m.bending_modulus() : m.young;
}

double widest_band(const FailureKeys& keys, const Material& material, int dimension) {
  return 2 * keys.fracture_energy * uniaxial_modulus(material, dimension) / (keys.strength * keys.strength);
}

template Eigen::Matrix3d cauchy_stress<2>(const Material&, const Eigen::Matrix2d&);
template Eigen::Matrix3d cauchy_stress<3>(const Material&, const Eigen::Matrix3d&);

}  // namespace strake::structure
