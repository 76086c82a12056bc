#pragma once

#include "proto/participant.hpp"

#include <memory>
#include <string>
#include <vector>

namespace strake {

/// The force of one line at one point, and what it reports.
struct LineForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // [N] on the structure; 2-D: per metre of depth
  double tension = 0;                               // [N] at the structure; negative: it presses
};

/// A law for the force on one point from its place and its velocity, without a memory.
class LineLaw {
 public:
  virtual ~LineLaw() = default;
  /// line: which one, from 0. position [m] and velocity [m/s] of its upper end.
  virtual LineForce at(std::size_t line, const Eigen::Vector3d& position,
                       const Eigen::Vector3d& velocity) const = 0;
};

/// An attachment that the coupler computes itself: a line at each point, all of one law.
///
/// It sends the mean of the forces at both ends of the window,
///   f = (g(x_n, v_n) + g(x_(n+1), v_(n+1))) / 2,
/// the trapezoidal rule: second order in the window, and a linear spring gives back the work that it took.
class LocalAttachment final : public Participant {
 public:
  /// name: of the attachment. points: where it is attached, reference configuration. initial: their motion at
  /// the start, 3×k.
  LocalAttachment(std::string name, InterfaceMesh points, const Motion& initial, std::unique_ptr<LineLaw>);

  const InterfaceMesh& mesh() const override { return points_; }
  const Description& description() const override { return description_; }
  void start(const Window&, const Input&) override;
  Advanced finish() override;
  void rewind() override {}
  void commit(bool write_output) override;
  void checkpoint(const std::filesystem::path& folder) override;
  void resume(const std::filesystem::path& folder) override;

 private:
  Eigen::MatrixXd forces(const Values& displacement, const Values& velocity);
  std::string column(std::size_t line, const std::string& what) const;
  std::string name_;
  InterfaceMesh points_;
  std::unique_ptr<LineLaw> law_;
  Description description_;
  Eigen::MatrixXd committed_, last_;  // 3×k [N] at the last commit and at the end of the window under way
  std::vector<double> tension_;       // [N] at the end of the window under way
};

/// A straight spring with a damper, from each point to an anchor that stays where it is.
struct SpringParameters {
  std::vector<Eigen::Vector3d> anchor;  // [m] one for each point
  double stiffness = 0;                 // [N/m]; 2-D: per metre of depth, [N/m²]
  double damping = 0;                   // [N s/m]; 2-D: [N s/m²]
  std::vector<double> length;           // [m] without a force, one for each point
  bool slack = false;                   // a rope: it pulls, and never presses
};

/// T = k (L − L_0) + c dL/dt along the line from the point to its anchor.
class SpringLaw final : public LineLaw {
 public:
  explicit SpringLaw(SpringParameters parameters) : p_(std::move(parameters)) {}
  LineForce at(std::size_t line, const Eigen::Vector3d& position,
               const Eigen::Vector3d& velocity) const override;

 private:
  SpringParameters p_;
};

}  // namespace strake
