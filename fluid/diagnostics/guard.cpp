#include "fluid/diagnostics/guard.hpp"

#include "fluid/particles/archive_member.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace strake::fluid {
namespace {

constexpr double margin = 1.3;         // what the bounds of speed and pressure leave to scatter
constexpr double graze = 0.1;          // sine of the angle under which a jet may meet a bent face
constexpr double reach = 1.5;          // [l0] around a piece, over which the slope of a face is averaged
constexpr double under = 2;            // [l0] below the still level from where on a pushing face must be wet
constexpr double least_part = 0.25;    // of the faces under water, that must push it to be judged
constexpr double least_load = 0.1;     // of ρgd, below which such faces have lost their water
constexpr double least_wet = 0.05;     // of their area, likewise where there is no gravity
constexpr double longest_path = 2;     // [l0] that they may advance without water, and
constexpr double trough = 0.25;        // [a] likewise: a body that falls back may meet its own trough
constexpr double echoes = 4;           // [H/c] after which the weight of compressible water rests on a body
constexpr double most_momentum = 0.1;  // these three are bounds of coupler/summary/check_grades.cpp as well
constexpr double most_volume = 0.05;
constexpr double most_openings = 0.02;

void raise(GuardRecord& record, Alarm kind, const Extreme& extreme, double bound) {
  if (record.raised(kind)) return;
  record.alarm.col(static_cast<int>(kind)) << extreme.time, extreme.at, extreme.value, bound, extreme.step;
}

/// An extreme of the whole water, which has no place.
Extreme of_all(double t, double value) {
  return {.value = value, .at = Eigen::Vector3d::Constant(std::nan("")), .time = t, .step = 0};
}

}  // namespace

Eigen::Matrix<double, 7, alarm_kinds> GuardRecord::none() {
  Eigen::Matrix<double, 7, alarm_kinds> alarm = Eigen::Matrix<double, 7, alarm_kinds>::Zero();
  alarm.row(0).setConstant(-1);
  return alarm;
}

void save(const GuardRecord& record, Archive& archive) {
  for_each_member(
      GuardRecord::values(),
      [&](const char* name, const auto& value) { put(archive, std::string("guard.") + name, value); },
      record);
}

GuardRecord load_guard(const Archive& archive) {
  GuardRecord record;
  if (!archive.real.contains("guard.alarm")) return record;
  for_each_member(
      GuardRecord::values(),
      [&](const char* name, auto& value) { get(archive, std::string("guard.") + name, value); }, record);
  return record;
}

Guard::Guard(const GuardScales& scales) : scales_(scales) {}

/// Computes the speed of the jet that a face throws:
///   J = min(π v_n / max(sin β, l0/(2a)), max(2√(2 c v_n), π v_n)).
/// Contact runs along the face with (π/2) v_n / sin β, and the jet with twice that (Wagner 1932; for a wedge
/// π V / tan β). Particles do not show a slope that rises by less than l0/2 over the half width a. The
/// pressure is at most ρ c v_n. It makes √(2 c v_n) against the contact, which runs as fast (Bernoulli).
double Guard::jet(double normal_speed, double sine) const {
  if (!(normal_speed > 0)) return 0;
  const double least = scales_.half_width > 0 ? std::min(1.0, 0.5 * scales_.spacing / scales_.half_width) : 1;
  const double flow = std::numbers::pi * normal_speed;
  return std::min(flow / std::max(sine, least),
                  std::max(2 * std::sqrt(2 * scales_.sound_speed * normal_speed), flow));
}

/// Computes 1.3 √(J² + π² (V_tank² + U² + 4 g H)). U is the speed that the case gives the water at the start.
/// 2√(gH) is the front of a dam break (Ritter 1892), the fastest that gravity makes of water of that height.
/// What it meets throws it aside with π times its speed at most, as an upright face does that moves (Wagner,
/// sin β = 1); so do the walls of a tank that moves.
double Guard::speed_bound(const GuardRecord& record) const {
  const double meets = scales_.tank_speed * scales_.tank_speed + scales_.water_speed * scales_.water_speed +
                       4 * scales_.gravity * scales_.drop;
  return margin * std::sqrt(record.jet * record.jet + std::numbers::pi * std::numbers::pi * meets);
}

/// Computes 1.3 ρ c' (π/2 v_n + 0.1 J + U + 2√(gH)) + ρgH. A face that meets water gets at most what sound
/// carries away (von Karman 1929). The water that piles up before the face comes towards it: they meet with
/// π/2 v_n (Wagner). A jet meets a face again where that is bent or has facets, under some six degrees. A
/// step Δt of incompressible water crosses the half width a: c' = min(c, a/Δt).
double Guard::pressure_bound(const GuardRecord& record, double step) const {
  const GuardScales& s = scales_;
  if (!(s.half_width > 0)) return 0;
  const double signal = step > 0 ? std::min(s.sound_speed, s.half_width / step) : s.sound_speed;
  const double speed = 0.5 * std::numbers::pi * record.normal_speed + graze * record.jet + s.water_speed +
                       2 * std::sqrt(s.gravity * s.drop);
  return margin * s.density * signal * speed + s.density * s.gravity * s.drop;
}

/// Finds the pieces near each other along x, then by their distance.
void Guard::find_neighbours(const std::vector<FacePiece>& pieces) {
  beside_.assign(pieces.size(), {});
  std::vector<int> order(pieces.size());
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](int k) -> const Eigen::Vector3d& { return pieces[static_cast<std::size_t>(k)].at; };
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return place(i).x() < place(j).x(); });
  const double r = reach * scales_.spacing;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i; j < order.size() && place(order[j]).x() - place(order[i]).x() <= r; ++j) {
      if ((place(order[i]) - place(order[j])).squaredNorm() > r * r) continue;
      beside_[static_cast<std::size_t>(order[i])].push_back(order[j]);
      if (i != j) beside_[static_cast<std::size_t>(order[j])].push_back(order[i]);
    }
}

/// Takes sin β as the mean over the pieces near by, so that a keel has the slope of its sides, and a round
/// bottom the slope that it has a spacing away.
void Guard::faces(GuardRecord& record, const std::vector<FacePiece>& pieces) {
  if (beside_.size() != pieces.size()) find_neighbours(pieces);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const double push = pieces[i].velocity.dot(pieces[i].normal);
    if (push <= 0) continue;
    record.normal_speed = std::max(record.normal_speed, push);
    double sine = 0, area = 0;
    for (const int j : beside_[i]) {
      const FacePiece& other = pieces[static_cast<std::size_t>(j)];
      sine += other.area * std::sqrt(std::max(0.0, 1 - other.normal.y() * other.normal.y()));
      area += other.area;
    }
    record.jet = std::max(record.jet, jet(push, area > 0 ? sine / area : 1));
  }
}

void Guard::body(GuardRecord& record, double speed) const {
  record.normal_speed = std::max(record.normal_speed, speed);
  record.jet = std::max(record.jet, jet(speed, 0));
}

/// Compares the load of faces that push still water, or rest in it, with the weight of the water above:
///   Σ max(p, 0) A < 0.1 Σ ρ g d A, d the depth below the still level.
/// Without gravity their wet area decides. Faces on the tank's wall do not count. A cavity behind a body is
/// dry by right, and so is a face that recedes. The alarm comes when such faces have advanced by 2 l0 and
/// a/4. In a body that begins in the water and has not felt it yet, it comes after 4 H/c, when the water's
/// weight has come to rest.
void Guard::water_on_faces(GuardRecord& record, double t, double dt,
                           const std::vector<FacePiece>& pieces) const {
  const GuardScales& s = scales_;
  if ((!s.enters && !s.submerged) || t <= s.gravity_ramp) return;
  double all = 0, area = 0, wet = 0, load = 0, weight = 0, push = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const FacePiece& piece : pieces) {
    const double depth = s.top - piece.at.y(), speed = piece.velocity.dot(piece.normal);
    if (depth < under * s.spacing || piece.on_wall) continue;
    all += piece.area;
    if (speed < 0) continue;
    area += piece.area;
    centre += piece.area * piece.at;
    push += piece.area * speed;
    weight += piece.area * s.density * s.gravity * depth;
    if (!piece.wet) continue;
    wet += piece.area;
    load += piece.area * std::max(0.0, piece.pressure);
  }
  const double share = weight > 0 ? load / weight : area > 0 ? wet / area : 1;
  if (area < least_part * all || share >= (weight > 0 ? least_load : least_wet)) {
    record.dry_since = -1;
    record.dry_path = 0;
    return;
  }
  if (record.dry_since < 0) record.dry_since = t - dt;
  record.dry_path += dt * push / area;
  const double wait = std::isfinite(s.sound_speed) ? echoes * s.drop / s.sound_speed : dt;
  const bool from_the_start = record.dry_since <= s.gravity_ramp * (1 + 1e-9);
  const bool rests_dry = s.submerged && from_the_start && t - record.dry_since > wait * (1 + 1e-9);
  if (rests_dry || record.dry_path > std::max(longest_path * s.spacing, trough * s.half_width))
    raise(record, Alarm::dry, {.value = share, .at = centre / area, .time = t, .step = 0},
          weight > 0 ? least_load : least_wet);
}

void Guard::extremes(GuardRecord& record, const WindowExtremes& of) const {
  const double fastest = speed_bound(record), highest = pressure_bound(record, of.pressure.step);
  if (fastest > 0) {
    record.speed_share = std::max(record.speed_share, of.speed.value / fastest);
    if (of.speed.value > fastest) raise(record, Alarm::speed, of.speed, fastest);
  }
  if (highest > 0) {
    record.pressure_share = std::max(record.pressure_share, of.pressure.value / highest);
    if (of.pressure.value > highest) raise(record, Alarm::pressure, of.pressure, highest);
  }
}

void Guard::momentum(GuardRecord& record, double t, double gap) const {
  if (gap > most_momentum) raise(record, Alarm::momentum, of_all(t, gap), most_momentum);
}

void Guard::volume(GuardRecord& record, double t, double drift) const {
  if (std::abs(drift) > most_volume) raise(record, Alarm::volume, of_all(t, drift), most_volume);
}

void Guard::hollow(GuardRecord& record, double t, double openings) const {
  if (openings > most_openings) raise(record, Alarm::hollow, of_all(t, openings), most_openings);
}

void Guard::report(const GuardRecord& record, std::map<std::string, double>& monitor) const {
  constexpr std::array<const char*, 7> parts = {"time", "x", "y", "z", "value", "bound", "step"};
  monitor["check.largest_speed"] = record.speed_share;
  if (scales_.half_width > 0 && scales_.has_faces) monitor["check.largest_pressure"] = record.pressure_share;
  bool any = false;
  for (int k = 0; k < alarm_kinds; ++k) {
    if (record.alarm(0, k) < 0) continue;
    any = true;
    for (std::size_t p = 0; p < parts.size(); ++p)
      if (const double value = record.alarm(static_cast<int>(p), k); std::isfinite(value))
        monitor[fmt::format("alarm.{}.{}", alarm_names[static_cast<std::size_t>(k)], parts[p])] = value;
  }
  const double bound = speed_bound(record);
  if (any && bound > 0) monitor["alarm.flow_step"] = scales_.cfl * scales_.spacing * margin / bound;
}

}  // namespace strake::fluid
