#include "coupler/report/sketch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

namespace strake::report {
namespace {

using picture::Place;
using Key = std::pair<std::int64_t, std::int64_t>;  // a corner, rounded so that neighbours agree on it

/// Edges between corners; corners nearer than a tenth of the shortest edge are one.
class Edges {
 public:
  explicit Edges(double shortest) : grain_(0.1 * shortest) {}
  void add(const Place& a, const Place& b) {
    const Key from = key(a), to = key(b);
    corner_[from] = a;
    corner_[to] = b;
    if (from != to) edges_.emplace(from, to);
  }
  /// Leaves out what two cells walk, each its way: that lies inside.
  void drop_inner() {
    const auto all = edges_;
    std::erase_if(edges_, [&](const auto& edge) { return all.contains({edge.second, edge.first}); });
  }
  /// Chains of edges end to end, of three corners or more. both_ways: an edge may be walked from either end.
  std::vector<std::vector<Place>> chains(bool both_ways) {
    std::multimap<Key, Key> next;
    for (const auto& [from, to] : edges_) {
      next.emplace(from, to);
      if (both_ways) next.emplace(to, from);
    }
    std::vector<std::vector<Place>> found;
    while (!next.empty()) {
      std::vector<Place> chain;
      for (Key at = next.begin()->first;;) {
        const auto step = next.find(at);
        if (step == next.end()) {
          if (both_ways) chain.push_back(corner_[at]);
          break;
        }
        chain.push_back(corner_[at]);
        const Key to = step->second;
        next.erase(step);
        if (both_ways) drop(next, to, at);
        at = to;
      }
      if (chain.size() >= 3) found.push_back(std::move(chain));
    }
    return found;
  }

 private:
  Key key(const Place& p) const { return {std::llround(p.x / grain_), std::llround(p.y / grain_)}; }
  static void drop(std::multimap<Key, Key>& next, const Key& from, const Key& to) {
    const auto [begin, end] = next.equal_range(from);
    const auto found = std::find_if(begin, end, [&](const auto& edge) { return edge.second == to; });
    if (found != end) next.erase(found);
  }
  double grain_;
  std::map<Key, Place> corner_;
  std::set<std::pair<Key, Key>> edges_;  // walked from a to b
};

double length(const Place& a, const Place& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

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

}  // namespace

std::vector<std::vector<Place>> outline(const picture::Scene& scene) {
  const auto cells = walks(scene);
  double shortest = 1e300, shortest_line = 1e300;
  for (const auto& walk : cells)
    for (std::size_t i = 0; i < walk.size(); ++i)
      if (const double l = length(walk[i], walk[(i + 1) % walk.size()]); l > 0)
        shortest = std::min(shortest, l);
  for (const picture::Patch& patch : scene.cells)
    if (patch.corner.size() == 2)
      shortest_line = std::min(shortest_line, std::max(1e-6, length(patch.corner[0], patch.corner[1])));

  Edges around(shortest), lines(shortest_line);
  for (const auto& walk : cells)
    for (std::size_t i = 0; i < walk.size(); ++i) around.add(walk[i], walk[(i + 1) % walk.size()]);
  around.drop_inner();
  // The facets of a rigid outline, or their sections, in whatever order they come.
  for (const picture::Patch& patch : scene.cells)
    if (patch.corner.size() == 2) lines.add(patch.corner[0], patch.corner[1]);

  std::vector<std::vector<Place>> loops;
  for (const auto& chain : around.chains(false)) loops.push_back(without_straight_corners(chain));
  for (const auto& chain : lines.chains(true)) loops.push_back(without_straight_corners(chain));
  return loops;
}

}  // namespace strake::report
