#include "fluid/window_motion.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

namespace strake::fluid {

WindowMotion::WindowMotion(const Window& window, const std::vector<Sample>& samples,
                           const Points& displacement, const Points& velocity) {
  knots_.push_back({window.t, displacement, velocity});
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Field* x = find(samples[i].fields, "displacement");
    const Field* v = find(samples[i].fields, "velocity");
    if (!x || x->value.rows() != 3 || x->value.cols() != displacement.cols() ||
        (v && (v->value.rows() != 3 || v->value.cols() != displacement.cols())))
      throw Error(
          ExitCode::solver_fault, fmt::format("fluid, window at t = {:.9g} s", window.t),
          fmt::format("the motion it was sent does not fit its {} interface points", displacement.cols()));
    const Knot& last = knots_.back();
    Knot next{i + 1 == samples.size() ? window.t + window.dt : samples[i].time, x->value, {}};
    const double dt = next.time - last.time;
    if (dt <= 0) continue;
    next.velocity =
        v ? Points(v->value) : Points(2 / dt * (next.displacement - last.displacement) - last.velocity);
    knots_.push_back(std::move(next));
  }
}

// Interpolates the motion by Hermite's cubic:
//   x(s) = h00 x0 + h10 dt v0 + h01 x1 + h11 dt v1, s = (t − t0)/dt.
// With the velocity of constant acceleration at its end this is the parabola x0 + v0 τ + ½ a τ².
WindowMotion::Knot WindowMotion::at(double t) const {
  std::size_t k = 1;
  while (k + 1 < knots_.size() && knots_[k].time < t) ++k;
  if (knots_.size() == 1 || t == knots_.front().time)
    return {t, knots_.front().displacement, knots_.front().velocity};
  const Knot &a = knots_[k - 1], &b = knots_[k];
  if (t == b.time) return b;
  const double dt = b.time - a.time, s = (t - a.time) / dt, r = 1 - s;
  return {t,
          (1 + 2 * s) * r * r * a.displacement + s * r * r * dt * a.velocity +
              s * s * (3 - 2 * s) * b.displacement - s * s * r * dt * b.velocity,
          6 * s * r / dt * (b.displacement - a.displacement) + r * (1 - 3 * s) * a.velocity +
              s * (3 * s - 2) * b.velocity};
}

InterfaceMotion WindowMotion::step(double t0, double t1) const {
  const Knot begin = at(t0), end = at(t1);
  return {end.displacement, end.velocity, (end.velocity - begin.velocity) / (t1 - t0)};
}

}  // namespace strake::fluid
