#include "structure/particle/linearised.hpp"

#include <cmath>

namespace strake::structure {
namespace {

/// The displacement and the turn of each particle from which the power iteration starts. The shortest waves
/// are the stiffest: signs alternate, and every symmetry is broken a little.
template <int dim>
void start_vector(const Lattice<dim>& lattice, Vectors<dim>& v, Eigen::VectorXd& spin) {
  for (Eigen::Index i = 0; i < lattice.size(); ++i) {
    const int c = lattice.cell(0, i), l = lattice.cell(1, i);
    v(0, i) = ((c + l) % 2 ? 1 : -1) * (1 + 0.1 * std::sin(3.7 * c + 1.3 * l));
    v(1, i) = (c % 2 ? 1 : -1) * (1 + 0.1 * std::cos(2.9 * c - 0.7 * l));
    if constexpr (dim == 3) {
      const int k = lattice.cell(2, i);
      v.col(i) *= (k % 2 ? 1 : -1) * (1 + 0.1 * std::sin(2.3 * k));
      v(2, i) = ((l + k) % 2 ? 1 : -1) * (1 + 0.1 * std::cos(3.1 * k + 0.9 * c));
    }
    if (spin.size() > 0) spin[i] = 1 + 0.1 * std::sin(1.9 * c + 2.7 * l);  // all alike is the stiffest
  }
}

/// Sets fixed particles to zero and gives the sum of what stood in them: the frame's when it is free.
template <int dim>
Eigen::Matrix<double, dim, 1> take_out_fixed(const Lattice<dim>& lattice, Vectors<dim>& x,
                                             Eigen::VectorXd& turn) {
  Eigen::Matrix<double, dim, 1> sum = Eigen::Matrix<double, dim, 1>::Zero();
  for (Eigen::Index i = 0; i < lattice.size(); ++i)
    if (lattice.fixed[static_cast<std::size_t>(i)]) {
      sum += x.col(i);
      x.col(i).setZero();
      if (turn.size() > 0) turn[i] = 0;
    }
  return sum;
}

/// K times a disturbance over `heaviest` [kg], by central differences of the forces and moments.
template <int dim>
Vectors<dim> stiffness_times(const ElasticModel<dim>& model, const Vectors<dim>& disturbed,
                             const Eigen::VectorXd& turned, double step, double heaviest,
                             const Eigen::VectorXd& arm, Eigen::VectorXd& K_spin) {
  if (!model.spins()) return (model.force(-disturbed) - model.force(disturbed)) / (2 * step * heaviest);
  Eigen::VectorXd ahead, back;
  Vectors<dim> Kv = model.force(-disturbed, -turned, back);
  Kv = (Kv - model.force(disturbed, turned, ahead)) / (2 * step * heaviest);
  K_spin = ((back - ahead) / (2 * step * heaviest)).cwiseQuotient(arm);
  return Kv;
}

}  // namespace

// In y = M^½ v, so that the operator is symmetric. Where particles turn as unknowns of their own they count
// with I^½ θ, I = m l0²/6. A free frame is one more unknown along each axis, on which the forces of all fixed
// particles act. The supports' equations are left out: they can only lower ω_max.
template <int dim>
double elastic_limit(const ElasticModel<dim>& model, const Lattice<dim>& lattice, const Eigen::VectorXd& mass,
                     const Eigen::Matrix<double, dim, 1>& frame_mass) {
  constexpr int iterations = 150;  // Rayleigh quotient within 1 % of ω²_max (tested against the exact value)
  using Vector = Eigen::Matrix<double, dim, 1>;
  const Eigen::Index n = lattice.size();
  Vectors<dim> v(dim, n);
  Eigen::VectorXd spin = Eigen::VectorXd::Zero(model.spins() ? n : 0);
  start_vector<dim>(lattice, v, spin);
  const double heaviest = mass.maxCoeff();
  const Vector frame_root = (frame_mass / heaviest).cwiseSqrt();
  Vector frame = Vector::Ones();
  take_out_fixed<dim>(lattice, v, spin);
  const Eigen::RowVectorXd root = (mass / heaviest).cwiseSqrt().transpose();  // 1 throughout for one material
  const Eigen::VectorXd arm = root.transpose() * (lattice.spacing / std::sqrt(6.0));
  const double step = difference_step * lattice.spacing;
  double omega2 = 0;
  for (int k = 0; k < iterations; ++k) {
    for (int axis = 0; axis < dim; ++axis)
      if (!std::isfinite(frame_mass[axis])) frame[axis] = 0;
    const double size = std::sqrt(v.squaredNorm() + frame.squaredNorm() + spin.squaredNorm());
    v /= size;
    frame /= size;
    spin /= size;
    Vectors<dim> disturbed = step * (v.array().rowwise() / root.array()).matrix();
    for (Eigen::Index i = 0; i < n; ++i)
      if (lattice.fixed[static_cast<std::size_t>(i)])
        disturbed.col(i) = step * frame.cwiseQuotient(frame_root);
    Eigen::VectorXd turned, K_spin;
    if (model.spins()) turned = step * spin.cwiseQuotient(arm);
    Vectors<dim> Kv = stiffness_times<dim>(model, disturbed, turned, step, heaviest, arm, K_spin);
    const Vector K_frame = take_out_fixed<dim>(lattice, Kv, K_spin).cwiseQuotient(frame_root);
    Kv.array().rowwise() /= root.array();
    omega2 = v.cwiseProduct(Kv).sum() + frame.dot(K_frame);
    if (model.spins()) omega2 += spin.dot(K_spin);
    v = Kv;
    frame = K_frame;
    if (model.spins()) spin = K_spin;
  }
  return 2 / std::sqrt(omega2);
}

template double elastic_limit<2>(const ElasticModel<2>&, const Lattice<2>&, const Eigen::VectorXd&,
                                 const Eigen::Matrix<double, 2, 1>&);
template double elastic_limit<3>(const ElasticModel<3>&, const Lattice<3>&, const Eigen::VectorXd&,
                                 const Eigen::Matrix<double, 3, 1>&);

}  // namespace strake::structure
