#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

namespace strake {

/// Motion of a rigid frame at one time: of its origin, and its turn about the z axis, counter-clockwise.
struct RigidMotion {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();            // [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();                // [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();            // [m/s^2]
  double angle = 0, angular_velocity = 0, angular_acceleration = 0;  // [rad], [rad/s], [rad/s^2]
};

/// Content of one column of a motion table: a place (or angle), or its rate.
enum class MotionColumn { absent, place, rate };

/// A motion given at some times, twice continuously differentiable between them. Places are joined by the
/// cubic spline that is smooth across the second and the last but one knot too ("not a knot"). Rates are
/// joined by a monotone cubic (Fritsch & Carlson), so that a ramp between two constant speeds does not
/// overshoot, and integrated exactly; their place at the first time is 0. Beyond both ends it goes on with
/// the speed it has there.
class MotionTable {
 public:
  static constexpr int n_channels = 4;  // x, y, z, angle
  /// time: strictly increasing, at least two [s]. value: for each channel that is not absent, one number per
  /// time ([m], [rad], or per second). The reader checks what a file can get wrong.
  MotionTable(std::vector<double> time, std::array<MotionColumn, n_channels> kind,
              std::array<std::vector<double>, n_channels> value);

  RigidMotion at(double t) const;
  const std::vector<double>& times() const { return time_; }  // of its rows [s]
  double start() const { return time_.front(); }              // [s]
  double end() const { return time_.back(); }                 // [s]
  /// True if it gives a channel: 0 x, 1 y, 2 z, 3 angle. A channel that is not given stands still.
  bool gives(std::size_t channel) const { return channel_.at(channel).kind != MotionColumn::absent; }
  bool turns() const { return gives(3); }
  /// Largest speed |v| + |ω| reach from t = 0 to `until` [m/s], of the table's times and the middles between
  /// them: a piece has its largest rate at an end or, nearly, in its middle. reach: of the body from the
  /// origin, whose speed is |v| [m].
  double largest_speed(double until, double reach = 0) const;

 private:
  struct Channel {
    MotionColumn kind = MotionColumn::absent;
    std::vector<double> value, slope;  // at the knots
    std::vector<double> integral;      // of a rate, from the first knot
  };
  struct Jet {
    double place = 0, rate = 0, change = 0;
  };
  Jet evaluate(const Channel&, double t) const;

  std::vector<double> time_;
  std::array<Channel, n_channels> channel_;
};

/// Slopes of the C² cubic spline through the knots, "not a knot" at both ends; exact for cubics.
std::vector<double> spline_slopes(const std::vector<double>& x, const std::vector<double>& y);
/// Slopes of the monotone C¹ cubic through the knots.
std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace strake
