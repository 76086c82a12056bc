#pragma once

#include "coupler/acceleration/quasi_newton.hpp"

namespace strake {

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
