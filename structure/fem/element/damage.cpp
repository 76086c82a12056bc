#include "structure/fem/element/damage.hpp"

#include "proto/error.hpp"
#include "structure/failure/softening.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake::structure::fem {
namespace {

/// Whether the cells that are not eroded have parted into large pieces, and the middle of the eroded ones
/// between two of them. Cells are the columns that note_parting makes.
Eigen::Vector4d parting(const Eigen::MatrixXd& cells, Eigen::Index n_nodes) {
  const auto eroded = [&](Eigen::Index c) { return cells(1, c) != 0; };
  const auto node = [&](Eigen::Index a, Eigen::Index c) {
    return static_cast<Eigen::Index>(cells(5 + a, c));
  };
  Pieces pieces(n_nodes);
  for (Eigen::Index c = 0; c < cells.cols(); ++c)
    if (!eroded(c))
      for (Eigen::Index a = 1; a < cells.rows() - 5; ++a) pieces.join(node(0, c), node(a, c));
  const std::vector<Eigen::Index> piece = pieces.large();
  if (!Pieces::more_than_one(piece)) return Eigen::Vector4d::Zero();
  Joint joint;
  Eigen::Vector3d all = Eigen::Vector3d::Zero();  // middle of all eroded cells
  for (Eigen::Index c = 0; c < cells.cols(); ++c) {
    if (!eroded(c)) continue;
    all += cells.col(c).segment<3>(2) / cells.row(1).sum();
    std::vector<Eigen::Index> here;  // pieces at its nodes
    for (Eigen::Index a = 0; a < cells.rows() - 5; ++a)
      if (const Eigen::Index of_node = piece[static_cast<std::size_t>(node(a, c))]; of_node >= 0)
        here.push_back(of_node);
    if (here.empty()) continue;
    const auto [least, most] = std::minmax_element(here.begin(), here.end());
    joint.add(*least, *most, cells.col(c).segment<3>(2));
  }
  return (Eigen::Vector4d() << 1, joint.middle_or(all)).finished();
}

}  // namespace

template <int dim>
Damage<dim>::Damage(const FailureKeys& keys, const Mesh<dim>& mesh, const Assembly<dim>& assembly)
    : keys_(keys),
      mesh_(mesh),
      assembly_(assembly),
      narrowest_(std::numeric_limits<double>::infinity()),
      widest_(0) {
  Eigen::Vector2d too_wide(0, 0);  // a cell's extent along any direction, over the widest band; and that band
  for (int c = 0; c < mesh.n_cells(); ++c) {
    const double most = widest_band(keys, assembly.material(c), dim);
    Eigen::Vector3d size = Eigen::Vector3d::Zero();
    for (int k = 0; k < dim; ++k) {
      size(k) = extent(c, Eigen::Vector3d::Unit(k));
      narrowest_ = std::min(narrowest_, size(k));
      widest_ = std::max(widest_, size(k));
    }
    if (size.norm() >= most * std::max(too_wide(0), 1.0)) too_wide = {size.norm() / most, most};
  }
  too_wide = mesh.division.largest(too_wide);
  narrowest_ = mesh.division.min(narrowest_);
  widest_ = mesh.division.max(widest_);
  if (too_wide(0) > 0)
    throw Error(
        ExitCode::case_file, "structure.failure.fracture_energy",
        fmt::format("more than {:.4g} J/m^2 on this mesh: a cell of {:.4g} m holds as much elastic "
                    "energy at the strength already",
                    keys.fracture_energy * too_wide(0), too_wide(0) * too_wide(1)),
        fmt::format("structure.fem.refinement for cells below {:.4g} m", too_wide(1) / std::sqrt(dim)));
}

template <int dim>
typename Damage<dim>::State Damage<dim>::intact() const {
  State state;
  state.onset = state.peak = state.end = Eigen::VectorXd::Zero(mesh_.n_cells());
  return state;
}

template <int dim>
double Damage<dim>::extent(int cell, const Eigen::Vector3d& n) const {
  const auto along = [&](Eigen::Index a) {
    return n.template head<dim>().dot(mesh_.node.col(mesh_.cell(a, cell)));
  };
  double least = along(0), most = least;
  for (Eigen::Index a = 1; a < mesh_.cell.rows(); ++a) {
    least = std::min(least, along(a));
    most = std::max(most, along(a));
  }
  return most - least;
}

// Computes l_c = 1/(∇φ·n) in the middle of the cell. φ is 1 in the corners beyond the middle along the
// crack's normal n, 0 in the others, and multilinear between them. Hence ∂φ/∂ξ = Σ s/2^dim over the corners
// beyond, with s their places in the reference cell, −1 or 1.
template <int dim>
double Damage<dim>::band(int cell, const Eigen::Vector3d& normal) const {
  using Vector = Eigen::Matrix<double, dim, 1>;
  const Vector n = normal.template head<dim>(), centre = middle(cell).template head<dim>();
  const Eigen::Map<const Eigen::Matrix<double, dim, dim>> inverse(mesh_.centre_inverse.col(cell).data());
  constexpr int corners = 1 << dim;
  Vector slope = Vector::Zero();  // ∂φ/∂ξ
  for (int k = 0; k < corners; ++k) {
    Vector place;
    for (int axis = 0; axis < dim; ++axis) place(axis) = 2 * ((k >> axis) & 1) - 1;
    if (n.dot(mesh_.node.col(mesh_.corner(cell, k)) - centre) > 0) slope += place / corners;
  }
  return 1 / n.dot(inverse.transpose() * slope);
}

template <int dim>
Eigen::Vector3d Damage<dim>::middle(int cell) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index a = 0; a < mesh_.cell.rows(); ++a)
    sum.template head<dim>() += mesh_.node.col(mesh_.cell(a, cell));
  return sum / static_cast<double>(mesh_.cell.rows());
}

template <int dim>
bool Damage<dim>::eroded(const State& state, int c) const {
  return state.onset(c) > 0 && state.peak(c) >= state.end(c);
}

template <int dim>
bool Damage<dim>::look(const Eigen::VectorXd& u, double time, State& state) const {
  bool more = false;
  double broken = 0;  // cells
  Event begins = Event::Zero(),
        breaks = begins;  // the cell of the largest stress that begins now, the first that breaks
  const auto note = [&](Event& event, double weight, int c) {
    if (weight > event(0)) event << weight, -mesh_.number[static_cast<std::size_t>(c)], middle(c);
  };
  for (int c = 0; c < mesh_.n_cells(); ++c) {
    if (!mesh_.owns(c) || eroded(state, c)) continue;
    // Means over the cell as if it were undamaged: Cauchy stress and energy density.
    const auto weight = mesh_.weight.segment(c * mesh_.n_quadrature, mesh_.n_quadrature);
    const Eigen::Matrix<double, 7, 1> mean =
        assembly_.cell_state(u, c) * weight / (assembly_.share(c) * weight.sum());
    Eigen::Matrix3d sigma;
    sigma << mean(0), mean(1), mean(2), mean(1), mean(3), mean(4), mean(2), mean(4), mean(5);
    const double y = std::sqrt(mean(6));
    if (state.onset(c) == 0) {
      const double stress = equivalent_stress(keys_.criterion, sigma);
      if (!(stress > keys_.strength)) continue;
      // ψ grows with the square of the stress: where within the step the strength was reached.
      state.onset(c) = y * keys_.strength / stress;
      state.end(c) = std::max(keys_.fracture_energy / (band(c, principal_direction(sigma)) * state.onset(c)),
                              state.onset(c) * (1 + 1e-9));
      note(begins, stress, c);
    } else if (!(y > state.peak(c))) {
      continue;
    }
    state.peak(c) = std::min(y, state.end(c));
    more = true;
    if (!eroded(state, c)) continue;
    ++broken;
    note(breaks, 1, c);
  }
  if (!mesh_.division.any(more)) return false;
  for (Eigen::VectorXd* const of_cells : {&state.onset, &state.peak, &state.end})
    *of_cells = mesh_.part_of_whole(mesh_.whole(*of_cells));
  begins = mesh_.division.largest(begins);
  breaks = mesh_.division.largest(breaks);
  FailureRecord& record = state.record;
  if (begins(0) > 0 && (!record.start.happened() || record.start.time == time))
    record.start = {time, begins.template tail<3>()};
  if (breaks(0) == 0) return true;
  state.eroded += static_cast<std::int64_t>(mesh_.division.sum(broken));
  if (!record.crack.happened()) record.crack = {time, breaks.template tail<3>()};
  if (!record.parted.happened()) note_parting(time, state);
  return true;
}

// Cells of the whole body, one per column: number, whether it is eroded, middle, numbers of its nodes.
template <int dim>
void Damage<dim>::note_parting(double time, State& state) const {
  Eigen::MatrixXd own(5 + mesh_.cell.rows(), mesh_.n_cells());
  Eigen::Index count = 0;
  for (int c = 0; c < mesh_.n_cells(); ++c) {
    if (!mesh_.owns(c)) continue;
    own.col(count).head<5>() << mesh_.number[static_cast<std::size_t>(c)], eroded(state, c), middle(c);
    for (Eigen::Index a = 0; a < mesh_.cell.rows(); ++a)
      own(5 + a, count) = mesh_.division.number(dim * mesh_.cell(a, c)) / dim;
    ++count;
  }
  const Eigen::MatrixXd all = mesh_.division.columns_on_first(own.leftCols(count));
  Eigen::MatrixXd place = Eigen::MatrixXd::Zero(4, 1);  // whether it parted, and where
  if (mesh_.division.first()) place = parting(all, mesh_.division.size(mesh_.n_unknowns()) / dim);
  place = mesh_.division.sum(place);
  if (place(0) > 0) state.record.parted = {time, place.bottomRows<3>()};
}

template <int dim>
Eigen::VectorXd Damage<dim>::integrity(const State& state) const {
  Eigen::VectorXd integrity(mesh_.n_cells());
  for (int c = 0; c < mesh_.n_cells(); ++c)
    integrity(c) = integrity_after(state.onset(c), state.peak(c), state.end(c));
  return integrity;
}

template <int dim>
Eigen::RowVectorXd Damage<dim>::in_nodes(const State& state) const {
  const Eigen::VectorXd share = integrity(state);
  Eigen::RowVectorXd damage = Eigen::RowVectorXd::Zero(mesh_.n_nodes());
  for (int c = 0; c < mesh_.n_cells(); ++c)
    for (Eigen::Index a = 0; a < mesh_.cell.rows(); ++a)
      damage(mesh_.cell(a, c)) = std::max(damage(mesh_.cell(a, c)), 1 - share(c));
  return damage;
}

template <int dim>
std::vector<std::string> Damage<dim>::lines() const {
  return {
      fmt::format("failure by {} of {:.4g} Pa in the mean of a cell, then softening along a line that "
                  "dissipates G_c = {:.4g} J/m^2 over the cell's width ({:.4g} to {:.4g} mm)",
                  keys_.criterion == FailureCriterion::max_principal ? "a largest principal stress"
                                                                     : "a von Mises stress",
                  keys_.strength, keys_.fracture_energy, 1e3 * narrowest_, 1e3 * widest_),
      "failure is elastic and softening: no plastic flow, no contact between the faces of a crack; a band of "
      "cells, not a gap",
      fmt::format("a cell that lost all is eroded: {:g} of its stiffness and all of its mass stay", residual),
      "the wet surface stays closed over a crack: the faces of a crack are not wetted (coupling.interface = "
      "\"volume\" with particles wets them)"};
}

template class Damage<2>;
template class Damage<3>;

}  // namespace strake::structure::fem
