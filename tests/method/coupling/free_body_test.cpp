#include "coupler/coupling/scheme.hpp"
#include "structure/body/mass.hpp"
#include "structure/participant.hpp"
#include "structure/rigid/rigid.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

namespace strake {
namespace {

using Eigen::Vector3d;

/// Water as an added mass on every loaded point of a body, f_k = −m_k a_k in all directions.
class ClingingWater : public models::Model<Points> {  // state: velocity of the points
 public:
  ClingingWater(const InterfaceMesh& body, Eigen::VectorXd mass, const Points& velocity)
      : mass_(std::move(mass)) {
    InterfaceMesh mesh = body;
    mesh.name = "fluid";
    begin(std::move(mesh), velocity);
  }
  double kinetic() const { return 0.5 * (now_.colwise().squaredNorm() * mass_).value(); }

 private:
  Advanced step(const Window& window, const Input& input) override {
    const Points velocity = find(input.samples.front().fields, "velocity")->value;
    const Points force = -(velocity - now_) * mass_.asDiagonal() / window.dt;
    now_ = velocity;
    Advanced advanced;
    advanced.output = {{"force", "N", true, force}};
    return advanced;
  }
  Eigen::VectorXd mass_;
};

structure::Parameters wedge() {
  structure::Parameters p;
  p.kind = "rigid";
  p.shape.kind = structure::ShapeKind::wedge;
  p.shape.corner = structure::wedge_polygon({.deadrise = M_PI / 6, .width = 0.5, .height = 0.3});
  p.surface_spacing = 0.02;
  p.body.mass = 20;
  p.gravity = {0, -9.81, 0};
  p.velocity = {0, -3, 0};
  return p;
}

struct Result {
  double mean_iterations = 0;
  int unconverged = 0;
  double fall = 0, angle = 0;  // [m], [deg]
  double energy_error = 0;     // of body and water, less the work of gravity, over the energy at the start
  double work_gap = 0;
};

/// A fall of 0.1 s with `ratio` times the body's mass in water on its surface. `aside`: all of it is on the
/// right.
Result fall(double ratio, const std::string& kind, bool aside) {
  structure::Parameters p = wedge();
  p.free.x = p.free.y = p.free.angle = true;
  auto owned = std::make_unique<structure::Rigid>(p);
  const structure::Rigid& body = *owned;
  structure::StructureParticipant dry(std::move(owned), p, CommonKeys{}, {});
  Eigen::VectorXd mass(dry.mesh().position.cols());
  for (Eigen::Index k = 0; k < mass.size(); ++k) mass[k] = !aside || dry.mesh().position(0, k) > 0.1 ? 1 : 0;
  mass *= ratio * p.body.mass / mass.sum();
  ClingingWater water(dry.mesh(), mass, body.velocity());

  SchemeParameters parameters;
  parameters.convergence = {1e-8, 1e-14, Measure::increment, 1, 50, Unconverged::accept};
  parameters.accelerator.kind = kind;
  Scheme scheme(water, dry, nearest_neighbour(dry.mesh(), water.mesh()), parameters);
  const Vector3d centre = structure::mass_of(p).centre;
  const auto energy = [&] {
    return body.energy().kinetic + water.kinetic() -
           p.body.mass * p.gravity.dot(body.displacement_at(centre));
  };
  const double start = energy();
  Result run;
  constexpr int windows = 200;
  const double dt = 0.1 / windows;
  for (int w = 0; w < windows; ++w) {
    const WindowReport report = scheme.advance({w * dt, dt});
    scheme.commit(false);
    run.mean_iterations += static_cast<double>(report.iterations) / windows;
    run.unconverged += report.converged ? 0 : 1;
    run.energy_error = std::max(run.energy_error, std::abs(energy() / start - 1));
    run.work_gap = std::max(run.work_gap, report.work.gap());
  }
  run.fall = body.displacement_at(centre).y();
  run.angle = body.monitor().at("body.angle");
  return run;
}

// Water that clings evenly to a symmetric wedge makes it slower to fall: y'' = −g m / (m + m_a).
TEST(FreeBody, FallsWithTheMassOfBodyAndWaterHoweverLightItIs) {
  for (const double ratio : {0.5, 2.0, 10.0})
    for (const char* kind : {"iqn-ils", "aitken"}) {
      const Result run = fall(ratio, kind, false);
      const double exact = -3 * 0.1 - 0.5 * 9.81 / (1 + ratio) * 0.01;
      fmt::print("m_a/m {:4}  {:7}  mean iterations {:.2f}  fall {:+.1e}  energy {:.1e}\n", ratio, kind,
                 run.mean_iterations, run.fall / exact - 1, run.energy_error);
      EXPECT_EQ(run.unconverged, 0);
      EXPECT_LT(run.mean_iterations, 4);
      EXPECT_NEAR(run.fall / exact, 1, 1e-7);  // the tolerance of the iteration
      EXPECT_NEAR(run.angle, 0, 1e-6);
      EXPECT_LT(run.energy_error, 1e-6);
      EXPECT_LT(run.work_gap, 1e-12);
    }
}

TEST(FreeBody, TurnsUnderWaterOnOneSideAndKeepsTheEnergyOfBoth) {
  for (const double ratio : {0.5, 10.0}) {
    const Result run = fall(ratio, "iqn-ils", true);
    fmt::print("m_a/m {:4}  aside    mean iterations {:.2f}  angle {:.3f} deg  energy {:.1e}\n", ratio,
               run.mean_iterations, run.angle, run.energy_error);
    EXPECT_EQ(run.unconverged, 0);
    EXPECT_LT(run.mean_iterations, 8);  // three motions, of which the first window learns
    EXPECT_GT(std::abs(run.angle), 0.3);
    EXPECT_LT(run.energy_error, 1e-5);  // turning points: Δx is not ½(v + v')Δt, of second order in Δt
    EXPECT_LT(run.work_gap, 1e-12);
  }
}

}  // namespace
}  // namespace strake
