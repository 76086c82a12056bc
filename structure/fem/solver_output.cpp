#include "proto/error.hpp"
#include "structure/body/beam.hpp"
#include "structure/fem/element/solid_shell.hpp"
#include "structure/fem/mesh/joined_frame.hpp"
#include "structure/fem/solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

// Output of a finite-element solver: checkpoints, frames, the lines of a run, the description of the body.

namespace strake::structure::fem {
namespace {

/// The laws of the parts, and the configuration that a body with large motions refers to.
std::string law_and_frame(const Solid& solid) {
  return material_law(solid.parts) + (all_linear(solid.parts) ? "" : ", total Lagrangian");
}

/// What solid shells there are.
std::string shell_line(const Mesh<3>& mesh, int shells) {
  const Eigen::Index others = mesh.cell_division.size(mesh.n_cells()) - shells;
  return fmt::format("solid shells: {} cells, thin along their shortest edges, up to {:.3g} times longer",
                     shells, slenderness(mesh)) +
         (others > 0 ? fmt::format("; {} cells in joints have enhanced strains", others) : "");
}
std::string shell_line(const Mesh<2>&, int) {
  return "";
}

/// Names the solid shell where thin cells stand alone or two through the thickness; empty: they do not.
std::string advice(const Mesh<3>& mesh, bool shells) {
  constexpr double thin = 10;  // length over thickness
  if (shells) return "";
  const double slender = slenderness(mesh);
  if (slender < thin || has_core(mesh)) return "";
  return fmt::format(
      "cells are {:.3g} times longer than thick, one or two through the thickness: "
      "structure.fem.strain = \"solid_shell\" is made for such plates",
      slender);
}
std::string advice(const Mesh<2>&, bool) {
  return "";
}

}  // namespace

template <int dim>
void FemSolver<dim>::write(Archive& archive) const {
  archive.real["fem.displacement"] = division().whole(saved_.displacement);
  archive.real["fem.velocity"] = division().whole(saved_.velocity);
  archive.real["fem.acceleration"] = division().whole(saved_.acceleration);
  archive.real["fem.tangent_at"] = division().whole(saved_.tangent_at);
  archive.real["fem.scalars"] = Eigen::RowVector3d(saved_.time, saved_.external, saved_.tangent_dt);
  Eigen::Matrix<double, 3, 4> frame;
  frame << saved_.frame.displacement, saved_.frame.velocity, saved_.frame.acceleration, saved_.reaction;
  archive.real["fem.frame"] = frame;
  archive.integer["fem.steps"] = {saved_.steps};
  if (!failure_) return;
  const auto& damage = saved_.damage;
  archive.real["fem.onset"] = mesh().whole(damage.onset);
  archive.real["fem.peak"] = mesh().whole(damage.peak);
  archive.real["fem.end"] = mesh().whole(damage.end);
  archive.real["fem.failure"] = damage.record.table();
  archive.real["fem.released"] = Eigen::MatrixXd::Constant(1, 1, damage.released);
  archive.integer["fem.eroded"] = {damage.eroded};
}

template <int dim>
void FemSolver<dim>::read(const Archive& archive) {
  const auto vector = [&](const std::string& name, Eigen::Index size) -> Eigen::VectorXd {
    const auto found = archive.real.find(name);
    if (found == archive.real.end() || found->second.size() != size)
      throw Error(ExitCode::case_file, "structure checkpoint",
                  fmt::format("{} has {} values, this mesh has {}", name,
                              found == archive.real.end() ? 0 : found->second.size(), size),
                  "resume with the structure.plate and structure.fem keys of the run that wrote it");
    return found->second.reshaped();
  };
  const Eigen::Index n = division().size(mesh().n_unknowns());
  state_.displacement = division().part(vector("fem.displacement", n));
  state_.velocity = division().part(vector("fem.velocity", n));
  state_.acceleration = division().part(vector("fem.acceleration", n));
  state_.tangent_at = division().part(vector("fem.tangent_at", n));
  const Eigen::VectorXd scalars = vector("fem.scalars", 3);
  state_.time = scalars(0);
  state_.external = scalars(1);
  state_.tangent_dt = scalars(2);
  const Eigen::Matrix<double, 3, 4> frame = vector("fem.frame", 12).reshaped(3, 4);
  state_.frame = {.displacement = frame.col(0), .velocity = frame.col(1), .acceleration = frame.col(2)};
  const FrameState told = support_motion_.supports().prescribed(state_.time);
  state_.frame.angle = told.angle;
  state_.frame.angular_velocity = told.angular_velocity;
  state_.reaction = frame.col(3);
  state_.steps = static_cast<int>(archive.integer.at("fem.steps").at(0));
  if (failure_) {
    auto& damage = state_.damage;
    damage.onset = mesh().part_of_whole(vector("fem.onset", summary_.cells));
    damage.peak = mesh().part_of_whole(vector("fem.peak", summary_.cells));
    damage.end = mesh().part_of_whole(vector("fem.end", summary_.cells));
    damage.record = FailureRecord::from(archive.real.at("fem.failure"));
    damage.released = archive.real.at("fem.released")(0);
    damage.eroded = archive.integer.at("fem.eroded").at(0);
    assembly_.damage(failure_->integrity(damage));
  }
  saved_ = state_;
}

template <int dim>
Frame FemSolver<dim>::frame() const {
  const std::vector<int>& node = recovery_.node();
  const auto n = static_cast<Eigen::Index>(node.size());
  const auto on_points = [&](const Eigen::VectorXd& unknowns, const Eigen::Vector3d& rigid) {
    Points values = Points::Zero(3, n);
    for (Eigen::Index i = 0; i < n; ++i)
      values.col(i).head<dim>() = unknowns.segment<dim>(dim * node[static_cast<std::size_t>(i)]);
    return Points(values.colwise() + rigid);
  };
  Frame frame;
  frame.time = state_.time;
  const Points displacement = on_points(state_.displacement, state_.frame.displacement);
  frame.position = displacement;
  for (Eigen::Index i = 0; i < n; ++i)
    frame.position.col(i).head<dim>() += mesh().node.col(node[static_cast<std::size_t>(i)]);

  // Every node is a point: a Q2 cell shows as four quadrilaterals or eight hexahedra, nodes in ParaView's
  // order. Where parts meet there is a point for each.
  const int pieces = mesh().degree, row = pieces + 1, layers = dim == 3 ? pieces : 1;
  frame.cells.resize(1 << dim, mesh().n_cells() * pieces * pieces * layers);
  Eigen::Index at = 0;
  for (int c = 0; c < mesh().n_cells(); ++c)
    for (int l = 0; l < layers; ++l)
      for (int j = 0; j < pieces; ++j)
        for (int i = 0; i < pieces; ++i) {
          const auto point = [&](int x, int y, int z) {
            return recovery_.cell()(((l + z) * row + j + y) * row + i + x, c);
          };
          auto cell = frame.cells.col(at++);
          for (int z = 0; z < dim - 1; ++z)
            cell.template segment<4>(4 * z) << point(0, 0, z), point(1, 0, z), point(1, 1, z), point(0, 1, z);
        }

  const Eigen::Index points = mesh().n_quadrature;
  Eigen::MatrixXd state(Assembly<dim>::n_state, mesh().n_cells() * points);
  for (int c = 0; c < mesh().n_cells(); ++c)
    state.middleCols(c * points, points) = assembly_.cell_state(state_.displacement, c);
  const Eigen::MatrixXd recovered = recovery_.on_nodes(state.topRows<6>());
  frame.point_data = {{"displacement", "m", displacement},
                      {"velocity", "m/s", on_points(state_.velocity, state_.frame.velocity)},
                      {"stress", "Pa", recovered},
                      {"von_mises", "Pa", von_mises_of(recovered)},
                      {"strain_energy", "J/m^3", recovery_.means_on_nodes(state.row(6))}};
  if (failure_) {
    const Eigen::RowVectorXd damage = failure_->in_nodes(state_.damage);
    frame.point_data.push_back({"damage", "1", damage(Eigen::all, node)});
  }
  return division().alone() ? frame : joined_frame(frame, recovery_, mesh());
}

/// What keeps cells from locking, or why nothing does; empty where they do not lock.
template <int dim>
std::string FemSolver<dim>::strain_line() const {
  if (assembly_.shells() > 0) return shell_line(mesh(), assembly_.shells());
  bool rubber = false, locks = mesh().degree == 1;
  for (const Part& part : solid_.parts) {
    rubber = rubber || part.material.model == MaterialModel::neo_hookean;
    locks = locks || part.material.poisson >= Assembly<dim>::incompressible;
  }
  const bool automatic = parameters_.fem.strain == StrainField::automatic;
  if (assembly_.any_enhanced())
    return std::string(mesh().degree == 1
                           ? "enhanced strains: Q1 does not lock in bending, nor at constant volume"
                           : "enhanced strains: the pressure is linear in a Q2 cell") +
           (automatic && rubber ? "; compatible in neo-Hookean parts" : "");
  if (!locks) return "";
  return std::string("compatible strains") +
         (!automatic ? ""
          : failure_ ? ", as cells soften"
          : rubber   ? ", as for all neo-Hookean bodies"
                     : "") +
         (mesh().degree == 1 ? ": Q1 locks in bending and at constant volume"
                             : ": Q2 is too stiff at constant volume on coarse meshes");
}

template <int dim>
std::string FemSolver<dim>::linear_systems_line() const {
  const std::string by_factors =
      std::string(dim == 3 ? "Cholesky factors (CHOLMOD), LU factors (UMFPACK) where there are none"
                           : "LU factors (UMFPACK)") +
      (division().alone() ? "" : ", on the first rank");
  if (factors_.method != LinearMethod::direct)
    return std::string("linear systems: conjugate gradients with algebraic multigrid (Trilinos ML)") +
           (factors_.method == LinearMethod::automatic ? ", factors where they fail" : "");
  if (factors_.given_up->times == 0) return "linear systems: " + by_factors;
  return "linear systems: " + by_factors +
         "; conjugate gradients with multigrid failed: " + factors_.given_up->why;
}

template <int dim>
std::vector<std::string> FemSolver<dim>::lines() const {
  std::vector<std::string> lines = {
      fmt::format("fem ({})   {} cells Q{}, {} unknowns", library(), summary_.cells, mesh().degree,
                  division().size(mesh().n_unknowns())) +
          (division().alone() ? fmt::format("   f1 dry {:.1f} Hz", summary_.first_frequency) : ""),
      fmt::format("{}, {}", law_and_frame(solid_),
                  scheme_.mid_point
                      ? std::string("Newmark 1/4-1/2 with the mean load of a window")
                      : fmt::format("generalised-alpha, rho_infinity {:g}", parameters_.fem.rho_infinity))};
  if (std::string line = frame_line(support_motion_.supports(), dim); !line.empty())
    lines.push_back(std::move(line));
  if (std::string line = strain_line(); !line.empty()) lines.push_back(std::move(line));
  if (std::string line = advice(mesh(), assembly_.shells() > 0); !line.empty())
    lines.push_back(std::move(line));
  lines.push_back(linear_systems_line());
  if (!division().alone())
    lines.push_back(fmt::format("{} ranks, {} to {} unknowns each", division().communicator().size(),
                                summary_.fewest_unknowns, summary_.most_unknowns));
  if (parameters_.shape.kind == ShapeKind::plate && dim == 2)
    lines.push_back("beam theory " + beam_line(parameters_.plate, parameters_.material));
  if (failure_)
    for (std::string& line : failure_->lines()) lines.push_back(std::move(line));
  return lines;
}

template <int dim>
std::vector<Column> FemSolver<dim>::columns() const {
  std::vector<Column> columns = frame_columns(support_motion_.supports(), dim);
  if (failure_)
    for (const char* name : {"failure.energy", "failure.cells", "failure.damage"})
      columns.push_back({name, std::string(name) == "failure.energy" ? "J" : "1"});
  return columns;
}

template <int dim>
std::map<std::string, double> FemSolver<dim>::monitor() const {
  std::map<std::string, double> monitor =
      frame_monitor(support_motion_.supports(), dim, state_.frame, state_.reaction);
  if (factors_.given_up->times > 0) monitor["count.factors_for_iterations"] = factors_.given_up->times;
  if (!failure_) return monitor;
  const auto& damage = state_.damage;
  monitor["failure.energy"] = damage.released;
  monitor["failure.cells"] = static_cast<double>(damage.eroded);
  monitor["failure.damage"] = 1 - division().min(failure_->integrity(damage).minCoeff());
  damage.record.report(monitor);
  return monitor;
}

// Computes mass, centre and inertia with the consistent mass M, exact for the cells' shape:
//   m = 1·M 1, m x̄ = 1·M X, I_z = x·M x + y·M y − m (x̄² + ȳ²)
template <int dim>
Properties FemSolver<dim>::properties() {
  Properties result;
  const auto component = [&](int k, auto value) {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(mesh().n_unknowns());
    for (int i = 0; i < mesh().n_nodes(); ++i) v(dim * i + k) = value(i);
    return v;
  };
  for (int k = 0; k < dim; ++k) {
    const Eigen::VectorXd one = component(k, [](int) { return 1.0; });
    const Eigen::VectorXd x = component(k, [&](int i) { return mesh().node(k, i); });
    result.mass = division().dot(one, matrices_.mass * one);
    result.centre(k) = division().dot(one, matrices_.mass * x) / result.mass;
    if (k < 2)
      result.inertia +=
          division().dot(x, matrices_.mass * x) - result.mass * result.centre(k) * result.centre(k);
  }
  result.frequencies = frequencies(3);
  result.step = "any (implicit)";
  return result;
}

template void FemSolver<2>::write(Archive&) const;
template void FemSolver<2>::read(const Archive&);
template Frame FemSolver<2>::frame() const;
template std::vector<std::string> FemSolver<2>::lines() const;
template std::vector<Column> FemSolver<2>::columns() const;
template std::map<std::string, double> FemSolver<2>::monitor() const;
template Properties FemSolver<2>::properties();
template void FemSolver<3>::write(Archive&) const;
template void FemSolver<3>::read(const Archive&);
template Frame FemSolver<3>::frame() const;
template std::vector<std::string> FemSolver<3>::lines() const;
template std::vector<Column> FemSolver<3>::columns() const;
template std::map<std::string, double> FemSolver<3>::monitor() const;
template Properties FemSolver<3>::properties();

}  // namespace strake::structure::fem
