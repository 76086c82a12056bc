#include "proto/interpolation.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "proto/error.hpp"

namespace strake {
namespace {

using Eigen::MatrixXd;

const MatrixXd& value_of(const Sample& sample, const std::string& quantity) {
  static const MatrixXd none;
  const Field* field = find(sample.fields, quantity);
  return field ? field->value : none;
}

}  // namespace

Interpolation interpolation_kind(const std::string& name) {
  if (name == "constant") return Interpolation::constant;
  if (name == "linear") return Interpolation::linear;
  if (name == "quadratic") return Interpolation::quadratic;
  throw Error(ExitCode::case_file, "coupling.surface.interpolation",
              fmt::format("\"{}\" is no interpolation", name), "constant, linear or quadratic");
}

MatrixXd value_at(const std::vector<Sample>& samples, const std::string& quantity, double time,
                  Interpolation kind) {
  if (samples.empty()) return {};
  const auto after =
      std::find_if(samples.begin(), samples.end(), [&](const Sample& sample) { return sample.time >= time; });
  if (after == samples.end()) return value_of(samples.back(), quantity);
  const MatrixXd& b = value_of(*after, quantity);
  if (after == samples.begin() || kind == Interpolation::constant) return b;
  const Sample& before = *(after - 1);
  const MatrixXd& a = value_of(before, quantity);
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
    if (kind == Interpolation::quadratic)  // Simpson's rule is exact for it
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
