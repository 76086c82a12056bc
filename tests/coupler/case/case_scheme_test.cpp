// Defaults of the coupling scheme.

#include "coupler/case/case_scheme.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace {

TEST(DefaultResidual, GoesWithTheSquareOfTheWindow) {
  // A body's acceleration is the displacement over Δt²: 0.02 m/s² at any window.
  EXPECT_DOUBLE_EQ(default_residual(0.01, 1e-4), 2e-10);
  EXPECT_DOUBLE_EQ(default_residual(0.01, 1e-5), 2e-12);
  EXPECT_DOUBLE_EQ(default_residual(0.01, 1e-2), 1e-8) << "never looser than 1e-6 l0";
  EXPECT_DOUBLE_EQ(default_residual(0.01, 1e-9), 1e-13) << "never below round-off";
}

}  // namespace
}  // namespace strake
