#include "proto/geometry/thinning.hpp"

#include "proto/geometry/corner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace strake {
namespace {

using Vector2 = Eigen::Vector2d;

/// How far an outline may move where points are left out [spacings]. Chosen; sides of a round of 15 spacings
/// are then about as long as a spacing. Of a zigzag: offsets to 1 mm at spacings of 10 mm.
constexpr double tolerance = 0.01, of_zigzag = 0.1;
/// Longest side in place of a zigzag [spacings].
constexpr double longest = 1;
/// Largest turn of points that are made one corner [rad]. The two corners of a plate's end turn by more.
constexpr double sharpest_end = 2.6;
/// Two lengths that differ by less are equal [spacings].
constexpr double tie = 1e-9;

/// The sides of an outline, and its turns.
struct Sides {
  explicit Sides(const Polygon& p) : length(p.size()), turn(p.size()) {
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vector2 before = p[i] - p[(i + p.size() - 1) % p.size()], on = following(p, i) - p[i];
      length[i] = on.norm();
      turn[i] = strake::turn(before, on);
    }
  }
  std::size_t before(std::size_t i) const { return (i + length.size() - 1) % length.size(); }
  std::size_t after(std::size_t i) const { return (i + 1) % length.size(); }
  /// Whether the outline turns there by more than 20 degrees to half a spacing, `half`.
  bool is_tight(std::size_t i, double half) const {
    const double beside = std::min({half, length[before(i)], length[i]});
    return std::abs(turn[i]) * half > corner_angle * beside;
  }
  std::vector<double> length, turn;  // from each point to the next [m]; at each point [rad]
};

/// The place where the sides before point i and behind point j meet, if it lies before both; else no number.
Vector2 meeting(const Polygon& p, std::size_t i, std::size_t j) {
  const Vector2 in = p[i] - p[(i + p.size() - 1) % p.size()], out = following(p, j) - p[j], r = p[j] - p[i];
  const double det = cross(in, out), s = cross(r, out) / det, t = cross(r, in) / det;
  return s >= 0 && t <= 0 ? Vector2(p[i] + s * in)
                          : Vector2(Vector2::Constant(std::numeric_limits<double>::quiet_NaN()));
}

/// Makes points that turn one way within half a spacing a corner.
Polygon with_corners(const Polygon& p, double half) {
  const Sides sides(p);
  const std::size_t n = p.size();
  const auto goes_on = [&](std::size_t i) {  // from point i to the next one
    const std::size_t k = sides.after(i);
    return sides.length[i] < half && sides.is_tight(i, half) && sides.is_tight(k, half) &&
           sides.turn[i] * sides.turn[k] > 0;
  };
  std::size_t first = 0;
  while (first < n && goes_on(sides.before(first))) ++first;
  if (first == n) return p;
  Polygon kept;
  bool found = false;
  for (std::size_t passed = 0; passed < n;) {
    const std::size_t i = (first + passed) % n;
    std::size_t count = 1;
    double length = 0, turned = sides.turn[i];
    for (std::size_t k = i; goes_on(k) && count < n; k = sides.after(k), ++count) {
      length += sides.length[k];
      turned += sides.turn[sides.after(k)];
    }
    const std::size_t j = (i + count - 1) % n;
    passed += count;
    if (count > 1 && length <= half && std::abs(turned) < sharpest_end)
      if (const Vector2 corner = meeting(p, i, j); (corner - 0.5 * (p[i] + p[j])).norm() <= 0.5 * half) {
        kept.push_back(corner);
        found = true;
        continue;
      }
    for (std::size_t k = 0; k < count; ++k) kept.push_back(p[(i + k) % n]);
  }
  return found ? kept : p;
}

/// Leaves out points between those that are kept, after Douglas and Peucker.
class Thinning {
 public:
  /// within: how far the outline may move; longest: of a side that replaces others; equal: lengths [m].
  Thinning(const Polygon& p, std::vector<char> kept, double within, double longest, double equal)
      : p_(p), kept_(std::move(kept)), within_(within), longest_(longest), equal_(equal) {}

  Polygon run() {
    const std::size_t n = p_.size();
    if (std::ranges::none_of(kept_, [](char c) { return c != 0; })) keep_lowest_and_highest();
    std::vector<std::size_t> stop;
    for (std::size_t i = 0; i < n; ++i)
      if (kept_[i]) stop.push_back(i);
    for (std::size_t k = 0; k < stop.size(); ++k)
      spans_.emplace_back(stop[k], k + 1 < stop.size() ? stop[k + 1] : stop[0] + n);
    while (!spans_.empty()) {
      const auto [a, b] = spans_.back();
      spans_.pop_back();
      divide(a, b);
    }
    Polygon left;
    for (std::size_t i = 0; i < n; ++i)
      if (kept_[i]) left.push_back(p_[i]);
    return left;
  }

 private:
  const Vector2& at(std::size_t i) const { return p_[i % p_.size()]; }

  void keep_lowest_and_highest() {
    const auto [low, high] = std::ranges::minmax(p_, {}, [](const Vector2& x) { return x.y(); });
    for (std::size_t i = 0; i < p_.size(); ++i)
      kept_[i] = p_[i].y() <= low.y() + equal_ || p_[i].y() >= high.y() - equal_ ? 1 : 0;
  }

  /// The points within a span of which a value is largest: of two that mirror one another both, of others
  /// alike the lower one.
  struct Largest {
    double value = -std::numeric_limits<double>::infinity();
    std::size_t first, last;
  };
  template <class Value>
  Largest largest(std::size_t a, std::size_t b, const Value& value) const {
    Largest found{.first = a + 1, .last = a + 1};
    for (std::size_t i = a + 1; i < b; ++i) {
      const double own = value(at(i));
      if (own > found.value + equal_) found.first = i;
      if (own > found.value - equal_) found.last = i;
      found.value = std::max(found.value, own);
    }
    const double rise = at(found.last).y() - at(found.first).y();
    if (rise > equal_) found.last = found.first;
    if (rise < -equal_) found.first = found.last;
    return found;
  }

  /// Keeps the point of a span that is farthest from its chord. Where all are near and the chord is long, it
  /// keeps the one nearest to the chord's middle.
  void divide(std::size_t a, std::size_t b) {
    if (b < a + 2) return;
    const Vector2 from = at(a), chord = at(b) - from;
    Largest kept = largest(a, b, [&](const Vector2& x) {
      const double length2 = chord.squaredNorm(),
                   s = length2 > 0 ? std::clamp((x - from).dot(chord) / length2, 0.0, 1.0) : 0;
      return (x - from - s * chord).norm();
    });
    if (kept.value <= within_) {
      if (chord.norm() <= longest_) return;
      kept = largest(a, b, [&](const Vector2& x) { return -(x - from - 0.5 * chord).norm(); });
    }
    for (const std::size_t i : {kept.first, kept.last}) kept_[i % p_.size()] = 1;
    spans_.emplace_back(a, kept.first);
    spans_.emplace_back(kept.first, kept.last);
    spans_.emplace_back(kept.last, b);
  }

  const Polygon& p_;
  std::vector<char> kept_;
  double within_, longest_, equal_;
  std::vector<std::pair<std::size_t, std::size_t>> spans_;
};

/// Thins the outline beside its short sides: everywhere, or where it zigzags.
Polygon thin(const Polygon& p, double spacing, bool zigzags) {
  const Sides sides(p);
  const double half = short_side * spacing;
  const auto turns_back = [&](std::size_t i) {
    return sides.is_tight(i, half) && (sides.turn[i] * sides.turn[sides.before(i)] < 0 ||
                                       sides.turn[i] * sides.turn[sides.after(i)] < 0);
  };
  std::vector<char> kept(p.size(), 1);
  for (std::size_t i = 0; i < p.size(); ++i)
    if (std::min(sides.length[sides.before(i)], sides.length[i]) < half && (!zigzags || turns_back(i)))
      kept[i] = 0;
  return Thinning(p, std::move(kept), (zigzags ? of_zigzag : tolerance) * spacing,
                  zigzags ? longest * spacing : std::numeric_limits<double>::infinity(), tie * spacing)
      .run();
}

bool has_short_sides(const Polygon& p, double spacing) {
  return std::ranges::any_of(Sides(p).length, [&](double side) { return side < short_side * spacing; });
}

bool encloses(const Polygon& p) {
  return p.size() > 2 && polygon_area(p) > 0;
}

}  // namespace

Polygon without_details(const Polygon& p, double spacing) {
  if (!has_short_sides(p, spacing)) return p;
  Polygon plain = with_corners(p, short_side * spacing);
  for (bool fewer = true; fewer && encloses(plain);) {
    Polygon next = thin(plain, spacing, true);
    fewer = next.size() < plain.size();
    plain = std::move(next);
  }
  return encloses(plain) ? plain : p;
}

Polygon thinned(const Polygon& p, double spacing) {
  if (!has_short_sides(p, spacing)) return p;
  Polygon fewer = thin(without_details(p, spacing), spacing, false);
  return encloses(fewer) ? fewer : p;
}

}  // namespace strake
