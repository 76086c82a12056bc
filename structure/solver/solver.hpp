#pragma once

#include "proto/error.hpp"
#include "proto/interface.hpp"
#include "proto/interpolation.hpp"
#include "structure/material/stress.hpp"

#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake::structure {

struct Energy {
  double kinetic = 0, strain = 0,
         external = 0,  // [J] per metre of depth in 2-D; external: work done on the body so far
      released = 0;     // strain energy that went with broken bonds
};

/// The fluid's load over a window.
class Load {
 public:
  Load() = default;
  explicit Load(std::vector<Sample> samples, Interpolation = Interpolation::linear);
  /// Force on the interface points at a time, 3×n [N]. A single sample is the window mean and applies to the
  /// whole window. Zero if there is none.
  Points at(double time, Eigen::Index n_points) const;
  /// Its mean over a step, which keeps the impulse.
  Points mean(double begin, double end, Eigen::Index n_points) const;

 private:
  Interpolation interpolation_ = Interpolation::linear;
  std::vector<Sample> samples_;
};

/// What a discretisation makes of a body, for comparison with the shape and with other discretisations.
struct Properties {
  double mass = 0;                                   // [kg], per metre of depth in 2-D
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // [m] of gravity
  double inertia = 0;                                // [kg m²] about z through the centre
  std::vector<double> frequencies;                   // [Hz] the lowest, dry; empty: it has none
  std::string step;                                  // stable step, as text: "1.2e-06 s", "any"
};

/// A step that the solver cannot take, while a shorter one may do. It stands somewhere inside the step then,
/// until `restore`.
class StepFailed : public Error {
 public:
  using Error::Error;
};

/// One structure method. All that changes in time sits in one struct that save/restore copy.
class Solver {
 public:
  virtual ~Solver() = default;
  virtual const InterfaceMesh& interface() const = 0;
  virtual void advance(double t, double dt, const Load&) = 0;  // may throw StepFailed
  virtual Points displacement() const = 0;                     // 3×n [m] on interface()
  virtual Points velocity() const = 0;                         // 3×n [m/s] on interface()
  /// True when the fluid must follow `velocity` as well (explicit particles, rho_inf < 1): sent beside
  /// displacement.
  virtual bool sends_velocity() const { return true; }
  /// True if no load changes its motion, and this is not that of a constant speed: Description::prescribed.
  virtual bool prescribed() const { return false; }
  virtual double stable_dt() const { return std::numeric_limits<double>::infinity(); }  // [s] if explicit
  virtual Energy energy() const = 0;
  /// True if `external` contains all work, so that energies balance.
  virtual bool follows_work() const { return true; }
  virtual int steps() const = 0;  // own steps so far
  /// Displacement [m] and velocity [m/s] of the material point that was at X.
  virtual Eigen::Vector3d displacement_at(const Eigen::Vector3d& X) const = 0;
  virtual Eigen::Vector3d velocity_at(const Eigen::Vector3d& X) const = 0;
  /// Whether it computes stress. Probes of stress are left out where it does not.
  virtual bool has_stress() const { return false; }
  /// Cauchy stress there. Default: Error(case_file), "has no stress".
  virtual Stress stress_at(const Eigen::Vector3d& X) const;
  virtual void save() = 0;  // in memory
  virtual void restore() = 0;
  virtual void write(Archive&) const = 0;  // checkpoint of the saved (committed) state
  virtual void read(const Archive&) = 0;
  virtual Frame frame() const = 0;
  virtual std::vector<std::string> lines() const = 0;  // what it understood: headline first
  /// Displacement of X by the supports [m], the reference of a deflection. Default: that of
  /// structure.velocity.
  virtual std::optional<Eigen::Vector3d> support_displacement(const Eigen::Vector3d& /*X*/) const {
    return std::nullopt;
  }
  /// Named scalars of its own for history.csv, and their values now.
  virtual std::vector<Column> columns() const { return {}; }
  virtual std::map<std::string, double> monitor() const { return {}; }
  /// structure.analysis = static: equilibrium under the case's own load. Default: Error(case_file), "not
  /// available".
  virtual void solve_static();
  /// structure.analysis = modal: the lowest `count` natural frequencies [Hz], ascending. Default as above.
  virtual std::vector<double> frequencies(int count);
  /// Default: nothing, mass 0.
  virtual Properties properties() { return {}; }
};

}  // namespace strake::structure
