#include "fluid/boundary/boundary.hpp"

#include <algorithm>
#include <limits>

// Where the faces of bodies end: at a wall and over a seam of the tank they may go on. Places are compared
// with a body on the side of a seam that is nearer to it.

namespace strake::fluid {

namespace {

/// Returns the distance of x from the nearest end of an edge that counts, along the face [m].
template <class Counts>
double inside_ends(const BodySurface2d& body, int edge, const Eigen::Vector2d& x, const Counts& counts) {
  double inside = std::numeric_limits<double>::infinity();
  for (const bool last : {false, true}) {
    const BodySurface2d::End end = body.end_of(edge, last, x);
    if (counts(end.sharp, end.place)) inside = std::min(inside, end.inside);
  }
  return inside;
}

}  // namespace

/// A body from seam to seam has no end there, so that water meets it on its own side alone.
template <int dim>
void Boundary<dim>::find_seams() {
  if (!tank_.periodic().any() || body_surface_.empty()) return;
  Vector<dim> length = tank_.periodic().length();
  for (int d = 0; d < dim; ++d)
    if (body_surface_.low()[d] < tank_.shape().low()[d] + 0.5 * spacing_ &&
        body_surface_.high()[d] > tank_.shape().high()[d] - 0.5 * spacing_)
      length[d] = 0;
  around_ = Periodic<dim>(length);
}

template <int dim>
bool Boundary<dim>::goes_on_over_seam(const Vector<dim>& place) const {
  const double near = 0.5 * spacing_;
  for (int d = 0; d < dim; ++d) {
    if (!tank_.periodic().along(d)) continue;
    const double low = tank_.shape().low()[d], high = tank_.shape().high()[d];
    if (place[d] > low + near && place[d] < high - near) continue;
    const double over = place[d] > low + near ? low - high : high - low;
    if (distance_to<dim>(body_surface_, place + over * Vector<dim>::Unit(d), near) <= near) return true;
  }
  return false;
}

template <int dim>
double Boundary<dim>::within(int point, const Vector<dim>& x) const {
  const auto ends = [&](bool, const Vector<dim>& place) { return !goes_on_over_seam(place); };
  if constexpr (dim == 3)
    return body_surface_.within(point, beside(point, x), ends);
  else
    return inside_ends(body_surface_, body_surface_.edge_of(point), beside(point, x), ends);
}

template <int dim>
double Boundary<dim>::inside_free_end(int point, const Vector<dim>& x, bool only_sharp) const {
  const auto is_free = [&](bool sharp, const Vector<dim>& place) {
    return (sharp || !only_sharp) && tank_.distance(place) > 0.5 * spacing_ && !goes_on_over_seam(place);
  };
  if constexpr (dim == 3)
    return body_surface_.within(point, beside(point, x), is_free);
  else
    return inside_ends(body_surface_, body_surface_.edge_of(point), beside(point, x), is_free);
}

#define STRAKE_INSTANTIATE(dim)                                               \
  template void Boundary<dim>::find_seams();                                  \
  template bool Boundary<dim>::goes_on_over_seam(const Vector<dim>&) const;   \
  template double Boundary<dim>::within(int point, const Vector<dim>&) const; \
  template double Boundary<dim>::inside_free_end(int point, const Vector<dim>&, bool) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
