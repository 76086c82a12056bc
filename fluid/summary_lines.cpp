#include "fluid/boundary/fill.hpp"
#include "fluid/participant.hpp"
#include "fluid/pressure_solver/poisson_solver.hpp"
#include "fluid/simulation/simulation.hpp"
#include "fluid/size.hpp"
#include "fluid/viscosity/turbulence.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake::fluid {
namespace {

/// 2.5e+06 → "2.5e6".
std::string short_power(double value) {
  std::string text = fmt::format("{:.1e}", value);
  const auto e = text.find('e') + 1;
  if (text[e] == '+') text.erase(e, 1);
  const auto digit = e + (text[e] == '-' ? 1 : 0);
  if (text[digit] == '0' && digit + 1 < text.size()) text.erase(digit, 1);
  return text;
}

const char* name(Gradient gradient) {
  switch (gradient) {
    case Gradient::min_pressure:
      return "min-pressure";
    case Gradient::corrected:
      return "corrected";
    case Gradient::least_squares:
      return "least-squares";
    case Gradient::pairwise:
      break;
  }
  return "pairwise";
}

std::string source_text(const Scheme& s) {
  if (s.source == Source::divergence) return "divergence";
  const std::string strength =
      s.tau > 0 ? fmt::format("tau {:g} s", s.tau) : fmt::format("gamma {:g}", s.gamma);
  return "mixed, " + strength;
}

std::string surface_text(const Scheme& s) {
  if (s.gradient == Gradient::least_squares) return "by the first moment of its neighbours";
  const char* second = s.second == SecondCriterion::arc ? " and open arc" : "";
  return fmt::format("n < {:g} n0{}", s.beta, second);
}

std::string turbulence_text(const Scheme& s) {
  if (s.turbulence == Turbulence::none) return "no sub-particle stress";
  const double cs = SpsModel{.c_nu = s.c_nu, .c_eps = s.c_eps}.cs();
  if (s.turbulence == Turbulence::k) return fmt::format("SPS by an equation for k, C_s {:.4g}", cs);
  return fmt::format("SPS C_s {:.4g}", cs);
}

/// Describes the solver of the pressure equation, and why it is chosen.
std::string pressure_text(const Parameters& p, double dt) {
  const PressureChoice choice =
      p.dimension == 2 ? expected_pressure_solver<2>(p, dt) : expected_pressure_solver<3>(p, dt);
  return fmt::format("pressure by {}, to |b - A p| <= {:g} |b|", choice.text(), p.scheme.pressure_tolerance);
}

std::string absorbing_text(const Parameters& p) {
  if (!p.absorbing_bottom && !p.absorbing_sides) return "";
  return fmt::format("   no echo from the {}", !p.absorbing_sides    ? "bottom"
                                               : !p.absorbing_bottom ? "sides"
                                                                     : "bottom and sides");
}

/// Lists the limits of the time step (fluid/THEORY.md (F63)).
std::string limits_text(const Parameters& p, double speed) {
  const double l0 = p.spacing;
  std::string text = "limits of the step";
  if (speed > 0) text += fmt::format("   speed {:.2g} s", p.scheme.cfl * l0 / speed);
  if (p.gravity.norm() > 0)
    text += fmt::format("   gravity {:.2g} s   column {:.2g} s", 0.25 * std::sqrt(l0 / p.gravity.norm()),
                        column_step(p));
  if (p.kinematic_viscosity > 0) text += fmt::format("   viscosity {:.2g} s", viscous_limit(p, 0));
  if (std::isfinite(acoustic_step(p))) text += fmt::format("   sound {:.2g} s", acoustic_step(p));
  return text;
}

/// Returns the first step, with the water at rest. It is the case's largest unless a limit is shorter.
double first_step(const Parameters& p, double window, double speed) {
  const double l0 = p.spacing;
  double first = std::min({p.scheme.time_step, window, column_step(p), acoustic_step(p)});
  if (speed > 0) first = std::min(first, p.scheme.cfl * l0 / speed);
  if (p.kinematic_viscosity > 0) first = std::min(first, viscous_limit(p, 0));
  return window / std::max(1.0, std::ceil(window / first - 1e-9));
}

std::string step_text(const Parameters& p, double window, double step) {
  std::string text = fmt::format("time step {:.4g} s, {:.0f} in a window of {:g} s, more as the flow demands",
                                 step, window / step, window);
  if (std::isfinite(p.sound_speed))
    text += fmt::format(
        "   c {:g} m/s{}   c dt/l0 {:.2g}", p.sound_speed,
        std::isfinite(p.sound_depth) ? fmt::format(" down to {:g} m, no echo from there", p.sound_depth) : "",
        p.sound_speed * step / p.spacing);
  else
    text += "   incompressible: the pressure of a flat impact grows as 1/dt";
  return text;
}

std::string ranks_text(const Parameters& p, bool threads_given, std::int64_t water, std::int64_t layers) {
  const RankSize size = rank_size(p, water, layers);
  constexpr double mebi = 1024.0 * 1024.0;
  return fmt::format(
      "{} ranks of {} thread{}{}: each {} particles of water, at most {:.0f} % more as ghosts, "
      "about {:.0f} MiB, the first one {:.0f} MiB while it counts voids",
      p.ranks, p.threads, p.threads == 1 ? "" : "s", threads_given ? "" : " on one machine",
      grouped(water / p.ranks), 100 * size.ghosts, size.bytes / mebi, size.bytes_of_first / mebi);
}

}  // namespace

std::vector<std::string> describe(const Parameters& p, const CommonKeys& common, double speed,
                                  double length) {
  std::int64_t water = 0, wall = 0, dummies = 0;
  double own = 0;  // largest speed that the case gives the water [m/s]
  const auto count = [&](const auto& state) {
    for (const Kind kind : state.kind) ++(kind == Kind::fluid ? water : kind == Kind::wall ? wall : dummies);
    if (!p.initial_velocity.is_zero()) own = state.velocity.colwise().norm().maxCoeff();
  };
  if (p.dimension == 2)
    count(fill<2>(p));
  else
    count(fill<3>(p));

  std::string headline = fmt::format("MPS{} {}-D, {}   {} water particles   l0 {:g} mm",
                                     p.scheme.turbulence == Turbulence::none ? "" : "-LES", p.dimension,
                                     common.preset, grouped(water), 1e3 * p.spacing);
  constexpr double at_rest = 1e-9;  // [m/s] round-off of a table's spline is 1e-27
  const bool enters = speed > at_rest && length > 0;
  if (enters && p.kinematic_viscosity > 0)
    headline += "   Re " + short_power(speed * length / p.kinematic_viscosity);
  if (enters && p.gravity.norm() > 0)
    headline += fmt::format("   Fr {:.1f}", speed / std::sqrt(p.gravity.norm() * length));

  const Scheme& s = p.scheme;
  if (own > 0) headline += fmt::format("   starts with up to {:.3g} m/s", own);
  const double fastest = std::max(speed, own), step = first_step(p, common.window, fastest);
  std::vector<std::string> lines = {
      headline,
      fmt::format("tank of {} wall particles with {} rows ({}) behind them{}", grouped(wall), dummy_rows(s),
                  grouped(dummies), absorbing_text(p)),
      step_text(p, common.window, step),
      limits_text(p, fastest),
      fmt::format("source {}   gradient {}   surface {}   {}", source_text(s), name(s.gradient),
                  surface_text(s), turbulence_text(s)),
      pressure_text(p, step)};
  if (p.ranks > 1) lines.push_back(ranks_text(p, common.threads_given, water, wall + dummies));
  return lines;
}

}  // namespace strake::fluid
