#include "coupler/coupling/convergence.hpp"

#include "coupler/coupling/exchange.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake {
namespace {

// The acceleration is a five-hundredth of gravity.
constexpr double residual_acceleration = 0.02;                         // [m/s²]
constexpr double largest_residual = 1e-6, round_off_residual = 1e-11;  // [fluid.spacing]

}  // namespace

double default_residual(double spacing, double window) {
  return std::clamp(residual_acceleration * window * window, round_off_residual * spacing,
                    largest_residual * spacing);
}

FieldResidual judge(const Column& quantity, double residual, double scale, const Limits& limits,
                    double first) {
  if (first < 0) first = residual;
  return {quantity.name, quantity.unit, residual,
          std::max({limits.absolute, limits.relative * scale, limits.residual_relative * first})};
}

void refuse_non_finite(const std::vector<FieldResidual>& fields, const Place& place) {
  for (const FieldResidual& field : fields)
    if (!std::isfinite(field.residual) || !std::isfinite(field.threshold))
      throw Error(ExitCode::solver_fault, place.text(),
                  fmt::format("the residual of {} is {} {}, its threshold {}: the iteration has blown up",
                              field.quantity, field.residual, field.unit, field.threshold),
                  "a smaller coupling window, or more iterations per window");
}

}  // namespace strake
