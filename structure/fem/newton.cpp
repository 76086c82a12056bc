#include "structure/fem/newton.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace strake::structure::fem {
namespace {

constexpr double slow = 0.5;      // a correction that leaves more of the residual calls for a new tangent
constexpr int max_halvings = 10;  // of a step along the line

}  // namespace

NewtonResult solve(const Equilibrium& equilibrium, Eigen::VectorXd start, double tolerance,
                   int max_iterations) {
  NewtonResult result{.x = std::move(start)};
  bool fresh = false;  // the tangent was taken at the present x
  const RankDivision& division = equilibrium.division;
  Equilibrium::Residual here = equilibrium.residual(result.x);
  result.residual = division.norm(here.value);
  for (;; ++result.iterations) {
    result.wanted = std::max(tolerance * here.scale, here.floor);
    const bool finite = std::isfinite(result.residual);  // where forces overflow, so does what is wanted
    result.converged = finite && result.residual <= result.wanted;
    if (!finite || result.converged || result.iterations == max_iterations) return result;

    const Eigen::VectorXd step = equilibrium.correction(here.value);
    double part = 1;
    Eigen::VectorXd trial = result.x + step;
    Equilibrium::Residual there = equilibrium.residual(trial);
    double next = division.norm(there.value);
    // `!(a <= b)` is also true when a is not a number.
    const auto grows = [&] { return !(next <= result.residual); };
    if (grows() && next > there.floor && !fresh) {
      if (!equilibrium.refresh(result.x)) return result;
      fresh = result.refreshed = true;
      continue;
    }
    // The line search limits the work of the residual on the step, not the residual's size (Matthies & Strang
    // 1979). A straight step stretches a slender body that turns, and the next step takes this stretch back.
    // Meanwhile its residual grows by orders of magnitude, across the step.
    const double work = std::abs(division.dot(step, here.value));
    const auto works_more = [&] {
      return !(std::abs(division.dot(step, there.value)) <= work) || !std::isfinite(next);
    };
    for (int i = 0; i < max_halvings && grows() && works_more(); ++i) {
      part /= 2;
      trial = result.x + part * step;
      there = equilibrium.residual(trial);
      next = division.norm(there.value);
    }
    if (grows() && works_more()) return result;
    const bool halved = next <= slow * result.residual;
    result.x = std::move(trial);
    here = std::move(there);
    result.residual = next;
    fresh = false;
    if (!halved && next > std::max(tolerance * here.scale, here.floor)) {
      if (!equilibrium.refresh(result.x)) return result;
      fresh = result.refreshed = true;
    }
  }
}

}  // namespace strake::structure::fem
