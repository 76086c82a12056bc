#include "fluid/geometry/body_surface_2d.hpp"
#include "proto/geometry/polygon.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

// Finds which segments cross the outline of a plane body. A pair of water and a layer particle counts where
// it crosses the layer's edge, a pair of water where it crosses none.

namespace strake::fluid {

namespace {

using Vector2 = BodySurface2d::Vector2;

/// A corner whose angle inside the body is smaller has a tip thinner than a spacing along its first piece.
constexpr double sharp_angle = 1.5;  // [rad], 86 degrees
/// Round-off allowance along a piece, as a share of its length.
constexpr double tie = 1e-9;
/// So many pieces of a bent edge are left out together where a pair lies beside them all.
constexpr int block = 16;

/// Returns the length of a string drawn tight from a to b past places of the outline, in its order, with the
/// body on the left: it touches those where it turns to the left.
double tight_string(const Vector2& a, const std::vector<Vector2>& places, const Vector2& b) {
  std::vector<Vector2> string{a};
  const auto reach = [&](const Vector2& x) {
    while (string.size() > 1 && !(cross(string.back() - string[string.size() - 2], x - string.back()) > 0))
      string.pop_back();
    string.push_back(x);
  };
  for (const Vector2& place : places) reach(place);
  reach(b);
  double length = 0;
  for (std::size_t k = 1; k < string.size(); ++k) length += (string[k] - string[k - 1]).norm();
  return length;
}

/// Returns the way from a to b around the knuckles of an edge that the segment crosses twice: that of a tight
/// string past those between the two pieces, of a closed edge the shorter one of both. crossed: the pieces.
double way_around_knuckles(const BodySurface2d::Edge& edge, const BodySurface2d& body,
                           const std::array<int, 2>& crossed, const Vector2& a, const Vector2& b) {
  std::vector<Vector2> between, beyond, before;  // knuckles from piece to piece, behind and before them
  for (std::size_t c = edge.closed ? 0 : 1; c + 1 < edge.stretch.size(); ++c) {
    const int k = edge.stretch[c];
    (k <= crossed[0] ? before : k <= crossed[1] ? between : beyond).push_back(body.vertex(edge.vertex + k));
  }
  const Vector2 start = body.vertex(edge.vertex + crossed[0]),
                along = body.vertex(edge.vertex + crossed[0] + 1) - start;
  const bool in_order = cross(along, a - start) < 0;  // a lies before the first piece
  const Vector2 &first = in_order ? a : b, &last = in_order ? b : a;
  double way = std::numeric_limits<double>::infinity();
  if (!between.empty()) way = tight_string(first, between, last);
  beyond.insert(beyond.end(), before.begin(), before.end());
  if (edge.closed && !beyond.empty()) way = std::min(way, tight_string(last, beyond, first));
  return way;
}

}  // namespace

/// Places the boxes around edges and around blocks of their pieces, and finds the edges whose vertices follow
/// one another evenly along the chord: vertex i within half a piece of i/count of it.
void BodySurface2d::place_boxes() {
  const auto around = [this](int first, int count) {
    const auto own = vertex_.middleCols(first, count + 1);
    return Box{own.rowwise().minCoeff(), own.rowwise().maxCoeff()};
  };
  is_even_.assign(edges_.size(), 0);
  box_.clear();
  block_box_.clear();
  first_block_.clear();
  for (std::size_t r = 0; r < edges_.size(); ++r) {
    const Edge& edge = edges_[r];
    box_.push_back(around(edge.vertex, edge.count));
    whole_ = r == 0 ? box_[0] : Box{whole_.low.cwiseMin(box_[r].low), whole_.high.cwiseMax(box_[r].high)};
    first_block_.push_back(block_box_.size());
    for (int i = 0; i < edge.count; i += block)
      block_box_.push_back(around(edge.vertex + i, std::min(block, edge.count - i)));
    const Vector2 origin = vertex_.col(edge.vertex), chord = vertex_.col(edge.vertex + edge.count) - origin;
    const double piece = chord.squaredNorm() / edge.count;
    bool even = !edge.closed && edge.count > 4 && piece > 0;
    for (int i = 1; even && i < edge.count; ++i)
      even = std::abs((vertex_.col(edge.vertex + i) - origin).dot(chord) / piece - i) <= 0.5;
    is_even_[r] = even ? 1 : 0;
  }
}

/// Returns the pieces of an edge that the segment a–b may cross: the first one, and the one behind the last.
/// The chord of an even edge orders them. Of a bent one all count.
std::pair<int, int> BodySurface2d::pieces_beside(int r, const Vector2& a, const Vector2& b) const {
  const Edge& edge = edges_[static_cast<std::size_t>(r)];
  if (!is_even_[static_cast<std::size_t>(r)]) return {0, edge.count};
  const Vector2 origin = vertex_.col(edge.vertex);
  const Vector2 chord = vertex_.col(edge.vertex + edge.count) - origin;
  const double chord2 = chord.squaredNorm(), last = edge.count;
  const double sa = (a - origin).dot(chord) / chord2 * edge.count;
  const double sb = (b - origin).dot(chord) / chord2 * edge.count;
  return {static_cast<int>(std::clamp(std::floor(std::min(sa, sb)) - 1, 0.0, last)),
          static_cast<int>(std::clamp(std::ceil(std::max(sa, sb)) + 1, 0.0, last))};
}

bool BodySurface2d::crosses_edge(int r, const Vector2& a, const Vector2& b, Corners corners,
                                 int before) const {
  const Box pair{a.cwiseMin(b), a.cwiseMax(b)};
  const auto k = static_cast<std::size_t>(r);
  if (!pair.meets(box_[k])) return false;
  const Edge& edge = edges_[k];
  auto [begin, end] = pieces_beside(r, a, b);
  if (corners == Corners::without_tips && !edge.closed) {
    if (edge.start_angle < sharp_angle) begin = std::max(begin, 1);
    if (edge.end_angle < sharp_angle) end = std::min(end, edge.count - 1);
  }
  const bool owned = corners == Corners::owned && !edge.closed, bends = before >= 0 && !edge.plane;
  for (int i = begin; i < end; ++i) {
    if (!is_even_[k] && i % block == 0 &&
        !pair.meets(block_box_[first_block_[k] + static_cast<std::size_t>(i / block)])) {
      i += block - 1;
      continue;
    }
    if (bends && !(normal_.col(edge.first + i).dot(normal_.col(before)) > 0)) continue;
    const bool from_corner = owned && i == 0 && !edge.owns_start;
    const bool to_corner = owned && i == edge.count - 1 && !edge.owns_end;
    if (crosses_piece(edge.vertex + i, a, b, from_corner ? tie : -tie, to_corner ? 1 - tie : 1 + tie))
      return true;
  }
  return false;
}

/// Whether a–b crosses the piece behind that vertex, between two places along it [its length].
bool BodySurface2d::crosses_piece(int vertex, const Vector2& a, const Vector2& b, double from,
                                  double to) const {
  const Vector2 v = vertex_.col(vertex), e = vertex_.col(vertex + 1) - v, d = b - a;
  const double det = cross(d, e);
  if (det == 0) return false;  // parallel lines do not cross
  const Vector2 to_start = v - a;
  const double t = cross(to_start, e) / det;  // along the pair
  if (t < 0 || t > 1) return false;
  const double s = cross(to_start, d) / det;  // along the piece
  return s >= from && s <= to;
}

bool BodySurface2d::separates(const Vector2& a, const Vector2& b) const {
  for (int r = 0; r < static_cast<int>(edges_.size()); ++r)
    if (crosses_edge(r, a, b, Corners::without_tips)) return true;
  return false;
}

double BodySurface2d::way_around(const Vector2& a, const Vector2& b) const {
  constexpr double none = std::numeric_limits<double>::infinity();
  int first = -1, second = -1;
  for (int r = 0; r < static_cast<int>(edges_.size()); ++r) {
    if (!crosses_edge(r, a, b, Corners::all)) continue;
    if (second >= 0) return none;
    (first < 0 ? first : second) = r;
  }
  if (first < 0) return (b - a).norm();
  if (second < 0) {
    const Edge& edge = edges_[static_cast<std::size_t>(first)];
    if (edge.stretch.size() < 3) return none;  // it has no knuckles
    std::array<int, 2> crossed{};
    std::size_t count = 0;
    for (auto [i, end] = pieces_beside(first, a, b); i < end; ++i) {
      if (!crosses_piece(edge.vertex + i, a, b, -tie, 1 + tie)) continue;
      if (count == 2) return none;
      crossed[count++] = i;
    }
    return count == 2 ? way_around_knuckles(edge, *this, crossed, a, b) : none;
  }
  double way = none;
  for (const auto& [from, to] : {std::pair(first, second), std::pair(second, first)}) {
    const Edge& edge = edges_[static_cast<std::size_t>(from)];
    if (edge.next != to) continue;
    const Vector2 corner = vertex_.col(edge.vertex + edge.count);
    way = std::min(way, (a - corner).norm() + (b - corner).norm());
  }
  return way;
}

}  // namespace strake::fluid
