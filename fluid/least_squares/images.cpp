#include "fluid/least_squares/images.hpp"

#include "fluid/particles/pair_loop.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

// Pairs of water that are mirrored in a face (F72). A layer particle stands for p_i + q_ij, so it carries no
// change of pressure along the face. A mirrored neighbour k does: seen across the face it is
// √(r² + 4 h_i h_k) away. Its part along the normal is known from (F34) and stays with the layers. Neighbours
// of one row alone are mirrored; the factor f makes up for the others. Faces of plates and boxes alone have
// images: on wedges they make bursts larger, and on a cylinder the added mass 6 % too large (measured).

namespace strake::fluid {

/// Returns f. On a lattice of rows beside a face, Σ_pairs across it w x² / Σ_first rows w x², x along the
/// face.
template <int dim>
double LeastSquaresScheme<dim>::image_factor() const {
  const int reach = static_cast<int>(std::ceil(laplacian_.radius / p_.spacing)), depth = dim == 3 ? reach : 0;
  double all = 0, first = 0;
  for (int z = -depth; z <= depth; ++z)
    for (int y = 1; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const double across =
            x * x * weight(p_.spacing * std::sqrt(x * x + y * y + z * z), laplacian_.radius);
        all += y * across;  // as many rows have a pair that is y rows long
        if (y == 1) first += across;
      }
  return all / first;
}

template <int dim>
void LeastSquaresScheme<dim>::find_images(const Boundary<dim>& boundary, const State<dim>& state,
                                          const Neighbours& far) {
  const std::int64_t water = boundary.water();
  images_.count.assign(static_cast<std::size_t>(water), 0);
  images_.at_edge.assign(static_cast<std::size_t>(water), 0);
  images_.any = false;
  if (boundary.volume()) return;
  int point = 0;
  while (point < boundary.body_surface().points() && !boundary.is_between_sharp_corners(point)) ++point;
  if (point == boundary.body_surface().points()) return;
  images_.faces.resize(static_cast<std::size_t>(water));
  // A first layer stands up to l0 behind its face, and may so reach out of a thin body.
  const double reach = laplacian_.radius + 2 * p_.spacing;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i)
    if (ranks_.owns(i) && boundary.near_bodies(state.position.col(i), reach))
      find_image_faces(boundary, state, far, i);
  images_.particles.clear();
  for (std::int64_t i = 0; i < water; ++i)
    if (images_.count[static_cast<std::size_t>(i)] > 0) images_.particles.push_back(i);
  images_.any = ranks_.any(!images_.particles.empty());
  if (images_.any) share_image_faces(boundary);
}

/// Gives the ghosts, which have no rows, the faces of their owners. All ranks have the layers of bodies in
/// one order.
template <int dim>
void LeastSquaresScheme<dim>::share_image_faces(const Boundary<dim>& boundary) {
  using Faces = std::array<typename Images::Face, dim>;
  const auto first = static_cast<std::int32_t>(boundary.first_of_bodies());
  ranks_.update(
      sizeof(Faces) + 1,
      [&](std::int32_t i, std::byte* to) {
        const auto k = static_cast<std::size_t>(i);
        Faces faces = images_.faces[k];
        for (auto& face : faces) face.layer -= first;
        std::memcpy(to, &faces, sizeof faces);
        std::memcpy(to + sizeof faces, &images_.count[k], 1);
      },
      [&](std::int32_t i, const std::byte* from) {
        const auto k = static_cast<std::size_t>(i);
        Faces& faces = images_.faces[k];
        std::memcpy(&faces, from, sizeof faces);
        std::memcpy(&images_.count[k], from + sizeof faces, 1);
        for (auto& face : faces) face.layer += first;
      },
      Rings::first);
}

/// Finds the faces of particle i: of each direction that one whose middle is nearest, measured along the
/// face.
template <int dim>
void LeastSquaresScheme<dim>::find_image_faces(const Boundary<dim>& boundary, const State<dim>& state,
                                               const Neighbours& far, std::int64_t i) {
  const double alike = least_squares_constants().alike;
  const auto k = static_cast<std::size_t>(i);
  const auto columns = far.row(i);
  auto& faces = images_.faces[k];
  std::array<double, dim> nearest{};
  std::uint8_t count = 0;
  for (std::size_t e = columns.size(); e > 0 && columns[e - 1] >= boundary.first_of_bodies(); --e) {
    const std::int32_t j = columns[e - 1];
    if (boundary.master_of(j) >= 0 || !walls_.wet(j) || walls_.corner(j)) continue;
    if (!boundary.is_between_sharp_corners(boundary.point_of(j))) continue;
    const Vector<dim> n = walls_.normal(j),
                      r = boundary.tank().periodic().separation(state.position.col(j), state.position.col(i));
    const double up = n.dot(r), aside = r.squaredNorm() - up * up, height = up - walls_.depth(j);
    if (!(height > 0)) continue;
    std::uint8_t f = 0;
    while (f < count && walls_.normal(faces[f].layer).dot(n) < alike) ++f;
    if (f == dim || (f < count && nearest[f] <= aside)) continue;
    const double part = std::clamp(inside_end(boundary, state, i, j) + 0.5, 0.0, 1.0);
    if (!(part > 0)) continue;
    if (f == count) ++count;
    nearest[f] = aside;
    faces[f] = {.layer = j, .end = 0, .height = height, .part = part, .normal_velocity = 0};
  }
  const Vector<dim> x = state.position.col(i);
  bool at_edge = false;
  for (std::uint8_t f = 0; f < count; ++f) {
    const double inside = boundary.inside_free_end(boundary.point_of(faces[f].layer), x) / p_.spacing;
    at_edge = at_edge || (inside < 1 && faces[f].height < 2 * p_.spacing);
    if constexpr (dim == 3) faces[f].end = static_cast<float>(std::clamp(2 - inside, 0.0, 1.0));
  }
  images_.count[k] = count;
  images_.at_edge[k] = at_edge;
}

/// Computes the slope of the pressure at the height of each particle over its faces, as a velocity [m/s]:
///   v = v_s + exp(−h/(c√(ΔtΔt_p))) ((u** − U)·n − v_s)
/// v_s = Δt_p g·n of weight, which acts at every height; with sound an impact does not (F36). After the step
/// there is no weight left: `steady` is zero.
template <int dim>
void LeastSquaresScheme<dim>::find_image_velocities(const Boundary<dim>& boundary, const State<dim>& state,
                                                    const Vector<dim>& steady, double dt) {
  if (!images_.any) return;
  const double reach = p_.sound_speed * std::sqrt(dt * now_.projection);
  const auto listed = std::ssize(images_.particles);
#pragma omp parallel for schedule(static)
  for (std::int64_t e = 0; e < listed; ++e) {
    const std::int64_t i = images_.particles[static_cast<std::size_t>(e)];
    for (std::uint8_t f = 0; f < images_.count[static_cast<std::size_t>(i)]; ++f) {
      auto& face = images_.faces[static_cast<std::size_t>(i)][f];
      const Vector<dim> n = walls_.normal(face.layer);
      const double always = steady.dot(n), reached = std::exp(-face.height / reach);
      face.normal_velocity =
          always + reached * (relative_wall_velocity(boundary, state, i, face.layer).dot(n) - always);
    }
  }
  update_image_velocities();
}

/// Gives the ghosts' faces the velocities of their owners. The rest of a face is the same on all ranks.
template <int dim>
void LeastSquaresScheme<dim>::update_image_velocities() {
  if (!ranks_.several()) return;
  Vectors<dim> velocity(dim, std::ssize(images_.faces));
  for (std::size_t i = 0; i < images_.faces.size(); ++i)
    for (std::size_t f = 0; f < dim; ++f)
      velocity(static_cast<int>(f), static_cast<Eigen::Index>(i)) = images_.faces[i][f].normal_velocity;
  ranks_.update(velocity);
  for (std::size_t i = 0; i < images_.faces.size(); ++i)
    for (std::size_t f = 0; f < dim; ++f)
      images_.faces[i][f].normal_velocity = velocity(static_cast<int>(f), static_cast<Eigen::Index>(i));
}

/// Calls visit(pair) for each pair of row i that is mirrored in a face (F72):
///   w_m = f (1−τ_i) (1−τ_k) part_i part_k (1 − |n·r|/(l0/2)) (R/d − 1) ,
///   d² = r² + 4 h_i h_k < R² ,  |n·r| < l0/2 ,  τ = σ (1 − e max(0, n·N))
/// e is 0 in the plane; `end` of the face in space.
/// The faces of i and k must have nearly one normal n and one plane: |n·r − (h_k − h_i)| < `one_plane` l0.
/// Row k gets the same weights, to the last bit.
template <int dim>
template <class Visit>
void LeastSquaresScheme<dim>::for_each_mirrored(const Boundary<dim>& boundary, const State<dim>& state,
                                                const Neighbours& far, std::int64_t i,
                                                const Visit& visit) const {
  const auto own = static_cast<std::size_t>(i);
  const LeastSquaresConstants& tuned = least_squares_constants();
  const double reach = laplacian_.radius, row = tuned.first_row * p_.spacing;
  const auto columns = far.row(i);
  for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.water(); ++e) {
    const auto k = static_cast<std::size_t>(columns[e]);
    if (images_.count[k] == 0) continue;
    const Vector<dim> r =
        boundary.tank().periodic().separation(state.position.col(i), state.position.col(columns[e]));
    for (std::uint8_t a = 0; a < images_.count[own]; ++a)
      for (std::uint8_t b = 0; b < images_.count[k]; ++b) {
        const auto &one = images_.faces[own][a], &other = images_.faces[k][b];
        const double square = r.squaredNorm() + 4 * (one.height * other.height);
        if (!(square < reach * reach)) continue;
        const Vector<dim> n1 = walls_.normal(one.layer), n2 = walls_.normal(other.layer);
        if (n1.dot(n2) < tuned.alike) continue;
        const Vector<dim> n = (n1 + n2).normalized();
        if (std::abs(n.dot(r) - (other.height - one.height)) > tuned.one_plane * p_.spacing) continue;
        const double level = 1 - std::abs(n.dot(r)) / row;
        if (!(level > 0)) continue;
        const float inner = (1 - open_share(i, one, n)) * (1 - open_share(columns[e], other, n));
        if (!(inner > 0)) continue;
        const double w =
            images_.factor * inner * level * (one.part * other.part) * (reach / std::sqrt(square) - 1);
        visit({static_cast<std::uint32_t>(e), columns[e], a, b, w, r, n});
      }
  }
}

/// Lists the mirrored pairs of all particles that have faces, row by row.
template <int dim>
void LeastSquaresScheme<dim>::pair_images(const Boundary<dim>& boundary, const State<dim>& state,
                                          const Neighbours& far) {
  images_.first.resize(static_cast<std::size_t>(boundary.water()));
  images_.last.resize(images_.first.size());
  const auto listed = std::ssize(images_.particles);
  std::vector<std::int64_t> pairs(images_.particles.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t e = 0; e < listed; ++e)
    for_each_mirrored(boundary, state, far, images_.particles[static_cast<std::size_t>(e)],
                      [&](const typename Images::Pair&) { ++pairs[static_cast<std::size_t>(e)]; });
  std::int64_t all = 0;
  for (std::size_t e = 0; e < pairs.size(); ++e) {
    const auto i = static_cast<std::size_t>(images_.particles[e]);
    images_.first[i] = all;
    images_.last[i] = all += pairs[e];
  }
  images_.pairs.resize(static_cast<std::size_t>(all));
#pragma omp parallel for schedule(static)
  for (std::int64_t e = 0; e < listed; ++e) {
    const std::int64_t i = images_.particles[static_cast<std::size_t>(e)];
    auto next = static_cast<std::size_t>(images_.first[static_cast<std::size_t>(i)]);
    for_each_mirrored(boundary, state, far, i,
                      [&](const typename Images::Pair& pair) { images_.pairs[next++] = pair; });
  }
}

/// Adds the mirrored neighbours of particle i to its row of the matrix.
template <int dim>
void LeastSquaresScheme<dim>::add_images(const Neighbours& far, std::int64_t i) {
  float* const entries = moments_.entry.data() + far.start()[static_cast<std::size_t>(i)];
  for_each_image(i, [&](std::size_t e, double w, const Vector<dim>&, const Vector<dim>&, double) {
    const double before = entries[e];
    entries[e] = static_cast<float>(before - w);
    moments_.diagonal[i] += before - entries[e];
  });
}

#define STRAKE_INSTANTIATE(dim)                                                                         \
  template double LeastSquaresScheme<dim>::image_factor() const;                                        \
  template void LeastSquaresScheme<dim>::find_images(const Boundary<dim>&, const State<dim>&,           \
                                                     const Neighbours&);                                \
  template void LeastSquaresScheme<dim>::find_image_faces(const Boundary<dim>&, const State<dim>&,      \
                                                          const Neighbours&, std::int64_t);             \
  template void LeastSquaresScheme<dim>::share_image_faces(const Boundary<dim>&);                       \
  template void LeastSquaresScheme<dim>::update_image_velocities();                                     \
  template void LeastSquaresScheme<dim>::find_image_velocities(const Boundary<dim>&, const State<dim>&, \
                                                               const Vector<dim>&, double);             \
  template void LeastSquaresScheme<dim>::pair_images(const Boundary<dim>&, const State<dim>&,           \
                                                     const Neighbours&);                                \
  template void LeastSquaresScheme<dim>::add_images(const Neighbours&, std::int64_t);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
