#pragma once

#include "coupler/acceleration/shared_columns.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace strake {

/// Which columns of ΔR a least-squares problem leaves out, going from the newest to the oldest. With the
/// distance d of a column from the span of those taken before it:
struct SecantFilter {
  enum class Kind {
    qr2,  // d <= limit · |column|: says nothing new, whatever its size
    qr1   // d <= limit · |R|, R the triangle of those taken: too small beside them (Frobenius norm)
  };
  Kind kind = Kind::qr2;
  double limit = 1e-2;
  double own_limit = 1e-4;  // the same for the current window's columns
};

/// Solves min over α of |D (ΔR α + r)| over the columns that the filter keeps. D are the weights of the
/// blocks. With the bases ΔR_b = Q_b T_b of the blocks it is the small problem min |S α + g|, S the w_b T_b
/// and g the w_b Q_bᵀ r_b one below the other, solved by S = U R with unit columns.
struct LeastSquares {
  std::vector<Eigen::Index> kept;  // indices of columns, newest first
  Eigen::MatrixXd u, r;
  Eigen::VectorXd length;  // of each kept column: S(kept) = U R diag(length)
  Eigen::VectorXd alpha(const Eigen::VectorXd& g) const;
};

/// Differences between successive iterations, oldest first. ΔR is that of the residual H(x) − x, block by
/// block, ΔH that of the image.
struct Secants {
  std::vector<OrthonormalBasis> residual;  // one for each block
  SharedColumns image;
  std::vector<Eigen::Index> windows;  // columns of each window that has some, oldest first
  Eigen::Index own = 0;               // of them of the current window, which has none yet if 0

  Eigen::Index columns() const { return static_cast<Eigen::Index>(image.size()); }
  /// `sizes`: of the blocks. At most `most` columns are kept, the newest.
  void append(const std::vector<Eigen::Index>& sizes, const Eigen::VectorXd& residual_change,
              Eigen::VectorXd image_change, int most);
  /// A new window; all but the newest `keep` of the earlier ones are dropped.
  void start_window(int keep);
  /// Only those of the current window are left.
  void forget_earlier() { drop_oldest(columns() - own); }
  /// g of the least-squares problem.
  Eigen::VectorXd project(const std::vector<Eigen::Index>& sizes, const Eigen::VectorXd& weights,
                          const Eigen::VectorXd& r) const;
  LeastSquares factorise(const Eigen::VectorXd& weights, const SecantFilter&) const;
  /// r += ΔR α of the columns that were kept, whose sizes are those of the blocks.
  void add_residuals(const LeastSquares&, const Eigen::VectorXd& alpha,
                     const std::vector<Eigen::Index>& sizes, Eigen::VectorXd& r) const;
  /// ΔH of the columns that were kept.
  SharedColumns images(const LeastSquares&) const;
  /// (ΔR⁺)ᵀ of the columns that were kept: α = −ΔR⁺ r.
  SharedColumns pseudo_inverse(const LeastSquares&, const std::vector<Eigen::Index>& sizes,
                               const Eigen::VectorXd& weights) const;

  void save(Archive&, const std::string& name) const;
  void load(const Archive&, const std::string& name);

 private:
  void drop_oldest(Eigen::Index n);
};

}  // namespace strake
