#include "structure/body/beam.hpp"

#include "structure/material/symmetric.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace strake::structure {
namespace {

/// Stiffness and mass of one element, degrees of freedom (w, θ) at both ends.
struct Element {
  Eigen::Matrix4d stiffness, mass;
};

// Cubic deflection w = Σ a_k x^k with the rotation that follows from its own equilibrium:
//   EI θ'' + κGA (w' − θ) = 0   ⇒   θ = w' + Φ a_3,  Φ = 6 EI / (κGA)   (Φ = 0: Euler-Bernoulli)
//   U = ½∫(EI θ'² + κGA (w' − θ)²) dx,   T = ½∫(ρA ẇ² + ρI θ̇²) dx
Element element(double length, double EI, double kGA, double rhoA, double rhoI) {
  const double phi = kGA > 0 ? 6 * EI / kGA : 0;
  const auto w = [](double x) { return Eigen::RowVector4d(1, x, x * x, x * x * x); };
  const auto theta = [&](double x) { return Eigen::RowVector4d(0, 1, 2 * x, 3 * x * x + phi); };
  Eigen::Matrix4d ends;  // end values of (w, θ) from the coefficients a
  ends << w(0), theta(0), w(length), theta(length);
  const Eigen::Matrix4d a = ends.inverse();

  Element e{Eigen::Matrix4d::Zero(), Eigen::Matrix4d::Zero()};
  // Gauss-Legendre, 4 points: exact to degree 7, the mass needs 6.
  constexpr std::array<double, 4> point = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                           0.8611363115940526};
  constexpr std::array<double, 4> weight = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                            0.3478548451374538};
  for (std::size_t g = 0; g < point.size(); ++g) {
    const double x = 0.5 * length * (1 + point[g]), dx = 0.5 * length * weight[g];
    const Eigen::RowVector4d curvature(0, 0, 2, 6 * x), shear(0, 0, 0, phi);
    e.stiffness += dx * (EI * curvature.transpose() * curvature + kGA * shear.transpose() * shear);
    e.mass += dx * (rhoA * w(x).transpose() * w(x) + rhoI * theta(x).transpose() * theta(x));
  }
  e.stiffness = a.transpose() * e.stiffness * a;
  e.mass = a.transpose() * e.mass * a;
  return e;
}

}  // namespace

std::vector<double> beam_frequencies(const Plate& plate, const Material& m, BeamTheory theory, int count) {
  constexpr int n_elements = 40;  // cubic elements: the first modes are exact to 1e-6
  constexpr double shear_factor = 5.0 / 6.0;
  const double h = plate.thickness, I = h * h * h / 12;
  const double EI = m.bending_modulus() * I;
  const bool thick = theory == BeamTheory::timoshenko;
  const Element e = element(plate.length / n_elements, EI, thick ? shear_factor * m.lame_mu() * h : 0,
                            m.density * h, thick ? m.density * I : 0);

  const int n = 2 * (n_elements + 1);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n), M = K;
  for (int i = 0; i < n_elements; ++i) {
    K.block<4, 4>(2 * i, 2 * i) += e.stiffness;
    M.block<4, 4>(2 * i, 2 * i) += e.mass;
  }
  std::vector<int> free;
  const auto constrained = [](Support support, int dof) {
    return support == Support::clamped || (support == Support::pinned && dof == 0);
  };
  for (int i = 0; i < n; ++i)
    if (!(i < 2 && constrained(plate.left, i)) && !(i >= n - 2 && constrained(plate.right, i - n + 2)))
      free.push_back(i);
  // K x = ω² M x with M = L Lᵀ: the eigenvalues of L⁻¹ K L⁻ᵀ.
  const Eigen::LLT<Eigen::MatrixXd> factors(M(free, free));
  const Eigen::MatrixXd Kf = K(free, free);
  Eigen::MatrixXd C = Kf.selfadjointView<Eigen::Lower>();
  factors.matrixL().solveInPlace<Eigen::OnTheLeft>(C);
  factors.matrixU().solveInPlace<Eigen::OnTheRight>(C);
  const Eigen::VectorXd omega2 = eigenvalues_of(C);

  // Largest ω² of a rigid motion, in units of EI/(ρh L⁴). Its exact value is 0; round-off is below this
  // limit, and the lowest elastic mode far above.
  const double rigid = 1e-3 * EI / (m.density * h * std::pow(plate.length, 4));
  std::vector<double> f;
  for (const double o : omega2)
    if (o > rigid && static_cast<int>(f.size()) < count) f.push_back(std::sqrt(o) / (2 * std::numbers::pi));
  return f;
}

std::string beam_line(const Plate& plate, const Material& m) {
  return fmt::format("f1 dry {:.1f} Hz (Euler-Bernoulli), {:.1f} Hz (Timoshenko)",
                     beam_frequencies(plate, m, BeamTheory::euler_bernoulli, 1).at(0),
                     beam_frequencies(plate, m, BeamTheory::timoshenko, 1).at(0));
}

}  // namespace strake::structure
