#pragma once

#include "proto/interface.hpp"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// Advanced::monitor of the fluid: the contact of a body that no probe watches [s].
inline constexpr const char* contact_of_body = "body:contact";

/// Results of one probe so far, updated at every solver step. It is a copyable value in the owner's State.
///
/// cases/VALIDATION.md, "Definitions": *first peak* = the running maximum M of |q| after contact, M >= 5 % of
/// the record's maximum, that |q| falls below 0.8 M before exceeding M. *impulse* = ∫ q dt over [t_c, t_c +
/// 300 µs]. Values keep their sign.
///
/// A record without contact detection (a probe on the structure) measures from its first step. One that waits
/// for contact (a pressure sensor) has no first peak, impulse or 50-µs mean before it.
class ProbeRecord {
 public:
  ProbeRecord() = default;
  static ProbeRecord waiting_for_contact();

  /// One step from t0 to t1 [s] with mean value q over it (pressure) or end value (motion). Steps are
  /// consecutive; t0 = t1 records a value at an instant (the state at t = 0).
  void add(double t0, double t1, double q);
  /// Sets the contact time t_c [s], the start of the step in which contact was found. It is called before or
  /// after that step's `add`. First peak, impulse and 50-µs mean then leave out what came before t_c. Later
  /// calls change nothing.
  void contact(double t);
  bool in_contact() const { return contact_known_; }

  struct Peak {
    double time = 0, value = 0;  // [s], [unit of q]
  };
  std::optional<Peak> first_peak() const;
  std::optional<Peak> peak() const;              // largest |q| of the whole record
  std::optional<double> impulse() const;         // over 300 µs after contact, once those are over
  double running_impulse() const;                // since contact, so far
  std::optional<double> mean_peak_50us() const;  // largest |mean over any 50 µs| after contact
  double last() const;
  /// Values since the last call of `new_window`.
  void new_window();
  double window_min() const, window_max() const, window_mean() const;

  /// "<name>:first_peak" … for Advanced::monitor; what is not known yet is left out.
  void report(const std::string& name, std::map<std::string, double>& monitor) const;
  void save(const std::string& name, Archive&) const;
  void load(const std::string& name, const Archive&);  // Error(case_file) if the archive has no such record

 private:
  struct Step {
    double t0 = 0, t1 = 0, q = 0;
  };
  /// All that starts anew at contact.
  struct Measured {
    bool begun = false;
    double begin = 0;              // [s] t_c, or the start of the record
    double impulse = 0;            // since `begin`
    double impulse_300 = 0;        // its share up to begin + 300 µs
    Peak running;                  // running maximum of |q|
    bool fallen = false;           // |q| has fallen below 0.8 of it
    std::vector<Peak> candidates;  // running maxima that |q| fell from, in time
    std::vector<Step> recent;      // steps that reach into the last 50 µs
    bool has_mean_peak = false;
    double mean_peak = 0;
  };
  bool measures() const { return !waits_ || contact_known_; }
  std::array<double*, 16> numbers();  // and flags, all but the lists: as a checkpoint has them
  std::array<bool*, 7> flags();
  static void measure(Measured&, const Step&);
  static void measure_means(Measured&, const Step&);

  bool waits_ = false, contact_known_ = false;
  double contact_ = 0;  // [s]
  bool seen_ = false;
  Step last_;
  Peak peak_;
  Measured measured_;
  bool window_seen_ = false;
  double window_min_ = 0, window_max_ = 0, window_sum_ = 0, window_time_ = 0;
};

}  // namespace strake
