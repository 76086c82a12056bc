#pragma once

#include "proto/interface.hpp"

#include <Eigen/Core>

#include <cmath>
#include <string>
#include <vector>

namespace strake {

enum class Measure {
  increment,  // relative to the window's displacement increment: a driven body's travel does not hide its
              // deflection
  value       // relative to the displacement itself, and the force must settle as well
};
enum class Unconverged {
  accept,  // keep the window, count it
  halve,   // request a smaller window: WindowReport::retry
  stop     // Error(solver_fault)
};

/// Limits below which a residual is small enough; a limit of zero is not tested.
struct Limits {
  double relative = 0;           // of the field's increment in the window, or of its value
  double absolute = 0;           // in the field's unit
  double residual_relative = 0;  // of the window's first residual
  bool any() const { return relative > 0 || absolute > 0 || residual_relative > 0; }
};

/// A field has settled when its residual, rms per point, is at most the largest of
///   absolute, relative · rms(increment or value), residual_relative · first residual of the window.
/// A window has converged when every measured field has settled.
///
/// Fields of the structure are always measured. Their residual is the structure's result less the motion that
/// the fluid was given. Fields of the fluid are measured if `load` has a limit, the measure is by value, or
/// the scheme is parallel. Their residual is the change since the last iteration. In a parallel scheme it is
/// the fluid's result less the load that the structure was given, since the structure may settle under a load
/// that is not the fluid's.
struct Convergence {
  double relative = 1e-4;
  double absolute = 1e-8;  // [m], or the unit of the structure's first field
  Measure measure = Measure::increment;
  int min_iterations = 1, max_iterations = 20;  // max 1: explicit coupling
  Unconverged then = Unconverged::accept;
  double residual_relative = 0;
  Limits load = {};  // of the fluid's fields; where they must settle, the two relative ones above at least
  double spacing =
      0;  // [m] of the fluid; where it is given, each window has its default residual as `absolute`
};

/// The residual that is always enough where the case gives none [m], (C17): a Δt² within bounds. spacing: l0
/// [m]; window: Δt [s].
double default_residual(double spacing, double window);

/// One field in one iteration.
struct FieldResidual {
  std::string quantity, unit;
  double residual = 0, threshold = 0;
  bool settled() const { return residual <= threshold; }
};

/// √(Σ |a_i|² / n) over the n columns.
template <class Derived>
double rms(const Eigen::MatrixBase<Derived>& a) {
  return a.cols() == 0 ? 0 : std::sqrt(a.squaredNorm() / static_cast<double>(a.cols()));
}

/// Compares a residual with its threshold. residual: rms of a field's change; scale: rms of the quantity to
/// which `relative` refers; first: residual of the window's first iteration. A negative `first` means that
/// this is the first iteration.
FieldResidual judge(const Column&, double residual, double scale, const Limits&, double first);

struct Place;
/// Throws Error(solver_fault) when a residual or its threshold is not finite: such a window must not count as
/// converged.
void refuse_non_finite(const std::vector<FieldResidual>&, const Place&);

}  // namespace strake
