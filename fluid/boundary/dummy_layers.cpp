#include "fluid/boundary/boundary.hpp"
#include "fluid/particles/columns.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace strake::fluid {

namespace {

/// Adds particles of one kind after the others: at rest, dry, and numbered on.
template <int dim>
void append(State<dim>& state, Kind kind, std::size_t count) {
  const std::size_t n = state.kind.size();
  resize_particles(state, static_cast<Eigen::Index>(n + count));
  const auto first = static_cast<std::ptrdiff_t>(n);
  std::fill(state.kind.begin() + first, state.kind.end(), kind);
  std::iota(state.id.begin() + first, state.id.end(), first);
  std::fill(state.surface.begin() + first, state.surface.end(), std::uint8_t{1});
}

}  // namespace

template <int dim>
void Boundary<dim>::add_layers(const InterfaceMesh& partner, const Knuckles& knuckles, State<dim>& state) {
  if constexpr (dim == 3) {
    body_surface_ = BodySurface3d(partner, spacing_, reach_, knuckles);
    mesh_ = body_surface_.mesh();
    const auto m = static_cast<std::size_t>(body_surface_.points()),
               rows = body_surface_.layer_particles().size();
    append(state, Kind::interface, m);
    append(state, Kind::dummy_interface, rows - m);
    for (const BodySurface3d::LayerParticle& row : body_surface_.layer_particles())
      point_of_.push_back(row.point);
    const Points zero = Points::Zero(3, mesh_.position.cols());
    move(state, zero, zero, true);
  } else {
    body_surface_ = BodySurface2d(partner, spacing_, knuckles);
    mesh_ = body_surface_.mesh();
    const int m = body_surface_.points();
    for (const BodySurface2d::Edge& edge : body_surface_.edges()) {
      go_beyond(edge, false);
      go_beyond(edge, true);
    }
    const std::size_t fillers = static_cast<std::size_t>((layers() - 1) * m) + beyond_.size();
    append(state, Kind::interface, static_cast<std::size_t>(m));
    append(state, Kind::dummy_interface, fillers);
    for (int layer = 0; layer < layers(); ++layer)
      for (int k = 0; k < m; ++k) point_of_.push_back(k);
    for (const BeyondCorner& filler : beyond_) point_of_.push_back(filler.point);
    // The particles of a flat water surface are the mirror images of the layer particles in the face.
    flat_water_.setZero(m);
    const double reach = counting_radius_;
    for (const BodySurface2d::Edge& edge : body_surface_.edges())
      for (int i = 0; i < edge.count; ++i)
        for (int j = 0; j < edge.count; ++j)
          for (int layer = 0; layer < layers(); ++layer) {
            int apart = std::abs(i - j);
            if (edge.closed) apart = std::min(apart, edge.count - apart);
            flat_water_[edge.first + i] +=
                weight(std::hypot(apart * edge.piece, (layer + 1) * spacing_), reach);
          }
    const Points zero = Points::Zero(3, m);
    move(state, zero, zero, true);
  }
}

// Layers continue past a corner of the angle α inside the body. Let θ be the angle of a place behind the
// face, measured from the face. Some pairs with water cross the face on their way to that place where
// θ < min(α, π). The layers behind the face itself reach θ = π/2. At depth d below the face and s beyond its
// end tan(θ − π/2) = s/d.
template <int dim>
void Boundary<dim>::go_beyond(const BodySurface2d::Edge& edge, bool at_end) {
  constexpr double round_off = 1e-6;  // [rad]
  const double angle = std::min(at_end ? edge.end_angle : edge.start_angle, std::numbers::pi);
  if (edge.closed || angle < 0.5 * std::numbers::pi + round_off) return;
  const bool concave = angle > std::numbers::pi - round_off;
  const double slope = concave ? 0.0 : 1 / std::tan(angle - 0.5 * std::numbers::pi);  // least depth over s
  const int columns = static_cast<int>(std::ceil(reach_ / edge.piece));
  for (int column = 0; column < columns; ++column) {
    const double beside = (column + 0.5) * edge.piece;
    for (int layer = 0; layer < layers(); ++layer) {
      const double depth = (layer + 0.5) * spacing_;
      if (depth < slope * beside) continue;
      if (at_end)
        beyond_.push_back({edge.first + edge.count - 1, edge.vertex + edge.count, beside, depth});
      else
        beyond_.push_back({edge.first, edge.vertex, -beside, depth});
    }
  }
}

template <int dim>
void Boundary<dim>::add_solids(const InterfaceMesh& partner, const Points& initial_velocity,
                               State<dim>& state) {
  mesh_ = partner;
  mesh_.name = "fluid";
  const auto m = partner.position.cols();
  append(state, Kind::solid, static_cast<std::size_t>(m));
  for (Eigen::Index k = 0; k < m; ++k) point_of_.push_back(static_cast<int>(k));
  state.position.rightCols(m) = partner.position.template topRows<dim>();
  if (initial_velocity.cols() == m) state.velocity.rightCols(m) = initial_velocity.template topRows<dim>();
  // Complete neighbourhood in the reference configuration: inside.
  NeighbourSearch<dim> search(counting_radius_, 0.0);
  const Vectors<dim> reference = state.position.rightCols(m);
  const Neighbours& rows = search.update(reference);
  const LatticeConstants lattice = lattice_constants<dim>(counting_radius_ / spacing_, spacing_);
  for (std::int64_t k = 0; k < m; ++k) {
    double n = 0;
    for (const double distance : rows.distances(k)) n += weight(distance, lattice.radius);
    buried_.push_back(n > 0.97 * lattice.n0 ? 1 : 0);
  }
}

template <int dim>
void Boundary<dim>::find_masters(const State<dim>& state) {
  const auto n = state.position.cols();
  master_.resize(static_cast<std::size_t>(n - water_));
  for (std::int64_t i = water_; i < n; ++i)
    master_[static_cast<std::size_t>(i - water_)] =
        state.kind[static_cast<std::size_t>(i)] == Kind::dummy_interface
            ? static_cast<std::int32_t>(bodies_ + point_of(i))
            : tank_.master_of(i);
}

template <int dim>
void Boundary<dim>::check_reach() const {
  const double slack = 1e-6 * spacing_;
  for (Eigen::Index k = 0; k < mesh_.position.cols(); ++k) {
    const Vector<dim> x = mesh_.position.col(k).template head<dim>();
    // Clamped columns of a particle structure may lie in the wall, where nothing is wet.
    if (!volume_ && tank_.distance(x) < -slack)
      throw Error(ExitCode::case_file, "structure",
                  fmt::format("the body reaches ({:.6g}, {:.6g}), outside the tank", x[0], x[1]),
                  "move or shorten the body, or make fluid.tank larger");
  }
}

template <int dim>
void Boundary<dim>::check_overlap(const State<dim>& state) const {
  for (std::int64_t i = 0; i < water_; ++i) {
    bool overlap = false;
    if (!body_surface_.empty()) overlap = body_surface_.inside(state.position.col(i));
    if (volume_)
      for (std::int64_t j = bodies_; j < state.position.cols() && !overlap; ++j)
        overlap = (state.position.col(j) - state.position.col(i)).norm() < 0.5 * spacing_;
    if (overlap)
      throw Error(ExitCode::case_file, "structure",
                  fmt::format("the body overlaps the water, for one at ({:.6g}, {:.6g})",
                              state.position(0, i), state.position(1, i)),
                  "raise the body, lower the upper face of fluid.water, or fluid.submerged = true");
  }
}

#define STRAKE_INSTANTIATE(dim)                                                                \
  template void Boundary<dim>::add_layers(const InterfaceMesh&, const Knuckles&, State<dim>&); \
  template void Boundary<dim>::add_solids(const InterfaceMesh&, const Points&, State<dim>&);   \
  template void Boundary<dim>::find_masters(const State<dim>&);                                \
  template void Boundary<dim>::check_reach() const;                                            \
  template void Boundary<dim>::check_overlap(const State<dim>&) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
