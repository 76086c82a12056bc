#include "proto/interpolation.hpp"

#include "proto/error.hpp"
#include "proto/motion.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake {
namespace {

using Eigen::MatrixXd;

const Values& value_of(const Sample& sample, const std::string& quantity) {
  static const Values none;
  const Field* field = find(sample.fields, quantity);
  return field ? field->value : none;
}

// The spline is linear in its samples: f(t) = Σ_k w_k f_k. Here w_k is the spline through 1 at sample k and 0
// at the others. On the interval [t_a, t_b] of length h, with s = (t − t_a)/h and its slopes m at both ends:
//   (1 + 2s)(1 − s)² f_a + s(1 − s)² h m_a + s²(3 − 2s) f_b − s²(1 − s) h m_b
MatrixXd spline_at(const std::vector<Sample>& samples, std::size_t after, const std::string& quantity,
                   double time) {
  std::vector<double> times, one(samples.size(), 0.0);
  for (const Sample& sample : samples) times.push_back(sample.time);
  const std::size_t a = after - 1, b = after;
  const double h = times[b] - times[a], s = (time - times[a]) / h, r = 1 - s;
  const Values& last = value_of(samples[b], quantity);
  MatrixXd value = last;  // differences to it: a value much larger than its changes loses no digits
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k == b) continue;
    one[k] = 1;
    const std::vector<double> slope = spline_slopes(times, one);
    one[k] = 0;
    const double weight = (k == a ? (1 + 2 * s) * r * r : 0) + s * r * h * (r * slope[a] - s * slope[b]);
    value += weight * (value_of(samples[k], quantity) - last);
  }
  return value;
}

}  // namespace

int degree_of(const std::string& name, const std::string& key, const std::vector<std::string>& more) {
  std::vector<std::string> names = {"constant", "linear", "quadratic"};
  names.insert(names.end(), more.begin(), more.end());
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw Error(ExitCode::case_file, key, fmt::format("\"{}\" is not among its words", name),
                fmt::format("one of {}", joined(names)));
  return static_cast<int>(found - names.begin());
}

Interpolation interpolation_kind(const std::string& name) {
  return static_cast<Interpolation>(degree_of(name, "coupling.surface.interpolation", {"b-spline"}));
}

MatrixXd value_at(const std::vector<Sample>& samples, const std::string& quantity, double time,
                  Interpolation kind) {
  if (samples.empty()) return {};
  const auto after =
      std::find_if(samples.begin(), samples.end(), [&](const Sample& sample) { return sample.time >= time; });
  if (after == samples.end()) return value_of(samples.back(), quantity);
  if (kind == Interpolation::b_spline && samples.size() > 2 && after != samples.begin())
    return spline_at(samples, static_cast<std::size_t>(after - samples.begin()), quantity, time);
  const Values& b = value_of(*after, quantity);
  if (after == samples.begin() || kind == Interpolation::constant) return b;
  const Sample& before = *(after - 1);
  const Values& a = value_of(before, quantity);
  const double s = (time - before.time) / (after->time - before.time);
  MatrixXd value = (1 - s) * a + s * b;
  // Newton's form: + (t − t_a)(t − t_b) f[t_a, t_b, t_c], c the sample before a, or else the one after b.
  const bool earlier = samples.begin() + 1 < after, later = after + 1 < samples.end();
  if (kind == Interpolation::linear || (!earlier && !later)) return value;
  const Sample& third = earlier ? *(after - 2) : *(after + 1);
  const MatrixXd slope = (b - a) / (after->time - before.time);
  const MatrixXd other = (value_of(third, quantity) - b) / (third.time - after->time);
  value += (time - before.time) * (time - after->time) / (third.time - before.time) * (other - slope);
  return value;
}

MatrixXd mean_over(const std::vector<Sample>& samples, const std::string& quantity, double begin, double end,
                   Interpolation kind) {
  if (samples.size() < 2 || !(end > begin)) return value_at(samples, quantity, end, kind);
  std::vector<double> knots = {begin};
  for (const Sample& sample : samples)
    if (sample.time > begin && sample.time < end) knots.push_back(sample.time);
  knots.push_back(end);
  MatrixXd sum;
  for (std::size_t k = 1; k < knots.size(); ++k) {
    const double a = knots[k - 1], b = knots[k];
    MatrixXd mean = value_at(samples, quantity, 0.5 * (a + b), kind);
    if (kind >= Interpolation::quadratic)  // Simpson's rule is exact for both
      mean =
          2.0 / 3 * mean + (value_at(samples, quantity, a, kind) + value_at(samples, quantity, b, kind)) / 6;
    mean *= (b - a) / (end - begin);
    if (k == 1)
      sum = std::move(mean);
    else
      sum += mean;
  }
  return sum;
}

}  // namespace strake
