#include "coupler/mapping/partition_of_unity.hpp"
#include "proto/error.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <fmt/format.h>

#include <limits>

namespace strake {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Sources that extend less than this in a direction, relative to their largest extent, are flat in it.
constexpr double flat = 1e-6;
// Limits the linear polynomial in a direction in which the sources are thin (relative to their largest
// extent). It is used for targets at most `farthest` of their extents away; beyond, it amplifies errors of
// the fit.
constexpr double thin = 0.2, farthest = 2;

/// 1 and the linear functions along the axes in which the sources have an extent, about their centre.
class Polynomial {
 public:
  Polynomial(bool linear, const Points& sources, const Points& targets) : centre_(sources.rowwise().mean()) {
    if (!linear) return;
    const Points from_centre = sources.colwise() - centre_;
    const Eigen::Matrix3d moments = from_centre * from_centre.transpose();
    const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors();
    const Vector3d extent = (axes.transpose() * from_centre).cwiseAbs().rowwise().maxCoeff();
    const Vector3d wanted =
        (axes.transpose() * (targets.colwise() - centre_)).cwiseAbs().rowwise().maxCoeff();
    const double largest = extent.maxCoeff();
    for (int d = 0; d < 3; ++d) {
      const bool has_extent = extent[d] > flat * largest;
      const bool reaches = extent[d] > thin * largest || wanted[d] <= farthest * extent[d];
      if (has_extent && reaches) slope_.row(directions_++) = axes.col(d).transpose() / extent[d];
    }
  }
  int directions() const { return directions_; }
  /// One column of 1 + directions() values per point.
  MatrixXd at(const Points& points) const {
    MatrixXd value(1 + directions_, points.cols());
    value.row(0).setOnes();
    value.bottomRows(directions_) = slope_.topRows(directions_) * (points.colwise() - centre_);
    return value;
  }

 private:
  Vector3d centre_;
  Eigen::Matrix3d slope_ = Eigen::Matrix3d::Zero();
  int directions_ = 0;
};

/// φ between all sources (rows) and all points (columns).
MatrixXd basis(RadialFunction function, double support, const Points& sources, const Points& points) {
  const Eigen::MatrixX3d x = sources.transpose();
  MatrixXd value(sources.cols(), points.cols());
  for (Index j = 0; j < points.cols(); ++j) {
    const Vector3d p = points.col(j);
    value.col(j) = radial_values(function, support,
                                 (x.col(0).array() - p.x()).square() + (x.col(1).array() - p.y()).square() +
                                     (x.col(2).array() - p.z()).square());
  }
  return value;
}

}  // namespace

RadialFunction radial_function(const std::string& name) {
  if (name == "wendland-c2") return RadialFunction::wendland_c2;
  if (name == "wendland-c4") return RadialFunction::wendland_c4;
  if (name == "wendland-c6") return RadialFunction::wendland_c6;
  if (name == "thin-plate") return RadialFunction::thin_plate;
  throw Error(ExitCode::case_file, "coupling.surface.mapping.radial_basis.function",
              fmt::format("\"{}\" is not a radial basis function", name),
              "wendland-c2, wendland-c4, wendland-c6 or thin-plate");
}

bool has_support(RadialFunction function) {
  return function != RadialFunction::thin_plate;
}

// Wendland, positive definite in space, q = r/support < 1, 0 beyond:
//   C2 (1−q)⁴(4q+1),  C4 (1−q)⁶(35q²+18q+3)/3,  C6 (1−q)⁸(32q³+25q²+8q+1);
// thin plate r² ln r, conditionally positive definite with linear polynomials
// (H. Wendland, Scattered Data Approximation, 2005, table 9.1 and section 8.3).
ArrayXd radial_values(RadialFunction function, double support, const ArrayXd& squared_distance) {
  if (function == RadialFunction::thin_plate)
    return 0.5 * squared_distance * squared_distance.max(std::numeric_limits<double>::min()).log();
  const ArrayXd q = (squared_distance.sqrt() / support).min(1.0), p = (1 - q).square();
  if (function == RadialFunction::wendland_c2) return p.square() * (4 * q + 1);
  if (function == RadialFunction::wendland_c4) return p.cube() * ((35 * q + 18) * q + 3) / 3;
  return p.square().square() * (((32 * q + 25) * q + 8) * q + 1);
}

// s(x) = Σ_j a_j φ(|x − x_j|) + b·p(x),  s(x_j) = u_j,  Pᵀa = 0 with P_jk = p_k(x_j) = (Q₁ Q₂)(R; 0).
// a = Q₂ z turns this into Q₂ᵀΦQ₂ z = Q₂ᵀu, a positive definite system, and s(x) = w(x)·u with
//   w = Q₁ g + Q₂ (Q₂ᵀΦQ₂)⁻¹ (Q₂ᵀφ(x) − Q₂ᵀΦQ₁ g),  g = R⁻ᵀ p(x).
// Pᵀw = p(x) for every second term: the polynomial is exact for any condition.
LocalWeights local_weights(RadialFunction function, double support, bool linear, const Points& sources,
                           const Points& targets) {
  const Polynomial polynomial(linear || !has_support(function), sources, targets);
  const Index n = sources.cols(), m = 1 + polynomial.directions();
  const Eigen::HouseholderQR<MatrixXd> qr(polynomial.at(sources).transpose());
  const MatrixXd g =
      qr.matrixQR().topRows(m).triangularView<Eigen::Upper>().transpose().solve(polynomial.at(targets));
  LocalWeights result;
  result.directions = polynomial.directions();
  result.weights.resize(n, targets.cols());
  result.weights.topRows(m) = g;
  if (n > m) {
    MatrixXd phi = basis(function, support, sources, sources);
    phi.applyOnTheLeft(qr.householderQ().adjoint());
    phi.applyOnTheRight(qr.householderQ());
    MatrixXd right = basis(function, support, sources, targets);
    right.applyOnTheLeft(qr.householderQ().adjoint());
    auto rest = result.weights.bottomRows(n - m);
    rest = right.bottomRows(n - m);
    rest.noalias() -= phi.bottomLeftCorner(n - m, m) * g;
    const Eigen::LLT<MatrixXd> cholesky(phi.bottomRightCorner(n - m, n - m));
    if (cholesky.info() == Eigen::Success) {
      cholesky.solveInPlace(rest);
      result.condition = 1 / cholesky.rcond();
    } else {  // a thin plate's points that are all but flat
      const Eigen::PartialPivLU<MatrixXd> lu(phi.bottomRightCorner(n - m, n - m));
      rest = lu.solve(MatrixXd(rest));
      result.condition = has_support(function) ? std::numeric_limits<double>::infinity() : 1 / lu.rcond();
    }
  }
  result.weights.applyOnTheLeft(qr.householderQ());
  return result;
}

}  // namespace strake
