#include "fluid/geometry/body_surface_2d.hpp"

#include "fluid/geometry/outline.hpp"
#include "proto/error.hpp"
#include "proto/geometry/polygon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::fluid {

namespace {

using Vector2 = BodySurface2d::Vector2;

/// Two lengths that differ by less, as a share, are equal.
constexpr double tie = 1e-9;
/// An end of an edge counts for water up to this distance [spacings]. Pairs of water and layers are shorter.
constexpr double end_reach = 4;

/// Returns the normal to the right of t. It points into the fluid where the body is followed
/// counter-clockwise.
Vector2 right_of(const Vector2& t) {
  return {t.y(), -t.x()};
}

/// Returns the place where two stretches meet: the mean of both extrapolations. One of a single point has no
/// direction, so its extrapolation does not count.
Vector2 joined(const Vector2& before, int count_before, const Vector2& behind, int count_behind) {
  const double mine = count_before > 1 || count_behind == 1 ? 1.0 : 0.0,
               theirs = count_behind > 1 || count_before == 1 ? 1.0 : 0.0;
  return (mine * before + theirs * behind) / (mine + theirs);
}

}  // namespace

BodySurface2d::BodySurface2d(const InterfaceMesh& partner, double spacing, const Knuckles& knuckles)
    : spacing_(spacing) {
  mesh_.name = "fluid";
  mesh_.dimension = 2;
  for (const auto& loop : loops_of(partner)) {
    double area = 0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vector2 a = partner.position.col(loop[k]).head<2>();
      const Vector2 b = partner.position.col(loop[(k + 1) % loop.size()]).head<2>();
      area += 0.5 * cross(a, b);
    }
    if (!(area > 0))
      throw Error(ExitCode::case_file, fmt::format("interface \"{}\"", partner.name),
                  fmt::format("the outline that starts at point {} encloses {:.6g} m^2", loop.front(), area),
                  "walk it counter-clockwise, so that its normals point into the fluid");
    add_edges(Outline(partner, loop, spacing, knuckles));
  }
  const auto m = reference_.cols();
  mesh_.position = Points::Zero(3, m);
  mesh_.position.topRows<2>() = reference_;
  point_ = velocity_ = normal_ = normal_rate_ = Vectors2::Zero(2, m);
  area_ = Eigen::VectorXd::Zero(m);
  move(Vectors2::Zero(2, m), Vectors2::Zero(2, m));
}

/// Divides an outline into edges between its corners.
void BodySurface2d::add_edges(const Outline& outline) {
  const std::size_t n = outline.size();
  std::vector<std::size_t> corners;
  for (std::size_t k = 0; k < n; ++k)
    if (outline.bend[k] == Bend::corner) corners.push_back(k);
  const bool closed = corners.empty();
  if (closed) {  // from a knuckle, which must end a stretch
    const auto first = std::ranges::find_if(outline.bend, is_turn_within_face);
    corners.push_back(first == outline.bend.end() ? 0
                                                  : static_cast<std::size_t>(first - outline.bend.begin()));
  }
  const std::size_t first_edge = edges_.size();
  const int first_point = points();
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::size_t begin = corners[c], end = c + 1 < corners.size() ? corners[c + 1] : corners[0] + n;
    Edge edge;
    edge.first = points();
    edge.vertex = edge.first + static_cast<int>(edges_.size());
    edge.closed = closed;
    double turned = 0;
    for (std::size_t k = begin + 1; k < end; ++k) {
      const bool bends = std::abs(outline.turn[k % n]) > flat_angle;
      edge.curved = edge.curved || (bends && outline.bend[k % n] == Bend::smooth);
      turned += is_turn_within_face(outline.bend[k % n]) ? corner_angle : std::abs(outline.turn[k % n]);
    }
    edge.plane = !closed && turned < corner_angle;
    if (!closed) {
      edge.start_angle = std::numbers::pi - outline.turn[begin];
      edge.end_angle = std::numbers::pi - outline.turn[end % n];
      const auto down = [&](std::size_t k) { return -outline.normal(k).y(); };
      edge.start_sharp = is_sharp_corner(edge.start_angle, down(begin + n - 1), down(begin));
      edge.end_sharp = is_sharp_corner(edge.end_angle, down(end + n - 1), down(end));
    }
    add_pieces(outline, begin, end, edge);
    find_chines(outline, begin, edge);
    edges_.push_back(edge);
  }
  connect(first_edge);
  const int m = points() - first_point;
  const auto old = mesh_.faces.cols();
  mesh_.faces.conservativeResize(2, old + m);
  for (int k = 0; k < m; ++k) mesh_.faces.col(old + k) << first_point + k, first_point + (k + 1) % m;
}

/// Divides an edge, from point `begin` of the outline to point `end`, into stretches between knuckles, and
/// each stretch into equal pieces of about a spacing with a wet point in the middle.
void BodySurface2d::add_pieces(const Outline& outline, std::size_t begin, std::size_t end, Edge& edge) {
  std::vector<double> length{0}, stop{0};  // along the edge: at each of its points; where stretches end [m]
  for (std::size_t k = begin; k < end; ++k) {
    if (k > begin && is_turn_within_face(outline.bend[k % outline.size()])) stop.push_back(length.back());
    length.push_back(length.back() + (outline.at(k + 1) - outline.at(k)).norm());
  }
  stop.push_back(length.back());
  const int least = edge.closed && stop.size() == 2 ? 3 : 1;
  for (std::size_t c = 0; c + 1 < stop.size(); ++c) {
    const double whole = stop[c + 1] - stop[c];
    const int count = std::max(least, static_cast<int>(std::lround(whole / spacing_)));
    const double piece = whole / count;
    const Eigen::Index first = edge.first + edge.count;
    reference_.conservativeResize(2, first + count);
    half_piece_.conservativeResize(2, first + count);
    for (int i = 0; i < count; ++i) {
      const double s = stop[c] + (i + 0.5) * piece;
      const auto segment = static_cast<std::size_t>(
          std::upper_bound(length.begin() + 1, length.end() - 1, s) - length.begin() - 1);
      const Vector2 a = outline.at(begin + segment), b = outline.at(begin + segment + 1);
      const double share = (s - length[segment]) / (length[segment + 1] - length[segment]);
      reference_.col(first + i) = a + share * (b - a);
      half_piece_.col(first + i) = 0.5 * piece * (b - a).normalized();
      edge_of_.push_back(static_cast<int>(edges_.size()));
    }
    edge.stretch.push_back(edge.count);
    edge.count += count;
  }
  edge.stretch.push_back(edge.count);
  edge.piece = length.back() / edge.count;
}

void BodySurface2d::connect(std::size_t first_edge) {
  const std::size_t count = edges_.size() - first_edge;
  for (std::size_t c = 0; c < count; ++c) {
    Edge& edge = edges_[first_edge + c];
    edge.previous = static_cast<int>(first_edge + (c + count - 1) % count);
    edge.next = static_cast<int>(first_edge + (c + 1) % count);
  }
  // The longer of two edges owns the corner between them. On equal lengths the earlier one owns it, so that a
  // body symmetric to its middle line stays symmetric.
  for (std::size_t c = 0; c < count; ++c) {
    Edge& edge = edges_[first_edge + c];
    Edge& next = edges_[static_cast<std::size_t>(edge.next)];
    const double mine = edge.piece * edge.count, theirs = next.piece * next.count;
    edge.owns_end = mine > theirs * (1 + tie) || (mine > theirs * (1 - tie) && &edge <= &next);
    next.owns_start = !edge.owns_end;
  }
}

/// Returns half the tangent of a piece, turned with the body, or its rate. The turn is that of the wet point
/// and those beside it, about their middle: with the arms r in the reference, ρ now and the velocities v,
///   tan φ = Σ r × ρ / Σ r·ρ,   ω = Σ ρ × v / Σ ρ² .
Vector2 BodySurface2d::half_piece(const Edge& edge, int a, bool is_position) const {
  const Edge &last = edges_[static_cast<std::size_t>(edge.previous)],
             &next = edges_[static_cast<std::size_t>(edge.next)];
  const std::array<int, 3> beside = {a > edge.first ? a - 1 : last.first + last.count - 1, a,
                                     a + 1 < edge.first + edge.count ? a + 1 : next.first};
  Vector2 middle = Vector2::Zero(), middle_now = Vector2::Zero(), drift = Vector2::Zero();
  for (const int k : beside) {
    middle += reference_.col(k) / 3;
    middle_now += point_.col(k) / 3;
    drift += velocity_.col(k) / 3;
  }
  double along = 0, across = 0, spin = 0, size = 0;
  for (const int k : beside) {
    const Vector2 r = reference_.col(k) - middle, now = point_.col(k) - middle_now;
    along += r.dot(now);
    across += cross(r, now);
    spin += cross(now, velocity_.col(k) - drift);
    size += now.squaredNorm();
  }
  const double scale = std::hypot(along, across);
  if (!(scale > 0)) return is_position ? Vector2(half_piece_.col(a)) : Vector2(Vector2::Zero());
  const Vector2 half = half_piece_.col(a),
                turned = Vector2(along * half.x() - across * half.y(), across * half.x() + along * half.y()) /
                         scale;
  return is_position ? turned : Vector2(spin / size * Vector2(-turned.y(), turned.x()));
}

/// Places the vertices of an edge, from its wet points: half-way between two of them, and on an end of a
/// stretch by extrapolation. A knuckle is the mean of both extrapolations.
void BodySurface2d::place_vertices(const Edge& edge, const Vectors2& from, Vectors2& to, bool is_position) {
  Vector2 before = Vector2::Zero();
  int count_before = 0;
  for (std::size_t c = 0; c + 1 < edge.stretch.size(); ++c) {
    const int begin = edge.stretch[c], end = edge.stretch[c + 1], count = end - begin;
    for (int i = begin + 1; i < end; ++i)
      to.col(edge.vertex + i) = 0.5 * (from.col(edge.first + i - 1) + from.col(edge.first + i));
    const int a = edge.first + begin, b = edge.first + end - 1;
    Vector2 start, stop;
    if (count > 1) {
      start = 1.5 * from.col(a) - 0.5 * from.col(a + 1);
      stop = 1.5 * from.col(b) - 0.5 * from.col(b - 1);
    } else {
      const Vector2 half = half_piece(edge, a, is_position);
      start = from.col(a) - half;
      stop = from.col(a) + half;
    }
    to.col(edge.vertex + begin) = c == 0 ? start : joined(before, count_before, start, count);
    to.col(edge.vertex + end) = before = stop;
    count_before = count;
  }
  if (!edge.closed) return;
  const int a = edge.first, b = edge.first + edge.count - 1, last = edge.vertex + edge.count;
  if (edge.stretch.size() == 2)
    to.col(edge.vertex) = 0.5 * (from.col(a) + from.col(b));
  else
    to.col(edge.vertex) = joined(before, count_before, to.col(edge.vertex), edge.stretch[1]);
  to.col(last) = to.col(edge.vertex);
}

void BodySurface2d::move(const Vectors2& displacement, const Vectors2& velocity) {
  point_ = reference_ + displacement;
  velocity_ = velocity;
  const auto vertices = static_cast<Eigen::Index>(points()) + static_cast<Eigen::Index>(edges_.size());
  vertex_.resize(2, vertices);
  vertex_velocity_.resize(2, vertices);
  for (const Edge& edge : edges_) {
    place_vertices(edge, point_, vertex_, true);
    place_vertices(edge, velocity_, vertex_velocity_, false);
  }
  for (const Edge& edge : edges_) {
    if (edge.closed) continue;
    const Edge& next = edges_[static_cast<std::size_t>(edge.next)];
    const int end = edge.vertex + edge.count, mine = edge.count - edge.stretch[edge.stretch.size() - 2];
    for (Vectors2* values : {&vertex_, &vertex_velocity_})
      values->col(end) = values->col(next.vertex) =
          joined(values->col(end), mine, values->col(next.vertex), next.stretch[1]);
  }
  const double reach2 = end_reach * end_reach * spacing_ * spacing_;
  ends_.resize(edges_.size());
  for (std::size_t r = 0; r < edges_.size(); ++r)
    for (const bool last : {false, true}) {
      const int at = edges_[r].vertex + (last ? edges_[r].count : 0);
      const Vector2 place = vertex_.col(at), inwards = vertex_.col(last ? at - 1 : at + 1) - place;
      ends_[r][last ? 1 : 0] = {place, inwards, inwards.norm(), reach2};
    }
  meet_at_bisectors();
  place_chines();
  place_boxes();
  for (const Edge& edge : edges_)
    for (int i = 0; i < edge.count; ++i) {
      const Vector2 t = vertex_.col(edge.vertex + i + 1) - vertex_.col(edge.vertex + i);
      const Vector2 t_rate =
          vertex_velocity_.col(edge.vertex + i + 1) - vertex_velocity_.col(edge.vertex + i);
      const double length = t.norm();
      const Vector2 unit = t / length;
      const Vector2 n = right_of(unit);
      area_[edge.first + i] = length;
      normal_.col(edge.first + i) = n;
      normal_rate_.col(edge.first + i) = right_of((t_rate - unit * unit.dot(t_rate)) / length);
    }
}

/// Lets the faces of a corner that is not sharp end at its bisector. Water before such a corner lies
/// past both faces, and must have one of them (F85): with t = i − i', i and i' the directions from the corner
/// along the face and along the other one,
///   inside(x) = (x − corner)·t/(i·t) .
void BodySurface2d::meet_at_bisectors() {
  const std::vector<std::array<Ending, 2>> along = ends_;
  for (std::size_t r = 0; r < edges_.size(); ++r)
    for (const bool last : {false, true}) {
      const Edge& edge = edges_[r];
      const double angle = last ? edge.end_angle : edge.start_angle;
      const bool sharp = last ? edge.end_sharp : edge.start_sharp;
      if (edge.closed || sharp || angle >= std::numbers::pi) continue;
      const Ending& other = along[static_cast<std::size_t>(last ? edge.next : edge.previous)][last ? 0 : 1];
      Ending& own = ends_[r][last ? 1 : 0];
      const Vector2 direction = own.inwards / own.length, across = direction - other.inwards / other.length;
      own = {own.place, across, direction.dot(across), own.reach2};
    }
}

/// Lists the chines of an edge from point `begin` of the outline on, and which of them end each stretch.
void BodySurface2d::find_chines(const Outline& outline, std::size_t begin, const Edge& edge) {
  chines_.beside.resize(edge_of_.size(), {-1, -1});
  const auto beside = [&](int piece) -> std::array<int, 2>& {
    return chines_.beside[static_cast<std::size_t>(edge.first + piece)];
  };
  const std::size_t stretches = edge.stretch.size() - 1;
  std::size_t k = begin;
  for (std::size_t c = edge.closed ? 0 : 1; c < stretches; ++c) {
    if (c > 0) do
        ++k;
      while (!is_turn_within_face(outline.bend[k % outline.size()]));
    if (outline.bend[k % outline.size()] != Bend::chine) continue;
    const int number = static_cast<int>(chines_.chine.size()), at = edge.stretch[c];
    chines_.chine.push_back(
        {edge.vertex + (at > 0 ? at : edge.count) - 1, edge.vertex + at, edge.vertex + at + 1, {}});
    for (int i = at; i < edge.stretch[c + 1]; ++i) beside(i)[0] = number;
    const std::size_t before = c > 0 ? c - 1 : stretches - 1;
    for (int i = edge.stretch[before]; i < edge.stretch[before + 1]; ++i) beside(i)[1] = number;
  }
}

/// Both faces of a chine end at the plane that halves it, as those of a corner do that is not sharp (F85).
void BodySurface2d::place_chines() {
  const double reach2 = end_reach * end_reach * spacing_ * spacing_;
  for (Chine& chine : chines_.chine) {
    const Vector2 place = vertex_.col(chine.place), behind = (vertex_.col(chine.behind) - place).normalized(),
                  before = (vertex_.col(chine.before) - place).normalized(), across = behind - before;
    chine.ending = {Ending{place, across, behind.dot(across), reach2},
                    Ending{place, -across, -before.dot(across), reach2}};
  }
}

bool BodySurface2d::is_near_corner(const Vector2& x, double distance) const {
  return std::ranges::any_of(edges_, [&](const Edge& edge) {
    const auto is_near = [&](int k) {
      return (vertex_.col(edge.vertex + k) - x).squaredNorm() < distance * distance;
    };
    const bool bends = edge.stretch.size() > 2;
    return bends ? std::ranges::any_of(edge.stretch, is_near) : !edge.closed && is_near(0);
  });
}

bool BodySurface2d::is_between_sharp_corners(int edge) const {
  const Edge& r = edges_[static_cast<std::size_t>(edge)];
  return r.start_sharp && r.end_sharp && r.plane;
}

BodySurface2d::End BodySurface2d::end_of(int edge, bool last, const Vector2& x) const {
  const Edge& r = edges_[static_cast<std::size_t>(edge)];
  const Ending& end = ends_[static_cast<std::size_t>(edge)][last ? 1 : 0];
  const double inside = r.closed ? std::numeric_limits<double>::infinity() : end.inside(x);
  return {end.place, inside, last ? r.end_sharp : r.start_sharp};
}

bool BodySurface2d::inside(const Vector2& x) const {
  if (!whole_.covers(x, 0)) return false;
  bool odd = false;
  for (const Edge& edge : edges_)
    for (int i = 0; i < edge.count; ++i)
      if (ray_crosses(vertex_.col(edge.vertex + i), vertex_.col(edge.vertex + i + 1), x)) odd = !odd;
  return odd;
}

BodySurface2d::Foot BodySurface2d::nearest(const Vector2& x) const {
  Foot best;
  best.distance = std::numeric_limits<double>::infinity();
  for (const Edge& edge : edges_) {
    for (int i = 0; i < edge.count; ++i) {
      const Vector2 a = vertex_.col(edge.vertex + i), t = vertex_.col(edge.vertex + i + 1) - a;
      const double s = std::clamp((x - a).dot(t) / t.squaredNorm(), 0.0, 1.0);
      const Vector2 foot = a + s * t;
      const double distance = (x - foot).norm();
      if (distance < best.distance) best = {edge.first + i, foot, distance};
    }
  }
  return best;
}

}  // namespace strake::fluid
