#pragma once

#include "fluid/diagnostics/measurements.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/simulation/simulation.hpp"
#include "fluid/window_motion.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/files/frame_writer.hpp"
#include "proto/participant.hpp"
#include "proto/ranks/ranked_frames.hpp"

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace strake::fluid {

/// Describes the fluid of a case, one line each; the first is the headline. speed, length: those of the body
/// that enters [m/s], [m]. With speed 0 nothing enters, and there are no Reynolds and Froude numbers.
std::vector<std::string> describe(const Parameters&, const CommonKeys&, double speed = 0, double length = 0);

/// Whether a probe is a pressure sensor, on the body or a wall; the others measure the water's places.
inline bool is_sensor(const ProbeKeys& probe) {
  return probe.quantity == "pressure";
}

/// Whether a probe reads the air under the body.
inline bool is_of_air(const ProbeKeys& probe) {
  return probe.quantity == "gap" || probe.quantity == "air_pressure";
}

/// Whether a probe reads the places of the water.
inline bool reads_water(const ProbeKeys& probe) {
  return !is_sensor(probe) && !is_of_air(probe);
}

/// The particle method as a participant of the coupling: motion in, force out. It makes the sub-steps and
/// keeps sensors, accounts and frames.
template <int dim>
class FluidParticipant final : public Participant {
 public:
  FluidParticipant(const Parameters&, const CommonKeys&, const Setup&, const Ranks& = {});

  const InterfaceMesh& mesh() const override { return simulation_.interface(); }
  const Description& description() const override { return description_; }
  void start(const Window&, const Input&) override;
  Advanced finish() override;
  void rewind() override;
  void commit(bool write_output) override;
  void checkpoint(const std::filesystem::path& folder) override;
  void resume(const std::filesystem::path& folder) override;
  void flush() override;

 private:
  std::vector<char> sensors_on_body() const;
  bool has_body() const { return mesh().position.cols() > 0; }
  void check_sensors() const;
  void check_air_probe(const ProbeKeys&) const;
  std::string air_line() const;
  std::vector<Column> columns() const;
  double longest_step(double t, double rest) const;
  void follow_probes(double t0, double t1);
  void choose_contact_search(const CommonKeys&);
  double contact_pressure() const;
  double pressure_or_place(const ProbeKeys&, const Vectors<dim>& position,
                           std::span<const std::int64_t> water) const;
  Vectors<dim> water_at_gauges() const;
  void count_voids_now();
  bool frame_due(const Window&) const;
  double volume() const;
  std::vector<std::int64_t> water_of(const State<dim>&) const;
  std::vector<std::int64_t> own_water() const;
  /// Whether this rank measures and writes what is of the whole fluid.
  bool is_first_rank() const {
    return !simulation_.ranks().several() || simulation_.ranks().communicator()->rank() == 0;
  }
  void report_sensors(std::map<std::string, double>& monitor) const;
  void report_accounts(std::map<std::string, double>& monitor) const;
  void report_water(std::map<std::string, double>& monitor) const;
  void report_air(std::map<std::string, double>& monitor) const;
  double momentum_scale() const;
  double body_width() const;  // [m] of the widest body along x; 0: there is none
  double momentum_gap() const;
  void report_ranks(std::map<std::string, double>& monitor) const;
  void write_first_frame();
  void write_frame();
  GuardScales guard_scales() const;
  void watch_step(double t1, double dt, double speed, WindowExtremes&) const;
  void watch_window(const Window&, const WindowExtremes&);
  void watch_accounts(std::map<std::string, double>& monitor);
  Frame frame() const;
  State<dim> read_checkpoint(const std::filesystem::path&, Archive&) const;

  Parameters parameters_;
  struct Bodies {
    std::vector<Eigen::Vector2d> sizes;  // [m] of each along x and z
    double volume;                       // [m²], in space [m³]: of all
  } bodies_;
  Simulation<dim> simulation_;
  /// How contact is found (cases/VALIDATION.md, "Definitions").
  struct ContactSearch {
    bool waits = false;       // the body comes from outside the water
    bool from_rest = false;   // it gets its speed later: V is that of the step, else that at t = 0
    bool whole_body = false;  // no probe finds contact: any point of the body does
  };
  /// Largest speeds at t = 0 [m/s], and what follows from them.
  struct StartSpeeds {
    double entry;  // of a body that starts outside the water, or gets by its table; 0: nothing enters
    double water;  // that the case gives the water; 0: it starts with the tank
    ContactSearch contact = {};
  };
  StartSpeeds start_speeds_;
  std::vector<char> on_body_;       // of each probe: whether it is a sensor that covers a point of the body
  double output_every_, end_time_;  // [s]
  double initial_volume_;           // of the water [m², m³ in 3-D]
  Description description_;
  struct Frames {
    std::optional<FrameWriter> of_one;     // rank
    std::optional<RankedFrames> of_ranks;  // of several
  };
  Frames frames_;
  Measurements measurements_;
  struct Progress {
    std::int64_t steps = 0;        // with those that were rewound
    double time = 0;               // [s] end of the window, the same number as the structure's
    bool has_first_frame = false;  // that at t = 0
  };
  Progress progress_;
  Guard guard_;
  struct Committed {
    typename Simulation<dim>::Snapshot fluid;
    Measurements measurements;
    Progress progress;  // its time is that of the frame: sums of steps drift
  };
  Committed committed_;

  bool sends_history_;

  // The last window, kept for `finish`.
  std::vector<Sample> history_;
  bool measures_water_ = false;
  Points force_;                                     // its mean force [N]
  double cfl_ = 0;                                   // largest
  int pressure_iterations_ = 0;                      // most in one step
  Eigen::Vector3d floor_ = Eigen::Vector3d::Zero();  // mean force on the tank floor [N]
};

}  // namespace strake::fluid
