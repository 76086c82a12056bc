#include "structure/ccx/solver.hpp"

#include "proto/error.hpp"
#include "structure/body/surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <numeric>
#include <set>
#include <utility>

namespace strake::structure::ccx {
CalculixSolver::CalculixSolver(const Parameters& p, deck::Model model)
    : parameters_(p),
      model_(std::move(model)),
      thickness_(deck::plane_thickness(model_)),
      runner_(p.run_folder, p.body_name, p.ccx.answer_within),
      version_(installed_version()),
      interface_(surface(p)) {
  deck::require_plain_materials(model_);
  std::set<int> nodes = deck::nodes_of(model_.interface);
  nodes.merge(deck::nodes_of(model_.probe_weights));
  wanted_.node.assign(nodes.begin(), nodes.end());
  if (p.ccx.calls == CalculixCalls::window || p.analysis != Analysis::dynamic) {
    wanted_.node.resize(static_cast<std::size_t>(model_.n_nodes()));
    std::iota(wanted_.node.begin(), wanted_.node.end(), 0);
  }
  column_.assign(static_cast<std::size_t>(model_.n_nodes()), -1);
  for (std::size_t i = 0; i < wanted_.node.size(); ++i)
    column_[static_cast<std::size_t>(wanted_.node[i])] = static_cast<Eigen::Index>(i);

  // Cells are drawn by their corners, which come first.
  const Eigen::Index corners = model_.dimension == 2 ? 4 : 8;
  drawn_cell_ = model_.cell.topRows(corners);
  const std::set<int> drawn(drawn_cell_.data(), drawn_cell_.data() + drawn_cell_.size());
  corner_.assign(drawn.begin(), drawn.end());
  for (int& node : drawn_cell_.reshaped())
    node = static_cast<int>(std::lower_bound(corner_.begin(), corner_.end(), node) - corner_.begin());
}

CalculixSolver::Now CalculixSolver::at_rest() const {
  const auto k = static_cast<Eigen::Index>(wanted_.node.size());
  const int n = model_.n_nodes();
  return {.time = 0,
          .displacement = Points::Zero(3, k),
          .velocity = Points::Zero(3, k),
          .body = {.time = 0,
                   .displacement = Points::Zero(3, n),
                   .velocity = Points::Zero(3, n),
                   .von_mises = Eigen::VectorXd::Zero(n)}};
}

std::string CalculixSolver::at_time(double t) const {
  return fmt::format("t = {:.6g} s", t);
}

deck::WindowLoad CalculixSolver::load_of(const Window& window, const Points& force) const {
  if (!force.allFinite())
    throw Error(ExitCode::solver_fault, "structure (ccx), " + at_time(window.t + window.dt),
                "the load on the interface is not finite",
                "see the fluid's log; lower coupling.surface.window");
  const double middle = window.t + window.dt / 2;
  const Eigen::MatrixXd nodal = model_.interface.transpose() * force.topRows(model_.dimension).transpose();
  deck::WindowLoad load{.windows_before = 0,
                        .dt = window.dt,
                        .force = nodal.transpose().reshaped(),
                        .gravity = ramp_factor(middle, model_.gravity_ramp)};
  load.force += ramp_factor(middle, model_.own_load_ramp) * model_.own_load;
  return load;
}

deck::Story CalculixSolver::story() const {
  return {.title = "structure", .origin = "structure.solver = \"ccx\""};
}

std::string CalculixSolver::headline() const {
  return fmt::format("ccx (CalculiX {})   {} cells {}, {} unknowns   {}", version_, model_.n_cells(),
                     model_.degree == 2 ? "quadratic" : "linear", model_.dimension * model_.n_nodes(),
                     material_law(model_.parts));
}

Points CalculixSolver::at_points(const deck::Weights& weights, const Points& values) const {
  Points points = Points::Zero(3, weights.rows());
  for (Eigen::Index p = 0; p < weights.outerSize(); ++p)
    for (deck::Weights::InnerIterator it(weights, p); it; ++it)
      points.col(p) += it.value() * values.col(column_[static_cast<std::size_t>(it.col())]);
  return points;
}

Points CalculixSolver::displacement() const {
  return at_points(model_.interface, now().displacement).colwise() + model_.support_velocity * now().time;
}

Points CalculixSolver::velocity() const {
  return at_points(model_.interface, now().velocity).colwise() + model_.support_velocity;
}

/// Only what was requested beforehand is available: the probes of the case.
Eigen::Vector3d CalculixSolver::at_probe(const Eigen::Vector3d& X, const Points& values) const {
  for (Eigen::Index p = 0; p < model_.probe_at.cols(); ++p)
    if (model_.probe_at.col(p) == X) return at_points(model_.probe_weights, values).col(p);
  assert(false);
  return Eigen::Vector3d::Zero();
}

Eigen::Vector3d CalculixSolver::displacement_at(const Eigen::Vector3d& X) const {
  return at_probe(X, now().displacement) + model_.support_velocity * now().time;
}

Eigen::Vector3d CalculixSolver::velocity_at(const Eigen::Vector3d& X) const {
  return at_probe(X, now().velocity) + model_.support_velocity;
}

Frame CalculixSolver::frame() const {
  const BodyField& body = now().body;
  Frame frame;
  frame.time = now().time;
  const Points displacement =
      body.displacement(Eigen::all, corner_).colwise() + model_.support_velocity * now().time;
  frame.position = model_.node(Eigen::all, corner_) + displacement;
  frame.cells = drawn_cell_;
  frame.point_data = {
      {"displacement", "m", displacement},
      {"velocity", "m/s", body.velocity(Eigen::all, corner_).colwise() + model_.support_velocity},
      {"von_mises", "Pa", body.von_mises(corner_).transpose()}};
  return frame;
}

void CalculixSolver::solve_static() {
  const std::string what = "the equilibrium under the case's own load";
  runner_.run(deck::calculix(model_, std::nullopt, story(), wanted_), {}, 1, what);
  std::vector<Printed> printed = read_printed(runner_.file("dat"), wanted_.node, model_.n_nodes());
  std::vector<BodyField> fields = read_fields(runner_.file("frd"), model_.n_nodes());
  if (printed.empty() || fields.empty()) runner_.fail(what, "printed no equilibrium");
  Now found = at_rest();
  found.displacement = std::move(printed.back().displacement);
  found.body = std::move(fields.back());
  found.body.velocity.setZero();
  begin_at(std::move(found));
}

std::vector<double> CalculixSolver::frequencies(int count) {
  const std::string what = "the natural frequencies";
  deck::Model modal = model_;
  modal.analysis = Analysis::modal;
  runner_.run(deck::calculix(modal, std::nullopt, story(), wanted_), {}, 1, what);
  std::vector<double> found = read_frequencies(runner_.file("dat"));
  if (found.empty()) runner_.fail(what, "printed no frequencies");
  // Motions that the supports leave free have no frequency.
  constexpr double none = 1e-3;  // of the highest one
  std::erase_if(found, [&](double f) { return !(f > none * found.back()); });
  found.resize(std::min(found.size(), static_cast<std::size_t>(count)));
  return found;
}

}  // namespace strake::structure::ccx
