#pragma once

#include "coupler/quasi_newton.hpp"

namespace strake {

/// Interface quasi-Newton with an inverse Jacobian from least squares (Degroote, Bathe & Vierendeels 2009): a
/// window leaves its columns to the next ones.
class IqnIls : public QuasiNewton {
 public:
  using QuasiNewton::QuasiNewton;
  void start_window() override;
};

}  // namespace strake
