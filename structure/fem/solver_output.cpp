#include "proto/error.hpp"
#include "structure/body/beam.hpp"
#include "structure/body/mass.hpp"
#include "structure/fem/element/solid_shell.hpp"
#include "structure/fem/solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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
  const int others = mesh.cells_of_body - shells;
  return fmt::format("solid shells: {} cells, thin along their shortest edges, up to {:.3g} times longer",
                     shells, slenderness(mesh)) +
         (others > 0 ? fmt::format("; {} cells in joints have enhanced strains", others) : "");
}

/// Names the solid shell where thin cells stand alone or two through the thickness; empty: they do not.
std::string advice(const Mesh<3>& mesh) {
  constexpr double thin = 10;  // length over thickness
  const double slender = slenderness(mesh);
  if (slender < thin || has_core(mesh)) return "";
  return fmt::format(
      "cells are {:.3g} times longer than thick, one or two through the thickness: "
      "structure.fem.strain = \"solid_shell\" is made for such plates",
      slender);
}

/// The cells of a frame that show one cell of the mesh: a Q2 cell shows as four quadrilaterals or eight
/// hexahedra, nodes in ParaView's order. One column each, of places of nodes in the cell.
template <int dim>
Eigen::MatrixXi pieces_of_cell(int degree) {
  const int row = degree + 1, layers = dim == 3 ? degree : 1;
  Eigen::MatrixXi pieces(1 << dim, degree * degree * layers);
  Eigen::Index at = 0;
  for (int l = 0; l < layers; ++l)
    for (int j = 0; j < degree; ++j)
      for (int i = 0; i < degree; ++i, ++at)
        for (int z = 0; z < dim - 1; ++z) {
          const int first = ((l + z) * row + j) * row + i;
          pieces.col(at).segment<4>(4 * z) << first, first + 1, first + row + 1, first + row;
        }
  return pieces;
}

/// Joins the points of all ranks on the first one, in the order of their numbers in the body, and adds the
/// cells between them. The other ranks get an empty frame.
template <int dim>
Frame on_first(Frame frame, const Recovery<dim>& recovery, const Mesh<dim>& mesh, int parts) {
  // A column for each point: its number, place and values; for each cell: its number, and those of its nodes.
  Eigen::MatrixXd points(4, recovery.size()), cells(1 + mesh.cell.rows(), mesh.n_cells());
  std::vector<int> own_points, own_cells;
  for (int i = 0; i < recovery.size(); ++i) {
    const int node = recovery.node()[static_cast<std::size_t>(i)],
              part = recovery.part()[static_cast<std::size_t>(i)];
    points.col(i) << static_cast<double>(parts) * (mesh.division.number(dim * node) / dim) + part,
        frame.position.col(i);
    if (mesh.division.owns(dim * node)) own_points.push_back(i);
  }
  for (int c = 0; c < mesh.n_cells(); ++c) {
    cells.col(c) << mesh.number[static_cast<std::size_t>(c)],
        points.row(0)(recovery.cell().col(c)).transpose();
    if (mesh.owns(c)) own_cells.push_back(c);
  }
  for (const Frame::Array& array : frame.point_data) {
    points.conservativeResize(points.rows() + array.value.rows(), Eigen::NoChange);
    points.bottomRows(array.value.rows()) = array.value;
  }
  points = mesh.division.columns_on_first(points(Eigen::all, own_points));
  cells = mesh.division.columns_on_first(cells(Eigen::all, own_cells));
  if (!mesh.division.first()) return {};

  frame.position = points.middleRows<3>(1);
  Eigen::Index row = 4;
  for (Frame::Array& array : frame.point_data) {
    array.value = Eigen::MatrixXd(points.middleRows(row, array.value.rows()));
    row += array.value.rows();
  }
  const Eigen::RowVectorXd number = points.row(0);
  const Eigen::MatrixXi nodes = cells.bottomRows(mesh.cell.rows()).unaryExpr([&](double wanted) {
    return static_cast<int>(std::lower_bound(number.begin(), number.end(), wanted) - number.begin());
  });
  const Eigen::MatrixXi pieces = pieces_of_cell<dim>(mesh.degree);
  frame.cells.resize(pieces.rows(), cells.cols() * pieces.cols());
  for (Eigen::Index c = 0; c < cells.cols(); ++c)
    frame.cells.middleCols(c * pieces.cols(), pieces.cols()) =
        nodes.col(c)(pieces.reshaped()).reshaped(pieces.rows(), pieces.cols());
  return frame;
}

/// The vectors of a checkpoint by name, of unknowns or of cells.
template <class State>
auto vectors_of(State& state) {
  if constexpr (requires { state.onset; })
    return std::array{std::pair("fem.onset", &state.onset), std::pair("fem.peak", &state.peak),
                      std::pair("fem.end", &state.end)};
  else
    return std::array{
        std::pair("fem.displacement", &state.displacement), std::pair("fem.velocity", &state.velocity),
        std::pair("fem.acceleration", &state.acceleration), std::pair("fem.tangent_at", &state.tangent_at)};
}

}  // namespace

template <int dim>
void FemSolver<dim>::write(Archive& archive) const {
  for (const auto& [name, values] : vectors_of(saved_)) archive.real[name] = division().whole(*values);
  archive.real["fem.scalars"] = Eigen::RowVector3d(saved_.time, saved_.external, saved_.tangent_dt);
  Eigen::Matrix<double, 3, 4> frame;
  frame << saved_.frame.displacement, saved_.frame.velocity, saved_.frame.acceleration, saved_.reaction;
  archive.real["fem.frame"] = frame;
  archive.integer["fem.steps"] = {saved_.steps};
  if (!failure_) return;
  const auto& damage = saved_.damage;
  for (const auto& [name, values] : vectors_of(damage)) archive.real[name] = mesh().whole(*values);
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
  for (const auto& [name, values] : vectors_of(state_)) *values = division().part(vector(name, n));
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
    for (const auto& [name, values] : vectors_of(damage))
      *values = mesh().part_of_whole(vector(name, mesh().cells_of_body));
    damage.record = FailureRecord::from(archive.real.at("fem.failure"));
    damage.released = archive.real.at("fem.released")(0);
    damage.eroded = archive.integer.at("fem.eroded").at(0);
    assembly_.damage(failure_->integrity(damage));
  }
  saved_ = state_;
}

// Points are the pairs of a node and a part: every node is one, and where parts meet there is one for each.
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
  const Eigen::Index points = mesh().n_quadrature;
  Eigen::MatrixXd state(Assembly<dim>::n_state, mesh().n_cells() * points);
  for (int c = 0; c < mesh().n_cells(); ++c)
    state.middleCols(c * points, points) = assembly_.cell_state(state_.displacement, c);
  const Eigen::MatrixXd recovered = recovery_.on_nodes(state.topRows<6>());
  const Points displacement = on_points(state_.displacement, state_.frame.displacement);
  Frame frame;
  frame.time = state_.time;
  frame.position = displacement;
  for (Eigen::Index i = 0; i < n; ++i)
    frame.position.col(i) += mesh().place(node[static_cast<std::size_t>(i)]);
  frame.point_data = {{"displacement", "m", displacement},
                      {"velocity", "m/s", on_points(state_.velocity, state_.frame.velocity)},
                      {"stress", "Pa", recovered},
                      {"von_mises", "Pa", von_mises_of(recovered)},
                      {"strain_energy", "J/m^3", recovery_.means_on_nodes(state.row(6))}};
  if (failure_) {
    const Eigen::RowVectorXd damage = failure_->in_nodes(state_.damage);
    frame.point_data.push_back({"damage", "1", damage(Eigen::all, node)});
  }
  return on_first(std::move(frame), recovery_, mesh(), static_cast<int>(solid_.parts.size()));
}

/// What keeps cells from locking, or why nothing does; empty where they do not lock.
template <int dim>
std::string FemSolver<dim>::strain_line() const {
  if constexpr (dim == 3)
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
      fmt::format("fem ({})   {} cells Q{}, {} unknowns", library(), mesh().cells_of_body, mesh().degree,
                  division().size(mesh().n_unknowns())) +
          (division().alone() ? fmt::format("   f1 dry {:.1f} Hz", summary_.first_frequency) : ""),
      fmt::format("{}, {}", law_and_frame(solid_),
                  scheme_.mid_point
                      ? std::string("Newmark 1/4-1/2 with the mean load of a window")
                      : fmt::format("generalised-alpha, rho_infinity {:g}", parameters_.fem.rho_infinity))};
  if (std::string line = frame_line(support_motion_.supports(), dim); !line.empty())
    lines.push_back(std::move(line));
  if (std::string line = strain_line(); !line.empty()) lines.push_back(std::move(line));
  if constexpr (dim == 3)
    if (std::string line = advice(mesh()); assembly_.shells() == 0 && !line.empty())
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

template <int dim>
Properties FemSolver<dim>::properties() {
  const MassProperties body = mass_of(solid_);
  Properties result;
  result.mass = body.mass;
  result.centre = body.centre;
  result.inertia = body.inertia(2, 2);
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
