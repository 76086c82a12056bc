#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/interface.hpp"

namespace strake {

/// What one probe has seen so far: a copyable value that lives in the owner's State, fed at every solver step.
///
/// VALIDATION A: *first peak* = the running maximum M of |q| after contact, M >= 5 % of the record's maximum, that |q|
/// falls below 0.8 M before exceeding M. *impulse* = ∫ q dt over [t_c, t_c + 300 µs]. Values keep their sign.
class ProbeRecord {
 public:
  /// One step from t0 to t1 [s] with mean value q over it (pressure) or end value (motion).
  void add(double t0, double t1, double q);
  /// Contact time t_c [s]: what came before is forgotten for first peak and impulse. Later calls change nothing.
  void contact(double t);
  bool in_contact() const;

  struct Peak {
    double time = 0, value = 0;
  };
  std::optional<Peak> first_peak() const;
  std::optional<Peak> peak() const;          // largest |q| of the record
  std::optional<double> impulse() const;     // over 300 µs after contact, once those are over
  double running_impulse() const;            // since contact, so far
  std::optional<double> mean_peak_50us() const;  // largest |mean over 50 µs| (sliding, of the steps)
  double last() const;
  /// Values since the last call of `new_window`.
  void new_window();
  double window_min() const, window_max() const, window_mean() const;

  /// "<name>:first_peak" … for Advanced::monitor.
  void report(const std::string& name, std::map<std::string, double>& monitor) const;
  void save(const std::string& name, Archive&) const;
  void load(const std::string& name, const Archive&);

 private:
  double contact_ = -1, last_ = 0, last_time_ = 0;
  std::vector<Peak> candidates_;     // peaks that fell to 0.8 of themselves, in time
  Peak running_, peak_;
  bool fallen_ = false;
  double impulse_ = 0, impulse_300_ = 0;
  bool impulse_done_ = false;
  std::vector<std::pair<double, double>> recent_;  // (dt, q) of the last 50 µs
  double mean_peak_ = 0;
  double window_min_ = 0, window_max_ = 0, window_sum_ = 0, window_time_ = 0;
  bool seen_ = false, window_seen_ = false;
};

}  // namespace strake
