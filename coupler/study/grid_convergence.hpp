#pragma once

#include "coupler/study/results.hpp"

#include <optional>
#include <string>
#include <vector>

namespace strake::study {

/// How a result behaves as the spacing or the step shrinks.
struct GridConvergence {
  std::string title, axis, probe, metric;
  std::vector<std::string> runs;  // names, coarse to fine
  std::vector<double> along;      // [m] or [s], coarse to fine
  std::vector<double> value;
  std::optional<double> order;         // observed on the three finest
  std::optional<double> extrapolated;  // to zero spacing
  std::optional<double> gci;           // relative, of the finest: 1.25 |e| / (r^p − 1)
  std::string remark;                  // "converges", "oscillates", "does not converge", "two values only"
};

/// Observed order p, extrapolated value and grid convergence index of the three finest of `value`, whose
/// spacings `along` descend in any ratios r21 = h2/h1, r32 = h3/h2 (1 the finest). With φ = φ0 + C h^p,
///   ε32/ε21 = r21^p (r32^p − 1)/(r21^p − 1),  ε32 = φ3 − φ2, ε21 = φ2 − φ1
///   φ0 = φ1 − ε21/(r21^p − 1),  GCI = 1.25 |ε21/φ1| / (r21^p − 1)
/// (Roache 1994, J. Fluids Eng. 116:405; the procedure of Celik et al. 2008, J. Fluids Eng. 130:078001).
/// Differences that alternate in sign have no such order; those that do not fall mean that the result does
/// not converge.
GridConvergence grid_convergence(std::vector<double> along, std::vector<double> value);

/// Every convergence that the plan requests, for each choice on the other axes.
std::vector<GridConvergence> judge_convergence(const Results&);

}  // namespace strake::study
