#include "fluid/geometry/body_surface_2d.hpp"

#include "proto/error.hpp"
#include "proto/geometry/corner.hpp"
#include "proto/geometry/polygon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::fluid {

namespace {

using Vector2 = BodySurface2d::Vector2;

/// A corner whose angle inside the body is smaller has a tip thinner than a spacing along its first piece.
constexpr double sharp_angle = 1.5;  // [rad], 86 degrees
/// Round-off allowance along a piece, as a share of its length.
constexpr double tie = 1e-9;

/// Returns the normal to the right of t. It points into the fluid where the body is followed
/// counter-clockwise.
Vector2 right_of(const Vector2& t) {
  return {t.y(), -t.x()};
}

/// Returns the closed chains of segments, as lists of point indices.
std::vector<std::vector<int>> loops_of(const InterfaceMesh& partner) {
  const auto n = static_cast<std::size_t>(partner.position.cols());
  std::vector<int> next(n, -1);
  std::vector<char> entered(n, 0);
  for (Eigen::Index f = 0; f < partner.faces.cols(); ++f) {
    const int a = partner.faces(0, f), b = partner.faces(1, f);
    if (next[static_cast<std::size_t>(a)] >= 0 || entered[static_cast<std::size_t>(b)])
      throw Error(ExitCode::case_file, fmt::format("interface \"{}\"", partner.name),
                  fmt::format("more than two faces meet at point {} or {}", a, b),
                  "give the wet surface as closed chains of segments, each walked counter-clockwise");
    next[static_cast<std::size_t>(a)] = b;
    entered[static_cast<std::size_t>(b)] = 1;
  }
  std::vector<std::vector<int>> loops;
  for (std::size_t p = 0; p < n; ++p) {
    if (next[p] < 0) continue;
    std::vector<int> loop;
    for (int at = static_cast<int>(p); next[static_cast<std::size_t>(at)] >= 0;) {
      loop.push_back(at);
      const int to = next[static_cast<std::size_t>(at)];
      next[static_cast<std::size_t>(at)] = -1;
      at = to;
      if (at != static_cast<int>(p) && next[static_cast<std::size_t>(at)] < 0)
        throw Error(ExitCode::case_file, fmt::format("interface \"{}\"", partner.name),
                    fmt::format("the wet surface ends at point {} instead of closing", at),
                    "the fluid needs to know inside from outside: close the outline");
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace

BodySurface2d::BodySurface2d(const InterfaceMesh& partner, double spacing) {
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
                  fmt::format("the outline that starts at point {} encloses {} m^2", loop.front(), area),
                  "walk it counter-clockwise, so that its normals point into the fluid");
    add_edges(partner, loop, spacing);
  }
  const auto m = reference_.cols();
  mesh_.position = Points::Zero(3, m);
  mesh_.position.topRows<2>() = reference_;
  point_ = velocity_ = normal_ = normal_rate_ = Vectors2::Zero(2, m);
  area_ = Eigen::VectorXd::Zero(m);
  move(Vectors2::Zero(2, m), Vectors2::Zero(2, m));
}

void BodySurface2d::add_edges(const InterfaceMesh& partner, const std::vector<int>& loop, double spacing) {
  const std::size_t n = loop.size();
  const auto at = [&](std::size_t k) -> Vector2 { return partner.position.col(loop[k % n]).head<2>(); };
  std::vector<double> angle(n);
  for (std::size_t k = 0; k < n; ++k) angle[k] = turn(at(k) - at(k + n - 1), at(k + 1) - at(k));
  std::vector<std::size_t> corners;
  for (std::size_t k = 0; k < n; ++k) {
    const double beside = std::max(std::abs(angle[(k + n - 1) % n]), std::abs(angle[(k + 1) % n]));
    if (is_corner(std::abs(angle[k]), beside)) corners.push_back(k);
  }
  const bool closed = corners.empty();
  if (closed) corners.push_back(0);

  const std::size_t first_edge = edges_.size();
  std::vector<Eigen::Vector2i> faces;
  const int first_point = points();
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::size_t begin = corners[c];
    const std::size_t end = c + 1 < corners.size() ? corners[c + 1] : corners[0] + n;
    std::vector<double> length{0};  // along the edge, at each of its points [m]
    Edge edge;
    for (std::size_t k = begin; k < end; ++k) {
      length.push_back(length.back() + (at(k + 1) - at(k)).norm());
      edge.curved = edge.curved || (k > begin && std::abs(angle[k % n]) > flat_angle);
    }
    edge.first = points();
    edge.count = std::max(1, static_cast<int>(std::lround(length.back() / spacing)));
    if (closed) edge.count = std::max(3, edge.count);
    edge.vertex = edge.first + static_cast<int>(edges_.size());
    edge.closed = closed;
    if (!closed) {
      edge.start_angle = std::numbers::pi - angle[begin];
      edge.end_angle = std::numbers::pi - angle[end % n];
      const auto down = [&](std::size_t k) {  // the normal of a piece is (t.y, −t.x)
        return (at(k + 1) - at(k)).normalized().x();
      };
      edge.start_sharp = is_sharp_corner(edge.start_angle, down(begin + n - 1), down(begin));
      edge.end_sharp = is_sharp_corner(edge.end_angle, down(end + n - 1), down(end));
    }
    edge.piece = length.back() / edge.count;
    reference_.conservativeResize(2, edge.first + edge.count);
    half_piece_.conservativeResize(2, edge.first + edge.count);
    for (int i = 0; i < edge.count; ++i) {
      const double s = (i + 0.5) * edge.piece;
      const auto piece = static_cast<std::size_t>(std::upper_bound(length.begin() + 1, length.end() - 1, s) -
                                                  length.begin() - 1);
      const Vector2 a = at(begin + piece), b = at(begin + piece + 1);
      const double share = (s - length[piece]) / (length[piece + 1] - length[piece]);
      reference_.col(edge.first + i) = a + share * (b - a);
      half_piece_.col(edge.first + i) = 0.5 * edge.piece * (b - a).normalized();
      edge_of_.push_back(static_cast<int>(edges_.size()));
    }
    edges_.push_back(edge);
  }
  connect(first_edge);
  const int m = points() - first_point;
  const auto old = mesh_.faces.cols();
  mesh_.faces.conservativeResize(2, old + m);
  for (int k = 0; k < m; ++k) mesh_.faces.col(old + k) << first_point + k, first_point + (k + 1) % m;
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

void BodySurface2d::move(const Vectors2& displacement, const Vectors2& velocity) {
  point_ = reference_ + displacement;
  velocity_ = velocity;
  const auto vertices = static_cast<Eigen::Index>(points()) + static_cast<Eigen::Index>(edges_.size());
  vertex_.resize(2, vertices);
  vertex_velocity_.resize(2, vertices);
  const auto set = [this](const Edge& edge, const Vectors2& from, Vectors2& to, bool is_position) {
    for (int i = 1; i < edge.count; ++i)
      to.col(edge.vertex + i) = 0.5 * (from.col(edge.first + i - 1) + from.col(edge.first + i));
    const int a = edge.first, b = edge.first + edge.count - 1;
    if (edge.closed) {
      to.col(edge.vertex) = to.col(edge.vertex + edge.count) = 0.5 * (from.col(a) + from.col(b));
    } else if (edge.count > 1) {
      to.col(edge.vertex) = 1.5 * from.col(a) - 0.5 * from.col(a + 1);
      to.col(edge.vertex + edge.count) = 1.5 * from.col(b) - 0.5 * from.col(b - 1);
    } else {
      const Vector2 half = is_position ? Vector2(half_piece_.col(a)) : Vector2(Vector2::Zero());
      to.col(edge.vertex) = from.col(a) - half;
      to.col(edge.vertex + 1) = from.col(a) + half;
    }
  };
  for (const Edge& edge : edges_) {
    set(edge, point_, vertex_, true);
    set(edge, velocity_, vertex_velocity_, false);
  }
  // The corner between two edges is the mean of both extrapolations. An edge of one point has no direction,
  // so its extrapolation does not count.
  for (const Edge& edge : edges_) {
    if (edge.closed) continue;
    const Edge& next = edges_[static_cast<std::size_t>(edge.next)];
    const int end = edge.vertex + edge.count;
    const double mine = edge.count > 1 || next.count == 1 ? 1.0 : 0.0;
    const double theirs = next.count > 1 || edge.count == 1 ? 1.0 : 0.0;
    for (Vectors2* values : {&vertex_, &vertex_velocity_}) {
      const Vector2 corner = (mine * values->col(end) + theirs * values->col(next.vertex)) / (mine + theirs);
      values->col(end) = values->col(next.vertex) = corner;
    }
  }
  ends_.resize(edges_.size());
  for (std::size_t r = 0; r < edges_.size(); ++r)
    for (const bool last : {false, true}) {
      const int at = edges_[r].vertex + (last ? edges_[r].count : 0);
      const Vector2 place = vertex_.col(at), inwards = vertex_.col(last ? at - 1 : at + 1) - place;
      ends_[r][last ? 1 : 0] = {place, inwards, inwards.norm()};
    }
  meet_at_bisectors();
  run_low_.resize(2, static_cast<Eigen::Index>(edges_.size()));
  run_high_.resize(2, static_cast<Eigen::Index>(edges_.size()));
  for (std::size_t r = 0; r < edges_.size(); ++r) {
    const Edge& edge = edges_[r];
    const auto own = vertex_.middleCols(edge.vertex, edge.count + 1);
    run_low_.col(static_cast<Eigen::Index>(r)) = own.rowwise().minCoeff();
    run_high_.col(static_cast<Eigen::Index>(r)) = own.rowwise().maxCoeff();
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
  if (!edges_.empty()) {
    low_ = run_low_.rowwise().minCoeff();
    high_ = run_high_.rowwise().maxCoeff();
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
      own = {own.place, across, direction.dot(across)};
    }
}

bool BodySurface2d::crosses(int r, const Vector2& a, const Vector2& b, Corners corners) const {
  if (std::max(a.x(), b.x()) < run_low_(0, r) || std::min(a.x(), b.x()) > run_high_(0, r) ||
      std::max(a.y(), b.y()) < run_low_(1, r) || std::min(a.y(), b.y()) > run_high_(1, r))
    return false;
  const Edge& edge = edges_[static_cast<std::size_t>(r)];
  const Vector2 d = b - a;
  int begin = 0, end = edge.count;
  // Only the pieces beside the pair are tested. The chord of an open edge orders them.
  const Vector2 origin = vertex_.col(edge.vertex);
  const Vector2 chord = vertex_.col(edge.vertex + edge.count) - origin;
  const double chord2 = chord.squaredNorm();
  if (!edge.closed && edge.count > 4 && chord2 > 0) {
    const double sa = (a - origin).dot(chord) / chord2 * edge.count;
    const double sb = (b - origin).dot(chord) / chord2 * edge.count;
    const double last = edge.count;
    begin = static_cast<int>(std::clamp(std::floor(std::min(sa, sb)) - 1, 0.0, last));
    end = static_cast<int>(std::clamp(std::ceil(std::max(sa, sb)) + 1, 0.0, last));
  }
  if (corners == Corners::without_tips && !edge.closed) {
    if (edge.start_angle < sharp_angle) begin = std::max(begin, 1);
    if (edge.end_angle < sharp_angle) end = std::min(end, edge.count - 1);
  }
  for (int i = begin; i < end; ++i) {
    const Vector2 v = vertex_.col(edge.vertex + i);
    const Vector2 e = vertex_.col(edge.vertex + i + 1) - v;
    const double det = cross(d, e);
    if (det == 0) continue;  // parallel lines do not cross
    const Vector2 to_start = v - a;
    const double t = cross(to_start, e) / det;  // along the pair
    if (t < 0 || t > 1) continue;
    const double s = cross(to_start, d) / det;  // along the piece
    const bool owned = corners == Corners::owned && !edge.closed;
    const bool from_corner = owned && i == 0 && !edge.owns_start;
    const bool to_corner = owned && i == edge.count - 1 && !edge.owns_end;
    if (s >= (from_corner ? tie : -tie) && s <= (to_corner ? 1 - tie : 1 + tie)) return true;
  }
  return false;
}

bool BodySurface2d::separates(const Vector2& a, const Vector2& b) const {
  for (int r = 0; r < static_cast<int>(edges_.size()); ++r)
    if (crosses(r, a, b, Corners::without_tips)) return true;
  return false;
}

double BodySurface2d::way_around(const Vector2& a, const Vector2& b) const {
  constexpr double none = std::numeric_limits<double>::infinity();
  int first = -1, second = -1;
  for (int r = 0; r < static_cast<int>(edges_.size()); ++r) {
    if (!crosses(r, a, b, Corners::all)) continue;
    if (second >= 0) return none;
    (first < 0 ? first : second) = r;
  }
  if (first < 0) return (b - a).norm();
  if (second < 0) return none;
  double way = none;
  for (const auto& [from, to] : {std::pair(first, second), std::pair(second, first)}) {
    const Edge& edge = edges_[static_cast<std::size_t>(from)];
    if (edge.next != to) continue;
    const Vector2 corner = vertex_.col(edge.vertex + edge.count);
    way = std::min(way, (a - corner).norm() + (b - corner).norm());
  }
  return way;
}

bool BodySurface2d::beside_corner(const Vector2& x, double distance) const {
  if ((x.array() < low_.array() - distance).any() || (x.array() > high_.array() + distance).any())
    return false;
  return std::ranges::any_of(edges_, [&](const Edge& edge) {
    return !edge.closed && (vertex_.col(edge.vertex) - x).squaredNorm() < distance * distance;
  });
}

bool BodySurface2d::is_between_sharp_corners(int edge) const {
  const Edge& r = edges_[static_cast<std::size_t>(edge)];
  return r.start_sharp && r.end_sharp;
}

BodySurface2d::End BodySurface2d::end_of(int edge, bool last, const Vector2& x) const {
  const Edge& r = edges_[static_cast<std::size_t>(edge)];
  const Ending& end = ends_[static_cast<std::size_t>(edge)][last ? 1 : 0];
  return {end.place, end.inside(x), last ? r.end_sharp : r.start_sharp};
}

bool BodySurface2d::inside(const Vector2& x) const {
  if ((x.array() < low_.array()).any() || (x.array() > high_.array()).any()) return false;
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
