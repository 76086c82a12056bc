// A block on several ranks, for ranks.py: mpirun -n N fem_ranks REFINEMENT FOLDER [all]. The first rank
// writes FOLDER/N.json, and values of the whole body as numbers of 64 bits. Without "all" it solves one
// linear system alone.

#include "proto/error.hpp"
#include "proto/peak_memory.hpp"
#include "proto/ranks/mpi_communicator.hpp"
#include "structure/fem/solver.hpp"
#include "tests/structure/body/boxes.hpp"
#include "tests/structure/notched_cells.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <string>

namespace strake::structure::fem {
namespace {

/// A block that is clamped at one end and pressed from above, of two materials.
Parameters block(int refinement) {
  Parameters p;
  p.dimension = 3;
  p.shape.kind = ShapeKind::solid;
  SolidBox left = box("left", {0, 0, 0}, {0.12, 0.2, 0.345});
  left.support[0] = Support::clamped;
  SolidBox right = box("right", {0.12, 0, 0}, {0.24, 0.2, 0.345});
  right.material.young = 7e10;
  right.material.density = 2700;
  p.solid = solid_of_boxes(3, {left, right});
  p.load = {.kind = LoadKind::traction, .value = {0, -1e7, 2e6}, .face = "top", .at = {}, .ramp = 0};
  p.fem.refinement = refinement;
  p.fem.cell_size = std::ldexp(0.12, -refinement);
  p.fem.linear_solver = LinearMethod::cg_amg;
  p.surface_spacing = 0.05;
  return p;
}

/// Writes what the first rank has.
class Report {
 public:
  Report(const std::string& folder, Communicator& ranks)
      : ranks_(ranks), base_(fmt::format("{}/{}", folder, ranks.size())) {}
  void add(const std::string& name, double value) {
    text_ += fmt::format(",\n \"{}\": {:.17g}", name, value);
  }
  void add(const std::string& name, const Eigen::MatrixXd& value) {
    if (ranks_.rank() > 0) return;
    std::ofstream(base_ + "." + name, std::ios::binary)
        .write(reinterpret_cast<const char*>(value.data()),
               static_cast<std::streamsize>(static_cast<std::size_t>(value.size()) * sizeof(double)));
  }
  void text(const std::string& name, const std::string& value) {
    std::string escaped;
    for (const char c : value) escaped += c == '"' ? '\'' : c;
    text_ += fmt::format(",\n \"{}\": \"{}\"", name, escaped);
  }
  void write() {
    if (ranks_.rank() == 0)
      std::ofstream(base_ + ".json") << fmt::format("{{\"ranks\": {}{}}}\n", ranks_.size(), text_);
  }

 private:
  Communicator& ranks_;
  std::string base_, text_;
};

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// One linear system of the stiffness: its iterations.
void solve_system(const Parameters& p, Communicator& ranks, Report& report) {
  const Discretisation<3> d(p.solid, 2, p.fem.refinement, p.fem.cell_size, &ranks);
  const Mesh<3>& mesh = d.mesh();
  const Matrix K = Assembly<3>(mesh, p.solid.parts).tangent(Eigen::VectorXd::Zero(mesh.n_unknowns()));
  LinearSolver solver(LinearMethod::cg_amg,
                      {.per_node = 3, .rigid_motions = rigid_motions(mesh), .division = mesh.division});
  const double begin = seconds();
  solver.factorise(K, mesh.fixed);
  const double ready = seconds();
  const Eigen::VectorXd x = solver.solve(d.case_force(p.load), 1e-12);
  report.add("unknowns", static_cast<double>(mesh.division.size(mesh.n_unknowns())));
  report.add("iterations", solver.iterations());
  report.add("seconds.multigrid", ready - begin);
  report.add("seconds.solve", seconds() - ready);
  report.add("solution", mesh.division.whole(x));
}

/// Statics, frequencies, and some steps, with all that a run asks of a solver.
void solve_body(const Parameters& p, Communicator& ranks, Report& report) {
  const double begin = seconds();
  FemSolver<3> solver(p, &ranks);
  report.add("seconds.set_up", seconds() - begin);
  report.add("f1", solver.frequencies(1).front());
  const double start = seconds();
  solver.solve_static();
  report.add("seconds.static", seconds() - start);
  report.add("static", solver.division().whole(solver.unknowns()));
  report.add("strain", solver.energy().strain);
  const Eigen::Vector3d at(0.2, 0.1, 0.05);
  report.add("stress", von_mises(solver.stress_at(at)));
  solver.set_unknowns(0 * solver.unknowns(), 0 * solver.unknowns());
  for (int i = 0; i < 3; ++i) solver.advance(1e-5 * i, 1e-5, Load());
  report.add("steps", solver.division().whole(solver.unknowns()));
  report.add("surface", solver.displacement());
  report.add("kinetic", solver.energy().kinetic);
  report.add("external", solver.energy().external);
  solver.save();
  Archive archive;
  solver.write(archive);
  report.add("archive", archive.real.at("fem.velocity"));
  const Frame frame = solver.frame();
  report.add("frame_position", frame.position);
  report.add("frame_cells", frame.cells.cast<double>());
  for (const Frame::Array& array : frame.point_data) report.add("frame_" + array.name, array.value);
}

/// A frame that is free to heave, damping, gravity, and a scheme that remembers accelerations.
void solve_free_frame(Parameters p, Communicator& ranks, Report& report) {
  p.free.y = true;
  p.body.lumped_mass = 40;
  p.gravity = {0.5, -9.81, 0};
  p.damping = {.mass = 30, .stiffness = 1e-6};
  p.fem.rho_infinity = 0.7;
  p.initial.value = {0.1, 0.2, -0.3};
  p.load.ramp = 1e-4;
  FemSolver<3> solver(p, &ranks);
  for (int i = 0; i < 3; ++i) solver.advance(2e-5 * i, 2e-5, Load());
  report.add("free_steps", solver.division().whole(solver.unknowns()));
  report.add("free_surface", solver.displacement());
  report.add("free_velocity", solver.velocity());
  report.add("free_momentum", solver.momentum());
  report.add("free_kinetic", solver.energy().kinetic);
  report.add("free_external", solver.energy().external);
}

/// A strip in the plane, of rubber that is held by a wall which turns.
void solve_turned_strip(Communicator& ranks, Report& report) {
  Parameters p;
  p.shape.kind = ShapeKind::solid;
  SolidBox strip = box("strip", {0, 0, 0}, {0.3, 0.1, 0},
                       {.model = MaterialModel::neo_hookean, .density = 1000, .young = 1e6, .poisson = 0.4});
  strip.support[0] = Support::clamped;
  p.solid = solid_of_boxes(2, {strip});
  p.gravity = {0, -9.81, 0};
  p.fem.refinement = 3;
  p.fem.linear_solver = LinearMethod::cg_amg;
  p.motion = MotionTable(
      {0, 0.01, 0.02}, {MotionColumn::absent, MotionColumn::place, MotionColumn::absent, MotionColumn::place},
      {{{}, {0, 0.001, 0.004}, {}, {0, 0.02, 0.08}}});
  FemSolver<2> solver(p, &ranks);
  for (int i = 0; i < 3; ++i) solver.advance(1e-3 * i, 1e-3, Load());
  report.add("turned_steps", solver.division().whole(solver.unknowns()));
  report.add("turned_tip", solver.displacement_at({0.3, 0.05, 0}).y());
  report.add("turned_tip_velocity", solver.velocity_at({0.29, 0.05, 0}).y());
  report.add("turned_strain", solver.energy().strain);
  report.add("turned_external", solver.energy().external);
  const Frame frame = solver.frame();
  for (const Frame::Array& array : frame.point_data) report.add("turned_frame_" + array.name, array.value);
}

/// A notched bar that is pulled apart, faster above than below, until it parts. It is resumed from a
/// checkpoint on the way.
void solve_failing_bar(Communicator& ranks, Report& report) {
  Parameters p = notched_cells(FailureCriterion::max_principal, 8);
  p.fem.degree = 1;
  p.fem.linear_solver = LinearMethod::direct;
  p.fem.tolerance = 1e-12;
  FemSolver<2> solver(p, &ranks), resumed(p, &ranks);
  Eigen::VectorXd v = Eigen::VectorXd::Zero(solver.mesh().n_unknowns());
  for (int i = 0; i < solver.mesh().n_nodes(); ++i)
    v(2 * i) = pulled(0.5 + 5 * solver.mesh().node(1, i), solver.mesh().node(0, i));
  solver.set_unknowns(0 * v, v);
  const std::string name = "failing";
  const auto go_on = [](FemSolver<2>& body, int from, int to) {
    for (int k = from; k < to; ++k) body.advance(k * 5e-6, 5e-6, Load());
  };
  constexpr int saved = 14, end = 24;  // steps: while cells soften, and once it has parted
  go_on(solver, 0, saved);
  solver.save();
  Archive archive;
  solver.write(archive);
  for (const char* part : {"onset", "peak", "end", "failure", "displacement"})
    report.add(name + "_" + part, archive.real.at(std::string("fem.") + part));
  go_on(solver, saved, end);
  resumed.read(archive);
  go_on(resumed, saved, end);
  report.add(name + ".resumed_off", solver.division().norm(solver.unknowns() - resumed.unknowns()) +
                                        std::abs(solver.energy().released - resumed.energy().released));
  report.add(name + "_steps", solver.division().whole(solver.unknowns()));
  for (const auto& [key, value] : solver.monitor())
    if (key.starts_with("failure")) report.add(name + "." + key, value);
  report.add(name + ".strain", solver.energy().strain);
  const Frame frame = solver.frame();
  for (const Frame::Array& array : frame.point_data) report.add(name + "_frame_" + array.name, array.value);
}

/// A plate of solid shells with a stiffener across it, whose joint is no shell; large deformation.
void solve_shells(LinearMethod method, Communicator& ranks, Report& report) {
  SolidBox plate = box("plate", {0, 0, 0}, {1, 0.02, 1}), bar = box("bar", {0.49, 0.02, 0}, {0.51, 0.1, 1});
  plate.support[0] = Support::clamped;
  plate.support[5] = Support::clamped;
  Parameters p;
  p.dimension = 3;
  p.shape.kind = ShapeKind::solid;
  p.solid = solid_of_boxes(3, {plate, bar});
  p.surface_spacing = 0.2;
  p.load = {.kind = LoadKind::traction, .value = {0, -2e5, 0}, .face = "bottom", .at = {}, .ramp = 0};
  p.fem = {.degree = 1, .refinement = 0, .cell_size = 0.1, .strain = StrainField::solid_shell};
  p.fem.linear_solver = method;
  FemSolver<3> solver(p, &ranks);
  const std::string name = method == LinearMethod::direct ? "shells" : "shells_cg";
  solver.solve_static();
  report.add(name + "_static", solver.division().whole(solver.unknowns()));
  report.add(name + ".strain", solver.energy().strain);
  report.add(name + ".stress", von_mises(solver.stress_at({0.2, 0.02, 0.3})));
  if (method != LinearMethod::direct) return;
  report.add(name + ".f1", solver.frequencies(1).front());
  solver.set_unknowns(0 * solver.unknowns(), 0 * solver.unknowns());
  for (int i = 0; i < 3; ++i) solver.advance(1e-4 * i, 1e-4, Load());
  report.add(name + "_steps", solver.division().whole(solver.unknowns()));
  report.add(name + ".kinetic", solver.energy().kinetic);
  const Frame frame = solver.frame();
  for (const Frame::Array& array : frame.point_data) report.add(name + "_frame_" + array.name, array.value);
  for (const std::string& line : solver.lines())
    if (line.starts_with("solid shells")) report.text(name + ".line", line);
}

/// What the ranks refuse together: cells too wide for a crack, and a body of shells that has a block.
void refuse(Communicator& ranks, Report& report) {
  const auto said = [&](const auto& make) -> std::string {
    try {
      make();
    } catch (const Error& error) {
      return error.problem();
    }
    return "nothing";
  };
  Parameters bar = notched_cells(FailureCriterion::max_principal, 8);
  bar.failure.fracture_energy = 1e-3;
  report.text("wide", said([&] { FemSolver<2>(bar, &ranks); }));
  Parameters p = block(0);
  p.fem.strain = StrainField::solid_shell;
  p.fem.degree = 1;
  report.text("no_shell", said([&] { FemSolver<3>(p, &ranks); }));
}

void run(int refinement, bool whole, const std::string& folder, Communicator& ranks) {
  Report report(folder, ranks);
  const Parameters p = block(refinement);
  solve_system(p, ranks, report);
  if (whole) solve_body(p, ranks, report);
  if (whole) solve_free_frame(p, ranks, report);
  if (whole) solve_turned_strip(ranks, report);
  if (whole) solve_failing_bar(ranks, report);
  for (const LinearMethod method : {LinearMethod::direct, LinearMethod::cg_amg})
    if (whole) solve_shells(method, ranks, report);
  if (whole) refuse(ranks, report);
  report.add("bytes", ranks.max(peak_memory()));
  report.write();
}

}  // namespace
}  // namespace strake::structure::fem

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int code = 0;
  try {
    strake::MpiCommunicator ranks(MPI_COMM_WORLD);
    strake::structure::fem::run(std::stoi(argv[1]), argc > 3, argv[2], ranks);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  MPI_Finalize();
  return code;
}
