#include "coupler/report/outline.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace strake::report {
namespace {

using picture::Place;
using Key = std::pair<std::int64_t, std::int64_t>;  // a corner, rounded so that neighbours agree on it

bool straight(const Place& a, const Place& b, const Place& c) {
  const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - b.x, vy = c.y - b.y;
  return std::abs(ux * vy - uy * vx) <= 1e-3 * std::hypot(ux, uy) * std::hypot(vx, vy) &&
         ux * vx + uy * vy > 0;
}

std::vector<Place> without_straight_corners(const std::vector<Place>& loop) {
  std::vector<Place> kept;
  const std::size_t n = loop.size();
  for (std::size_t i = 0; i < n; ++i)
    if (!straight(loop[(i + n - 1) % n], loop[i], loop[(i + 1) % n])) kept.push_back(loop[i]);
  return kept.size() < 3 ? loop : kept;
}

/// Walks of cells, all counter-clockwise.
std::vector<std::vector<Place>> walks(const picture::Scene& scene) {
  std::vector<std::vector<Place>> walks;
  for (const picture::Patch& patch : scene.cells) {
    if (patch.corner.size() < 3) continue;
    double area = 0;
    for (std::size_t i = 0; i < patch.corner.size(); ++i) {
      const Place &a = patch.corner[i], &b = patch.corner[(i + 1) % patch.corner.size()];
      area += a.x * b.y - a.y * b.x;
    }
    walks.push_back(patch.corner);
    if (area < 0) std::reverse(walks.back().begin(), walks.back().end());
  }
  const double h = 0.5 * scene.solid_spacing;
  for (const picture::Mark& mark : scene.solid)
    walks.push_back({{mark.at.x - h, mark.at.y - h},
                     {mark.at.x + h, mark.at.y - h},
                     {mark.at.x + h, mark.at.y + h},
                     {mark.at.x - h, mark.at.y + h}});
  return walks;
}

/// Two-point cells (the facets of a rigid outline, or their sections) joined end to end, whatever their
/// order.
std::vector<std::vector<Place>> lines(const picture::Scene& scene) {
  double shortest = 1e300;
  for (const picture::Patch& patch : scene.cells)
    if (patch.corner.size() == 2)
      shortest = std::min(shortest, std::max(1e-6, std::hypot(patch.corner[1].x - patch.corner[0].x,
                                                              patch.corner[1].y - patch.corner[0].y)));
  const double grain = 0.1 * shortest;
  const auto key = [&](const Place& p) { return Key(std::llround(p.x / grain), std::llround(p.y / grain)); };
  std::map<Key, Place> corner;
  std::multimap<Key, Key> neighbour;  // both ways
  for (const picture::Patch& patch : scene.cells) {
    if (patch.corner.size() != 2) continue;
    const Key a = key(patch.corner[0]), b = key(patch.corner[1]);
    corner[a] = patch.corner[0];
    corner[b] = patch.corner[1];
    if (a == b) continue;
    neighbour.emplace(a, b);
    neighbour.emplace(b, a);
  }
  const auto take = [&](const Key& from, const Key& to) {
    const auto [begin, end] = neighbour.equal_range(from);
    for (auto it = begin; it != end; ++it)
      if (it->second == to) {
        neighbour.erase(it);
        return;
      }
  };
  std::vector<std::vector<Place>> found;
  while (!neighbour.empty()) {
    std::vector<Place> line;
    for (Key at = neighbour.begin()->first;;) {
      line.push_back(corner[at]);
      const auto step = neighbour.find(at);
      if (step == neighbour.end()) break;
      const Key to = step->second;
      neighbour.erase(step);
      take(to, at);
      at = to;
    }
    if (line.size() >= 3) found.push_back(std::move(line));
  }
  return found;
}

}  // namespace

std::vector<std::vector<Place>> outline(const picture::Scene& scene) {
  const auto cells = walks(scene);
  double shortest = 1e300;
  for (const auto& walk : cells)
    for (std::size_t i = 0; i < walk.size(); ++i) {
      const Place &a = walk[i], &b = walk[(i + 1) % walk.size()];
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      if (length > 0) shortest = std::min(shortest, length);
    }
  const double grain = 0.1 * shortest;
  const auto key = [&](const Place& p) { return Key(std::llround(p.x / grain), std::llround(p.y / grain)); };

  std::map<Key, Place> corner;
  std::map<std::pair<Key, Key>, int> edges;  // walked from a to b
  for (const auto& walk : cells)
    for (std::size_t i = 0; i < walk.size(); ++i) {
      const Place &a = walk[i], &b = walk[(i + 1) % walk.size()];
      corner[key(a)] = a;
      if (key(a) != key(b)) ++edges[{key(a), key(b)}];
    }
  std::multimap<Key, Key> next;
  for (const auto& [edge, times] : edges)
    if (!edges.contains({edge.second, edge.first})) next.emplace(edge.first, edge.second);

  std::vector<std::vector<Place>> loops;
  while (!next.empty()) {
    const Key start = next.begin()->first;
    std::vector<Place> loop;
    for (Key at = start;;) {
      const auto step = next.find(at);
      if (step == next.end()) break;
      loop.push_back(corner[at]);
      at = step->second;
      next.erase(step);
    }
    if (loop.size() >= 3) loops.push_back(without_straight_corners(loop));
  }
  for (auto& line : lines(scene)) loops.push_back(without_straight_corners(line));
  return loops;
}

}  // namespace strake::report
