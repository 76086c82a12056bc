#pragma once

#include "coupler/attachments/fmu/fmu_connections.hpp"
#include "coupler/attachments/fmu/fmu_instance.hpp"
#include "coupler/attachments/fmu/fmu_package.hpp"
#include "proto/participant.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// What a user does about an FMU that cannot take its state back.
inline constexpr const char* explicit_coupling =
    "explicit coupling: coupling.surface.converged.max_iterations = 1 and coupling.surface.predictor = "
    "\"constant\"";

/// An attachment that an FMU computes: it gets the motion of a few points and gives the force on them.
///
/// A window from t_n to t_(n+1) = t_n + Δt is two steps with the inputs' mean over it,
///   u = (u_n + u_(n+1)) / 2
///   fmi3DoStep(t_n, Δt/2), read y;  fmi3DoStep(t_n + Δt/2, Δt/2)
/// and the force is y. It is the midpoint rule: the mean over the window with an error of the order of Δt²,
/// also where an output depends on an input at the same instant. Outputs at both ends of the window would
/// have to be read after inputs were set, which FMI 3.0 forbids in step mode (section 4.2.1).
class FmuAttachment final : public Participant {
 public:
  /// setup: its partner's mesh holds the points, its partner's fields their motion at `start_time` [s].
  FmuAttachment(FmuParameters, const Setup&, double start_time = 0);

  /// Whether a window can be computed again. Without it coupling has to be explicit.
  bool can_rewind() const { return model_.can_get_and_set_state; }

  const InterfaceMesh& mesh() const override { return points_; }
  const Description& description() const override { return description_; }
  void start(const Window&, const Input&) override;
  Advanced finish() override;
  void rewind() override;
  void commit(bool write_output) override;
  void checkpoint(const std::filesystem::path& folder) override;
  void resume(const std::filesystem::path& folder) override;

 private:
  /// What changes in time beside the FMU's own state.
  struct State {
    double time = 0;                                // [s]
    Eigen::MatrixXd displacement, velocity, force;  // 3×k, at `time`; mean over the window that ends then
  };
  void describe();
  void add_unconnected(std::vector<std::string>& lines) const;
  void check_step(double step);
  std::vector<double> mean_inputs(const State& from, const State& to) const;
  Eigen::MatrixXd force_in(const std::vector<double>& values) const;

  FmuParameters parameters_;
  InterfaceMesh points_;
  FmuPackage package_;
  ModelDescription model_;
  FmuConnections connections_;
  FmuInstance instance_;
  Description description_;
  std::vector<fmi3ValueReference> set_, read_;  // connected inputs; connected outputs, then other ones
  std::vector<std::string> columns_;            // of `read_`
  std::vector<double> outputs_;                 // of `read_`, at the end of the last window
  State committed_, last_;
  Window window_;       // under way
  bool ahead_ = false;  // a window was computed since the last commit
  std::optional<FmuDiscarded> discarded_;
  std::optional<double> only_step_;  // [s] of an FMU that knows one length of its steps
  double seconds_ = 0;               // of wall clock
};

}  // namespace strake
