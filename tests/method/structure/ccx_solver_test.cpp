// structure.solver = "ccx": CalculiX window by window from its restart files, and once for a whole run.
#include "proto/error.hpp"
#include "structure/body/surface.hpp"
#include "structure/ccx/stepwise.hpp"
#include "structure/ccx/whole_history.hpp"
#include "structure/fem/fem.hpp"
#include "tests/method/structure/calculix.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace strake::structure {
namespace {

const Eigen::Vector3d middle = {0, 0.012, 0};
constexpr double dt = 2e-5;  // [s]

/// plate_entry's plate, one cell through the thickness.
Parameters plate(CalculixCalls calls) {
  Parameters p = entering_plate();
  p.kind = "ccx";
  p.fem.refinement = 0;
  p.surface_spacing = 0.02;
  p.ccx.calls = calls;
  p.window = dt;
  p.output_every = 3 * dt;
  p.probes = {{.name = "mid", .of = "structure", .at = middle, .quantity = "deflection", .diameter = 0}};
  return p;
}

/// A pressure on the lower face, stronger in the middle, that rises and falls.
Points force(const Parameters& p, int window) {
  const InterfaceMesh mesh = surface(p);
  const Eigen::VectorXd size = point_sizes(mesh);
  Points value = Points::Zero(3, mesh.position.cols());
  for (Eigen::Index i = 0; i < value.cols(); ++i)
    if (mesh.position(1, i) < middle.y() + 1e-9)
      value(1, i) = 4e6 * std::sin(0.3 * window) * std::cos(5 * mesh.position(0, i)) * size(i);
  return value;
}

void advance(Solver& solver, const Parameters& p, int window) {
  const double t = window * dt;
  solver.advance(t, dt, Load({{.time = t + dt, .fields = {{"force", "N", true, force(p, window)}}}}));
}

/// How far two motions of the interface are apart, supports' motion aside, relative to the second.
double gap(const Solver& one, const Solver& other, const Parameters& p, double time) {
  const Points rigid = (p.velocity * time).replicate(1, one.displacement().cols());
  return (one.displacement() - other.displacement()).norm() / (other.displacement() - rigid).norm();
}

std::unique_ptr<ccx::Stepwise> stepwise(const Parameters& p) {
  return std::make_unique<ccx::Stepwise>(p, fem::model(p, p.probes));
}

TEST(CalculixSolver, GoesFromWindowToWindowAsFiniteElementsDo) {
  STRAKE_NEEDS_CALCULIX();
  const Parameters p = plate(CalculixCalls::window);
  const auto solver = stepwise(p);
  const auto fem = fem::make_solver(p);
  constexpr int n = 10;
  const double before = solver->energy().kinetic + solver->energy().strain;
  for (int w = 0; w < n; ++w) {
    advance(*solver, p, w);
    advance(*fem, p, w);
  }
  EXPECT_LT(gap(*solver, *fem, p, n * dt), 0.01);
  RecordProperty("gap", std::to_string(gap(*solver, *fem, p, n * dt)));
  EXPECT_NEAR(solver->displacement_at(middle).y(), fem->displacement_at(middle).y(), 1e-6);
  EXPECT_NEAR(solver->energy().kinetic, fem->energy().kinetic, 5e-3 * fem->energy().kinetic);
  const Energy e = solver->energy();
  EXPECT_NEAR(e.kinetic + e.strain - before, e.external, 0.01 * e.strain);
  EXPECT_NEAR(e.strain, fem->energy().strain, 0.01 * e.strain);
  const Frame frame = solver->frame();
  EXPECT_EQ(frame.position.cols(), frame.point_data.back().value.cols());
  EXPECT_GT(frame.point_data.back().value.maxCoeff(), 1e6) << "von Mises";
  EXPECT_LT(frame.cells.maxCoeff(), frame.position.cols());
}

TEST(CalculixSolver, TakesAWindowAgainFromTheSameBits) {
  STRAKE_NEEDS_CALCULIX();
  const Parameters p = plate(CalculixCalls::window);
  const auto solver = stepwise(p);
  advance(*solver, p, 0);
  solver->save();
  Archive kept;
  solver->write(kept);
  advance(*solver, p, 1);
  const Points once = solver->displacement();
  solver->restore();
  advance(*solver, p, 4);
  EXPECT_NE(solver->displacement(), once);
  solver->restore();
  advance(*solver, p, 1);
  EXPECT_EQ(solver->displacement(), once);
  const auto resumed = stepwise(p);
  resumed->read(kept);
  advance(*resumed, p, 1);
  EXPECT_EQ(resumed->displacement(), once);
  EXPECT_EQ(resumed->velocity(), solver->velocity());
  EXPECT_EQ(resumed->energy().external, solver->energy().external);
}

TEST(CalculixSolver, ComputesAWholeRecordInOneCall) {
  STRAKE_NEEDS_CALCULIX();
  Parameters p = plate(CalculixCalls::once);
  constexpr int n = 12;
  p.end_time = n * dt;
  InterfaceRecord record = ccx::no_load(p);
  ASSERT_EQ(record.windows.size(), n);
  for (int w = 0; w < n; ++w) record.force[static_cast<std::size_t>(w)] = force(p, w);
  ccx::WholeHistory once(p, fem::model(p, p.probes), record);
  const auto fem = fem::make_solver(p);
  double most = 0;
  for (int w = 0; w < n; ++w) {
    advance(once, p, w);
    advance(*fem, p, w);
    if (w > 2) most = std::max(most, gap(once, *fem, p, (w + 1) * dt));
  }
  EXPECT_LT(most, 0.01);
  RecordProperty("gap", std::to_string(most));
  EXPECT_NEAR(once.frame().time, n * dt, 1e-9 * dt);
  EXPECT_GT(once.frame().point_data.back().value.maxCoeff(), 1e6) << "von Mises";

  // Between the record's window ends, and after a resume.
  once.save();
  Archive kept;
  once.write(kept);
  ccx::WholeHistory resumed(p, fem::model(p, p.probes), record);
  resumed.read(kept);
  EXPECT_EQ(resumed.displacement(), once.displacement());
  // Another load than the record's is refused.
  ccx::WholeHistory other(p, fem::model(p, p.probes), record);
  const Sample sample = {.time = dt, .fields = {{"force", "N", true, force(p, 5)}}};
  EXPECT_THROW(other.advance(0, dt, Load({sample})), Error) << "the load of window 5 in window 0";
}

TEST(CalculixSolver, FindsEquilibriumAndFrequenciesAsFiniteElementsDo) {
  STRAKE_NEEDS_CALCULIX();
  Parameters p = plate(CalculixCalls::window);
  p.analysis = Analysis::statics;
  p.fem.refinement = 1;
  p.load = {.kind = LoadKind::traction, .value = {0, -1e5, 0}, .face = "top", .at = {}, .ramp = 0};
  const auto solver = stepwise(p);
  const auto fem = fem::make_solver(p);
  solver->solve_static();
  fem->solve_static();
  EXPECT_LT(gap(*solver, *fem, p, 0), 0.01);
  const std::vector<double> ours = fem->frequencies(3), theirs = solver->frequencies(3);
  ASSERT_EQ(theirs.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(theirs[i], ours[i], 0.01 * ours[i]);
}

TEST(CalculixSolver, QuotesAProgramThatFailsAndKeepsItsFiles) {
  STRAKE_NEEDS_CALCULIX();
  const TemporaryFolder folder;
  Parameters p = plate(CalculixCalls::window);
  p.run_folder = folder.path();
  const auto solver = stepwise(p);
  const Points absurd = 1e12 * force(p, 4);
  try {
    solver->advance(0, dt, Load({{.time = dt, .fields = {{"force", "N", true, absurd}}}}));
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::solver_fault);
    EXPECT_NE(error.problem().find("*ERROR"), std::string::npos) << to_text(error);
    EXPECT_NE(error.fix().find((folder.path() / "ccx").string()), std::string::npos) << to_text(error);
  }
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "ccx" / "deck.inp"));
}

}  // namespace
}  // namespace strake::structure
