#pragma once

#include "coupler/acceleration/accelerator.hpp"

namespace strake {

/// Interface quasi-Newton. With a matrix J that maps a change of the residual to a change of H as far as it
/// is known from earlier windows (zero for IQN-ILS), and the secants ΔR = [r_k − r_(k−1) …] and ΔH = [H(x_k)
/// − H(x_(k−1)) …]
///   α = argmin |ΔR α + r_k|,   x_(k+1) = H(x_k) − J r_k + (ΔH − J ΔR) α
/// A column that brings too little that is new is left out, newest first, which also removes what an earlier
/// window contradicts. IQN-ILS and IQN-IMVJ differ in what a window leaves to the next.
class QuasiNewton : public Accelerator {
 public:
  explicit QuasiNewton(const AcceleratorParameters&);

 protected:
  void learn(const Eigen::VectorXd& residual, const Eigen::VectorXd& image) override;
  Eigen::VectorXd iterate(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) override;
  std::vector<Eigen::Index> sizes(Eigen::Index whole) const;  // of the blocks
  /// Weights w_b = 1 / Σ_k |r_b^k| over the iterations of this window. With them the remaining residual
  /// counts alike in every field, whatever its unit.
  Eigen::VectorXd weights() const;
  double weighted_norm(const Eigen::VectorXd&) const;
  /// Whether columns of this window may mislead, see IqnIls.
  bool careful() const { return state_.careful > 0; }
  /// own_filter: of the columns of this window.
  LeastSquares factorise(double own_filter) const;
  const AcceleratorParameters parameters_;

 private:
  void weigh(const Eigen::VectorXd& residual);
};

/// Interface quasi-Newton with an inverse Jacobian from least squares (Degroote, Bathe & Vierendeels 2009).
/// The columns of a window are reused in the next ones.
///
/// H has kinks where a pressure comes to zero, since water cannot pull. Columns from the other side of a kink
/// mislead. The sign is a step after which the residual is larger than the window's first, and larger than
/// any linear map could make it. Columns of earlier windows are then removed. In as many windows as would be
/// reused
///   none are reused;
///   only columns that are far from the newer ones are used beside them;
///   half of the unexplained residual r_k + ΔR α is added: in an unknown direction whose added mass is
///   μ times its own mass the full step would be μ times too long.
class IqnIls : public QuasiNewton {
 public:
  using QuasiNewton::QuasiNewton;
  void start_window() override;

 protected:
  void learn(const Eigen::VectorXd& residual, const Eigen::VectorXd& image) override;
};

/// Interface quasi-Newton with an inverse Jacobian that is carried from window to window (multi-vector
/// Jacobian). Sources: Bogaers, Kok, Reddy & Franz 2014; Lindner, Mehl, Scheufele & Uekermann 2015. J maps a
/// change of the residual to a change of H; at its end a window's secants correct J by the smallest change:
///   J_(n+1) = J_n + (ΔH − J_n ΔR) ΔR⁺
/// J is stored as L Zᵀ, to which a window adds its columns. At more than `max_columns` it is replaced by its
/// truncated singular-value decomposition with half as many at most (RS-SVD of Scheufele & Mehl 2017). So
/// memory and work per column stay O(columns·n).
class IqnImvj : public QuasiNewton {
 public:
  using QuasiNewton::QuasiNewton;
  void start_window() override;
};

}  // namespace strake
