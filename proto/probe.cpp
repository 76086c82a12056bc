#include "proto/probe.hpp"

#include "proto/error.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace strake {
namespace {

// cases/VALIDATION.md, "Definitions"
constexpr double impulse_time = 300e-6;    // [s] length of the impulse's window
constexpr double mean_time = 50e-6;        // [s] length of the sliding mean
constexpr double fall = 0.8;               // a peak is one once |q| is below this share of it
constexpr double least_first_peak = 0.05;  // of the largest |q|
// Largest difference of two times that are taken as equal. Times are sums of many steps: 1e-12 s is far above
// their round-off (1e-14 s after 30 ms in steps of 2 µs) and far below any step.
constexpr double time_slack = 1e-12;  // [s]

/// Share of a step that lies before `end` [s].
double part_before(double t0, double t1, double end) {
  return std::clamp(end, t0, t1) - t0;
}

bool counts_beside(const ProbeRecord::Peak& peak, const ProbeRecord::Peak& largest) {
  return std::abs(peak.value) >= least_first_peak * std::abs(largest.value);
}

}  // namespace

ProbeRecord ProbeRecord::waiting_for_contact() {
  ProbeRecord record;
  record.waits_ = true;
  return record;
}

void ProbeRecord::add(double t0, double t1, double q) {
  assert(t1 >= t0);
  if (!seen_ || std::abs(q) > std::abs(peak_.value)) peak_ = {t1, q};
  window_min_ = window_seen_ ? std::min(window_min_, q) : q;
  window_max_ = window_seen_ ? std::max(window_max_, q) : q;
  window_sum_ += q * (t1 - t0);
  window_time_ += t1 - t0;
  window_seen_ = seen_ = true;
  last_ = {t0, t1, q};
  if (measures()) measure(measured_, last_);
}

void ProbeRecord::contact(double t) {
  if (contact_known_) return;
  contact_known_ = true;
  contact_ = t;
  measured_ = {};
  measured_.begun = true;
  measured_.begin = t;
  if (seen_ && last_.t1 > t) measure(measured_, last_);  // contact was found in the step just recorded
}

/// First peak and impulse, one step further. Of a step that began before contact the later part counts.
void ProbeRecord::measure(Measured& m, const Step& whole) {
  if (!m.begun) {
    m.begun = true;
    m.begin = whole.t0;
  }
  const Step step{std::max(whole.t0, m.begin), whole.t1, whole.q};
  if (step.t1 < step.t0) return;

  if (std::abs(step.q) > std::abs(m.running.value)) {
    m.running = {step.t1, step.q};
    m.fallen = false;
    std::erase_if(m.candidates, [&](const Peak& p) { return !counts_beside(p, m.running); });
  } else if (!m.fallen && std::abs(step.q) < fall * std::abs(m.running.value)) {
    m.candidates.push_back(m.running);
    m.fallen = true;
  }

  m.impulse += step.q * (step.t1 - step.t0);
  m.impulse_300 += step.q * part_before(step.t0, step.t1, m.begin + impulse_time);
  measure_means(m, step);
}

/// Largest |mean| over 50 µs. q is constant in each step, so the mean over [s - 50 µs, s] is piecewise linear
/// in s: its extremes stand where one end of that window meets the end of a step.
void ProbeRecord::measure_means(Measured& m, const Step& step) {
  m.recent.push_back(step);
  const auto mean_until = [&](double end) {
    const double begin = end - mean_time;
    double sum = 0;
    for (const Step& s : m.recent) sum += s.q * std::max(0.0, std::min(s.t1, end) - std::max(s.t0, begin));
    const double mean = sum / mean_time;
    if (!m.has_mean_peak || std::abs(mean) > std::abs(m.mean_peak)) m.mean_peak = mean;
    m.has_mean_peak = true;
  };
  for (const Step& s : m.recent) {
    const double end = s.t0 + mean_time;
    if (end > step.t0 && end <= step.t1) mean_until(end);
  }
  if (step.t1 - m.begin >= mean_time - time_slack) mean_until(step.t1);
  const double reach = step.t1 - mean_time;
  m.recent.erase(m.recent.begin(),
                 std::find_if(m.recent.begin(), m.recent.end(), [&](const Step& s) { return s.t1 > reach; }));
}

std::optional<ProbeRecord::Peak> ProbeRecord::first_peak() const {
  for (const Peak& candidate : measured_.candidates)
    if (counts_beside(candidate, measured_.running)) return candidate;
  return {};
}

std::optional<ProbeRecord::Peak> ProbeRecord::peak() const {
  return seen_ ? std::optional<Peak>(peak_) : std::nullopt;
}

std::optional<double> ProbeRecord::impulse() const {
  const bool over = measured_.begun && last_.t1 >= measured_.begin + impulse_time - time_slack;
  return over ? std::optional<double>(measured_.impulse_300) : std::nullopt;
}

double ProbeRecord::running_impulse() const {
  return measured_.impulse;
}

std::optional<double> ProbeRecord::mean_peak_50us() const {
  return measured_.has_mean_peak ? std::optional<double>(measured_.mean_peak) : std::nullopt;
}

double ProbeRecord::last() const {
  return last_.q;
}

void ProbeRecord::new_window() {
  window_seen_ = false;
  window_sum_ = window_time_ = 0;
}

double ProbeRecord::window_min() const {
  return window_seen_ ? window_min_ : last_.q;
}
double ProbeRecord::window_max() const {
  return window_seen_ ? window_max_ : last_.q;
}
double ProbeRecord::window_mean() const {
  return window_time_ > 0 ? window_sum_ / window_time_ : last_.q;
}

void ProbeRecord::report(const std::string& name, std::map<std::string, double>& monitor) const {
  const auto put_peak = [&](const std::string& what, const std::optional<Peak>& value) {
    if (!value) return;
    monitor[name + ":" + what] = value->value;
    if (value->value != 0) monitor[name + ":time_of_" + what] = value->time;  // zeros have no peak
  };
  put_peak("first_peak", first_peak());
  put_peak("peak", peak());
  if (const auto value = impulse()) monitor[name + ":impulse"] = *value;
  if (measures()) monitor[name + ":running_impulse"] = running_impulse();
  if (const auto value = mean_peak_50us()) monitor[name + ":mean_peak_50us"] = *value;
  if (seen_) monitor[name + ":final"] = last();
  if (contact_known_) monitor[name + ":contact"] = contact_;
}

std::array<double*, 16> ProbeRecord::numbers() {
  Measured& m = measured_;
  return {&contact_,    &last_.t0,    &last_.t1,      &last_.q,        &peak_.time,      &peak_.value,
          &m.begin,     &m.impulse,   &m.impulse_300, &m.running.time, &m.running.value, &m.mean_peak,
          &window_min_, &window_max_, &window_sum_,   &window_time_};
}

std::array<bool*, 7> ProbeRecord::flags() {
  Measured& m = measured_;
  return {&waits_, &contact_known_, &seen_, &m.begun, &m.fallen, &m.has_mean_peak, &window_seen_};
}

void ProbeRecord::save(const std::string& name, Archive& archive) const {
  ProbeRecord copy = *this;
  Eigen::VectorXd values(16);
  for (Eigen::Index i = 0; i < 16; ++i) values[i] = *copy.numbers().at(static_cast<std::size_t>(i));
  archive.real[name + ".values"] = values;
  for (const bool* flag : copy.flags()) archive.integer[name + ".flags"].push_back(*flag);
  const Measured& m = measured_;
  Eigen::MatrixXd candidates(2, static_cast<Eigen::Index>(m.candidates.size()));
  for (Eigen::Index i = 0; i < candidates.cols(); ++i) {
    const Peak& peak = m.candidates[static_cast<std::size_t>(i)];
    candidates.col(i) << peak.time, peak.value;
  }
  Eigen::MatrixXd recent(3, static_cast<Eigen::Index>(m.recent.size()));
  for (Eigen::Index i = 0; i < recent.cols(); ++i) {
    const Step& step = m.recent[static_cast<std::size_t>(i)];
    recent.col(i) << step.t0, step.t1, step.q;
  }
  archive.real[name + ".candidates"] = candidates;
  archive.real[name + ".recent"] = recent;
}

void ProbeRecord::load(const std::string& name, const Archive& archive) {
  const auto values = archive.real.find(name + ".values"),
             candidates = archive.real.find(name + ".candidates"),
             recent = archive.real.find(name + ".recent");
  const auto flags = archive.integer.find(name + ".flags");
  const auto none = archive.real.end();
  if (values == none || candidates == none || recent == none || flags == archive.integer.end() ||
      values->second.size() != 16 || flags->second.size() != 7 || candidates->second.rows() != 2 ||
      recent->second.rows() != 3)
    throw Error(ExitCode::case_file, "checkpoint", "holds no record of the probe " + name,
                "resume with the case that wrote the checkpoint");
  measured_ = {};
  for (std::size_t i = 0; i < 16; ++i) *numbers().at(i) = values->second(static_cast<Eigen::Index>(i));
  for (std::size_t i = 0; i < 7; ++i) *this->flags().at(i) = flags->second[i] != 0;
  for (const auto& peak : candidates->second.colwise()) measured_.candidates.push_back({peak[0], peak[1]});
  for (const auto& step : recent->second.colwise()) measured_.recent.push_back({step[0], step[1], step[2]});
}

}  // namespace strake
