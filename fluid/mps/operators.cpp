#include "fluid/mps/operators.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cassert>

namespace strake::fluid {
namespace {

using std::size_t;

/// Limits of a moment matrix beyond which a correction would amplify noise (fluid/THEORY.md (F21)).
constexpr double smallest_determinant = 0.05, largest_condition = 20;

inline bool takes_part(std::span<const std::uint8_t> mask, std::int64_t i) {
  return mask.empty() || mask[static_cast<size_t>(i)];
}

/// Calls body(i) for every particle whose row is computed. Each call may write only what belongs to i.
template <class Body>
void for_each_row(const Neighbours& rows, const Masks& masks, Body&& body) {
  const auto n = rows.size();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i)
    if (takes_part(masks.row, i)) body(i);
}

/// Calls body(j, w, 1/r) for every partner of i that `masks.column` includes, in the order of the row.
template <class Body>
inline void for_each_pair(const Neighbours& rows, const Masks& masks, std::int64_t i, double radius,
                          Body&& body) {
  const auto row = rows.row(i);
  const auto inverse = rows.inverses(i);
  const std::uint8_t* column = masks.column.empty() ? nullptr : masks.column.data();
  for (size_t k = 0; k < row.size(); ++k) {
    const double w = radius * inverse[k] - 1;
    if (w <= 0 || (column && !column[row[k]])) continue;
    body(row[k], w, inverse[k]);
  }
}

/// Computes Σ_j f(j) r_ij w/r² of one row, f: scalar per pair.
template <int dim, class Value>
inline Vector<dim> gradient_sum(const Vectors<dim>& position, const Neighbours& rows, const Masks& masks,
                                std::int64_t i, double radius, Value&& value) {
  const Vector<dim> at = position.col(i);
  const auto seams = rows.seams<dim>();
  Vector<dim> sum = Vector<dim>::Zero();
  for_each_pair(rows, masks, i, radius, [&](std::int32_t j, double w, double inverse) {
    sum += (value(j) * w * inverse * inverse) * seams.separation(at, position.col(j));
  });
  return sum;
}

}  // namespace

template <int dim>
Vectors<dim> gradient_min_pressure(const Vectors<dim>& position, const Eigen::VectorXd& phi,
                                   const Neighbours& rows, const LatticeConstants& lattice,
                                   const Masks& masks) {
  Vectors<dim> gradient = Vectors<dim>::Zero(dim, rows.size());
  for_each_row(rows, masks, [&](std::int64_t i) {
    double smallest = phi[i];
    for_each_pair(rows, masks, i, lattice.radius,
                  [&](std::int32_t j, double, double) { smallest = std::min(smallest, phi[j]); });
    gradient.col(i) = dim / lattice.n0 *
                      gradient_sum<dim>(position, rows, masks, i, lattice.radius,
                                        [&](std::int32_t j) { return phi[j] - smallest; });
  });
  return gradient;
}

template <int dim>
Vectors<dim> gradient_pairwise(const Vectors<dim>& position, const Eigen::VectorXd& phi,
                               const Neighbours& rows, const LatticeConstants& lattice, const Masks& masks) {
  Vectors<dim> gradient = Vectors<dim>::Zero(dim, rows.size());
  for_each_row(rows, masks, [&](std::int64_t i) {
    gradient.col(i) = dim / lattice.n0 *
                      gradient_sum<dim>(position, rows, masks, i, lattice.radius,
                                        [&](std::int32_t j) { return phi[j] + phi[i]; });
  });
  return gradient;
}

template <int dim>
Vectors<dim> gradient_corrected(const Vectors<dim>& position, const Eigen::VectorXd& phi,
                                const Neighbours& rows, const LatticeConstants& lattice,
                                std::span<const Tensor<dim>> correction, const Masks& masks) {
  assert(correction.size() == static_cast<size_t>(rows.size()));
  Vectors<dim> gradient = Vectors<dim>::Zero(dim, rows.size());
  for_each_row(rows, masks, [&](std::int64_t i) {
    gradient.col(i) = dim / lattice.n0 *
                      (correction[static_cast<size_t>(i)] *
                       gradient_sum<dim>(position, rows, masks, i, lattice.radius,
                                         [&](std::int32_t j) { return phi[j] - phi[i]; }));
  });
  return gradient;
}

template <int dim>
std::vector<Tensor<dim>> gradient_correction(const Vectors<dim>& position, const Neighbours& rows,
                                             const LatticeConstants& lattice, const Masks& masks) {
  std::vector<Tensor<dim>> correction(static_cast<size_t>(rows.size()), Tensor<dim>::Identity());
  const auto seams = rows.seams<dim>();
  for_each_row(rows, masks, [&](std::int64_t i) {
    const Vector<dim> at = position.col(i);
    Tensor<dim> moment = Tensor<dim>::Zero();
    for_each_pair(rows, masks, i, lattice.radius, [&](std::int32_t j, double w, double inverse) {
      const Vector<dim> r = seams.separation(at, position.col(j));
      const Vector<dim> scaled = (w * inverse * inverse) * r;
      for (int m = 0; m < dim; ++m) moment.col(m) += r[m] * scaled;
    });
    moment *= dim / lattice.n0;
    if (moment.determinant() < smallest_determinant) return;
    Eigen::SelfAdjointEigenSolver<Tensor<dim>> spectrum;
    spectrum.computeDirect(moment, Eigen::EigenvaluesOnly);
    const auto& values = spectrum.eigenvalues();
    if (values[0] <= 0 || values[dim - 1] > largest_condition * values[0]) return;
    correction[static_cast<size_t>(i)] = moment.inverse();
  });
  return correction;
}

template <int dim>
Eigen::VectorXd divergence(const Vectors<dim>& position, const Vectors<dim>& velocity, const Neighbours& rows,
                           const LatticeConstants& lattice, const Masks& masks) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(rows.size());
  const auto seams = rows.seams<dim>();
  for_each_row(rows, masks, [&](std::int64_t i) {
    const Vector<dim> at = position.col(i), moves = velocity.col(i);
    double sum = 0;
    for_each_pair(rows, masks, i, lattice.radius, [&](std::int32_t j, double w, double inverse) {
      sum += (velocity.col(j) - moves).dot(seams.separation(at, position.col(j))) * (w * inverse * inverse);
    });
    result[i] = dim / lattice.n0 * sum;
  });
  return result;
}

template <int dim>
std::vector<Tensor<dim>> velocity_gradient(const Vectors<dim>& position, const Vectors<dim>& velocity,
                                           const Neighbours& rows, const LatticeConstants& lattice,
                                           std::span<const Tensor<dim>> correction, const Masks& masks) {
  assert(correction.empty() || correction.size() == static_cast<size_t>(rows.size()));
  std::vector<Tensor<dim>> gradient(static_cast<size_t>(rows.size()), Tensor<dim>::Zero());
  const auto seams = rows.seams<dim>();
  for_each_row(rows, masks, [&](std::int64_t i) {
    const Vector<dim> at = position.col(i), moves = velocity.col(i);
    Tensor<dim> sum = Tensor<dim>::Zero();
    for_each_pair(rows, masks, i, lattice.radius, [&](std::int32_t j, double w, double inverse) {
      const Vector<dim> u = velocity.col(j) - moves,
                        r = (w * inverse * inverse) * seams.separation(at, position.col(j));
      for (int m = 0; m < dim; ++m) sum.col(m) += r[m] * u;
    });
    sum *= dim / lattice.n0;
    if (!correction.empty()) sum *= correction[static_cast<size_t>(i)];  // C is symmetric
    gradient[static_cast<size_t>(i)] = sum;
  });
  return gradient;
}

template <int dim>
Eigen::VectorXd laplacian(const Eigen::VectorXd& phi, const Neighbours& rows, const LatticeConstants& lattice,
                          const Masks& masks) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(rows.size());
  const double factor = 2 * dim / (lattice.n0 * lattice.lambda0);
  for_each_row(rows, masks, [&](std::int64_t i) {
    double sum = 0;
    for_each_pair(rows, masks, i, lattice.radius,
                  [&](std::int32_t j, double w, double) { sum += (phi[j] - phi[i]) * w; });
    result[i] = factor * sum;
  });
  return result;
}

template <int dim>
Vectors<dim> laplacian(const Vectors<dim>& u, const Neighbours& rows, const LatticeConstants& lattice,
                       const Masks& masks) {
  Vectors<dim> result = Vectors<dim>::Zero(dim, rows.size());
  const double factor = 2 * dim / (lattice.n0 * lattice.lambda0);
  for_each_row(rows, masks, [&](std::int64_t i) {
    const Vector<dim> here = u.col(i);
    Vector<dim> sum = Vector<dim>::Zero();
    for_each_pair(rows, masks, i, lattice.radius,
                  [&](std::int32_t j, double w, double) { sum += w * (u.col(j) - here); });
    result.col(i) = factor * sum;
  });
  return result;
}

template <int dim>
Vectors<dim> stress_divergence(const Vectors<dim>& position, std::span<const Tensor<dim>> tau,
                               const Neighbours& rows, const LatticeConstants& lattice, const Masks& masks) {
  assert(tau.size() == static_cast<size_t>(rows.size()));
  Vectors<dim> result = Vectors<dim>::Zero(dim, rows.size());
  const auto seams = rows.seams<dim>();
  for_each_row(rows, masks, [&](std::int64_t i) {
    const Vector<dim> at = position.col(i);
    const Tensor<dim>& own = tau[static_cast<size_t>(i)];
    Vector<dim> sum = Vector<dim>::Zero();
    for_each_pair(rows, masks, i, lattice.radius, [&](std::int32_t j, double w, double inverse) {
      sum += (own + tau[static_cast<size_t>(j)]) *
             ((w * inverse * inverse) * seams.separation(at, position.col(j)));
    });
    result.col(i) = dim / lattice.n0 * sum;
  });
  return result;
}

template Vectors<2> gradient_min_pressure<2>(const Vectors<2>&, const Eigen::VectorXd&, const Neighbours&,
                                             const LatticeConstants&, const Masks&);
template Vectors<3> gradient_min_pressure<3>(const Vectors<3>&, const Eigen::VectorXd&, const Neighbours&,
                                             const LatticeConstants&, const Masks&);
template Vectors<2> gradient_pairwise<2>(const Vectors<2>&, const Eigen::VectorXd&, const Neighbours&,
                                         const LatticeConstants&, const Masks&);
template Vectors<3> gradient_pairwise<3>(const Vectors<3>&, const Eigen::VectorXd&, const Neighbours&,
                                         const LatticeConstants&, const Masks&);
template Vectors<2> gradient_corrected<2>(const Vectors<2>&, const Eigen::VectorXd&, const Neighbours&,
                                          const LatticeConstants&, std::span<const Tensor<2>>, const Masks&);
template Vectors<3> gradient_corrected<3>(const Vectors<3>&, const Eigen::VectorXd&, const Neighbours&,
                                          const LatticeConstants&, std::span<const Tensor<3>>, const Masks&);
template std::vector<Tensor<2>> gradient_correction<2>(const Vectors<2>&, const Neighbours&,
                                                       const LatticeConstants&, const Masks&);
template std::vector<Tensor<3>> gradient_correction<3>(const Vectors<3>&, const Neighbours&,
                                                       const LatticeConstants&, const Masks&);
template Eigen::VectorXd divergence<2>(const Vectors<2>&, const Vectors<2>&, const Neighbours&,
                                       const LatticeConstants&, const Masks&);
template Eigen::VectorXd divergence<3>(const Vectors<3>&, const Vectors<3>&, const Neighbours&,
                                       const LatticeConstants&, const Masks&);
template std::vector<Tensor<2>> velocity_gradient<2>(const Vectors<2>&, const Vectors<2>&, const Neighbours&,
                                                     const LatticeConstants&, std::span<const Tensor<2>>,
                                                     const Masks&);
template std::vector<Tensor<3>> velocity_gradient<3>(const Vectors<3>&, const Vectors<3>&, const Neighbours&,
                                                     const LatticeConstants&, std::span<const Tensor<3>>,
                                                     const Masks&);
template Eigen::VectorXd laplacian<2>(const Eigen::VectorXd&, const Neighbours&, const LatticeConstants&,
                                      const Masks&);
template Eigen::VectorXd laplacian<3>(const Eigen::VectorXd&, const Neighbours&, const LatticeConstants&,
                                      const Masks&);
template Vectors<2> laplacian<2>(const Vectors<2>&, const Neighbours&, const LatticeConstants&, const Masks&);
template Vectors<3> laplacian<3>(const Vectors<3>&, const Neighbours&, const LatticeConstants&, const Masks&);
template Vectors<2> stress_divergence<2>(const Vectors<2>&, std::span<const Tensor<2>>, const Neighbours&,
                                         const LatticeConstants&, const Masks&);
template Vectors<3> stress_divergence<3>(const Vectors<3>&, std::span<const Tensor<3>>, const Neighbours&,
                                         const LatticeConstants&, const Masks&);

}  // namespace strake::fluid
