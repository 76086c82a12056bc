#include "coupler/summary/pace.hpp"

#include "coupler/summary/materials.hpp"
#include "proto/case/size_limit.hpp"
#include "proto/lookup.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>

namespace strake {
namespace {

// Time of a particle and step on one core [s], of water and walls together. Measured: wedge and cylinder
// 1.2e-6, sphere 4e-6, plate with steps that share the water's positions 0.4e-6. Iterations of a window: V
// section of finite elements 3.9, plate 1.8, free cylinder and sphere 1.1 to 1.6, driven bodies 1.
constexpr double plane_seconds = 1.2e-6, space_seconds = 4e-6, shared = 1.0 / 3;
// Of a particle in space at the set-up: water that is packed round a submerged body 58 and 44e-6 (40 000 and
// 126 000 particles), the surface of a sphere above the water 13e-6.
constexpr double packed_seconds = 5e-5, space_set_up_seconds = 1.3e-5;
// The same in the plane: water round a submerged cylinder 2 to 3e-5 (17 800 particles), that under a wedge
// 3e-6 (63 600). A particle of a frame: 0.8e-6 (5 200 particles, 20 frames).
constexpr double plane_packed_seconds = 2.5e-5, plane_set_up_seconds = 3e-6, frame_seconds = 0.8e-6;
// A run starts each program three times: for its check, for its values, to compute. With deal.II's libraries
// that takes 0.35 s each time, else 0.01 to 0.02 s.
constexpr double start_seconds = 0.05, start_with_libraries_seconds = 1.1;
// Of an elastic particle and sub-step: V section of aluminium 0.6e-7 in the plane, 12 neighbours; in
// space 90.
constexpr double plane_elastic_seconds = 0.6e-7, space_elastic_seconds = 4e-7;
// Of an unknown of finite elements and step: plate of steel in the plane 1.4e-6 (3 200 unknowns); T beam in
// space 2e-5 with factors (15 000 and 42 000), a block 9e-5 by conjugate gradients (108 000).
constexpr double plane_unknown_seconds = 1.4e-6, space_unknown_seconds = 2e-5,
                 iterative_unknown_seconds = 9e-5;
constexpr double iterative_from = 250000;  // unknowns in space (structure.fem.linear_solver)
constexpr double elastic_iterations = 3, free_iterations = 1.5;
constexpr double jet = 4;            // fastest water over the body's speed, about
constexpr double sound_step = 2e-6;  // [s] the step where a level face meets the water
constexpr double far_off = 20;
constexpr double infinite = std::numeric_limits<double>::infinity();
// Of a particle in a frame [bytes]: eleven numbers; layers behind walls are left out.
constexpr double frame_bytes_each = 85;
constexpr double much_disk = 1e9;  // [bytes]

/// The number before `what` in "about 10 000 water particles, 400 wall particles: 60 MB"; 0 if there is none.
double count_of(const std::string& text, const std::string& what) {
  const std::size_t end = text.find(" " + what);
  if (end == std::string::npos) return 0;
  std::size_t begin = end;
  while (begin > 0 && (std::isdigit(static_cast<unsigned char>(text[begin - 1])) || text[begin - 1] == ' ' ||
                       text[begin - 1] == '.' || text[begin - 1] == 'e' || text[begin - 1] == '+'))
    --begin;
  std::string digits;
  for (const char c : text.substr(begin, end - begin))
    if (c != ' ') digits += c;
  return std::strtod(digits.c_str(), nullptr);
}

/// The memory behind the colon of the same line [bytes].
double memory_behind_colon(const std::string& text) {
  const std::size_t colon = text.rfind(": ");
  if (colon == std::string::npos) return 0;
  return std::strtod(text.c_str() + colon + 2, nullptr) * (text.ends_with("GB") ? 1e9 : 1e6);
}

/// Euclidean norm of a resolved vector, "[0, -9.81, 0]".
double norm_of(const CaseView& view, const std::string& key) {
  double square = 0;
  for (const double number : numbers_in(at_or(view.value, key))) square += number * number;
  return std::sqrt(square);
}

/// Step that the flow allows once it is fast: cfl l0/u and 0.05 √(l0/g).
double flow_step(const CaseView& view) {
  const double l0 = view.number("fluid.spacing").value_or(0), g = norm_of(view, "fluid.gravity"),
               cfl = view.number("fluid.scheme.cfl").value_or(0.2);
  const double speed = (!view.structures.empty() ? jet : 2) * view.common.chosen.speed;
  double step = speed > 0 ? cfl * l0 / speed : infinite;
  if (g > 0) step = std::min(step, 0.05 * std::sqrt(l0 / g));
  return step;
}

/// Iterations of a window, about: one where the load does not decide the motion.
double iterations_of(const CaseView& view) {
  if (!view.coupled() || !view.coupling.iterates()) return 1;
  if (view.any_deforms()) return elastic_iterations;
  return view.moves_freely() ? free_iterations : 1;
}

/// Time of the elastic particles of a window [s], from "1 600 particles of the structure 1.25 mm apart". A
/// sub-step is about the time of the P wave from one to the next (structure/THEORY.md (S30)).
double elastic_seconds(const CaseView& view, const std::string& text) {
  const std::string words = "particles of the structure";
  const double count = count_of(text, words), young = view.number("structure.material.young").value_or(0),
               density = view.number("structure.material.density").value_or(0),
               poisson = view.number("structure.material.poisson").value_or(0);
  if (count == 0 || !(young > 0) || !(density > 0)) return 0;
  const double distance = 1e-3 * std::strtod(text.c_str() + text.find(words) + words.size(), nullptr);
  const double c = std::sqrt(young * (1 - poisson) / (density * (1 + poisson) * (1 - 2 * poisson)));
  const bool plane = view.number("fluid.dimension").value_or(2) < 2.5;
  return count * std::ceil(view.common.window * c / distance) *
         (plane ? plane_elastic_seconds : space_elastic_seconds);
}

/// Time of a step of finite elements [s], from "400 cells, 3 200 unknowns".
double finite_element_seconds(const CaseView& view, const std::string& text) {
  const double unknowns = count_of(text, "unknowns");
  if (view.number("fluid.dimension").value_or(2) < 2.5) return unknowns * plane_unknown_seconds;
  return unknowns * (unknowns < iterative_from ? space_unknown_seconds : iterative_unknown_seconds);
}

/// Frames of the run, after the first: one at each output.every, at most one a window.
double frames_of(const CaseView& view) {
  const double every = std::max(view.common.output_every, view.common.window);
  return every > 0 ? std::floor(view.common.end_time / every * (1 + 1e-9)) : 0;
}

/// Time of what is no step [s]: programs that start, the set-up of the water, its frames.
double seconds_beside_steps(const CaseView& view, double particles) {
  double seconds = 0;
  for (const SideView* side : view.sides())
    seconds += side->solver == "fem" || side->solver == "ccx" ? start_with_libraries_seconds : start_seconds;
  const bool plane = view.number("fluid.dimension").value_or(2) < 2.5,
             packed = at_or(view.value, "fluid.submerged") == "true";
  return seconds +
         particles * (packed ? (plane ? plane_packed_seconds : packed_seconds)
                             : (plane ? plane_set_up_seconds : space_set_up_seconds)) +
         particles * frames_of(view) * frame_seconds;
}

/// The number of frames and what they take on disk; empty where the particles are not known.
std::string frames_text(const CaseView& view, const Pace& pace) {
  if (!(pace.frame_bytes > 0)) return "";
  return fmt::format("{} frames (output.every = {:g} s): {} on disk",
                     grouped(std::llround(frames_of(view) + 1)), view.common.output_every,
                     memory_text((frames_of(view) + 1) * pace.frame_bytes));
}

std::string step_reason(const CaseView& view, const Pace& pace) {
  const double given = view.number("fluid.scheme.time_step").value_or(infinite);
  if (given <= pace.step * (1 + 1e-9)) {
    if (view.common.chosen.level && given <= sound_step) return "it resolves the sound of a level impact";
    if (!std::isfinite(view.number("fluid.sound_speed").value_or(infinite)) &&
        std::abs(given - pace.window) < 1e-9 * given)
      return "incompressible water takes a window in one step";
    return "fluid.scheme.time_step";
  }
  if (pace.window <= pace.step * (1 + 1e-9))
    return "a step ends with the window; shorter where the water is fast";
  return "the flow limits it, while the water is fast";
}

std::string cost_of(double seconds) {
  constexpr double minute = 60, hour = 3600, most = 100;  // a rough guess has two digits
  if (seconds < most) return fmt::format("{:.0f} s", std::max(1.0, seconds));
  if (seconds < most * minute) return fmt::format("{:.0f} min", seconds / minute);
  return fmt::format(fmt::runtime(seconds < 10 * hour ? "{:.1f} h" : "{:.0f} h"), seconds / hour);
}

}  // namespace

std::optional<Pace> pace_of(const CaseView& view) {
  const auto l0 = view.number("fluid.spacing");
  if (!view.fluid || view.fluid->solver != "mps" || view.common.interface != "surface" || !l0) return {};
  Pace pace;
  const double flow = flow_step(view), given = view.number("fluid.scheme.time_step").value_or(infinite);
  const bool sound = std::isfinite(view.number("fluid.sound_speed").value_or(infinite));
  pace.window = view.common.window;
  pace.chosen_window = view.common.chosen.window;
  pace.step = std::min({given, pace.window, flow});
  pace.chosen_step =
      std::min({sound && view.common.chosen.level ? sound_step : infinite, pace.chosen_window, flow});
  pace.windows = std::ceil(view.common.end_time / pace.window - 1e-9);
  // The last window ends with the run.
  pace.steps = pace.windows * std::ceil(std::min(pace.window, view.common.end_time) / pace.step - 1e-9);
  pace.iterations = iterations_of(view);
  double elastic = 0;
  for (const SideView* side : view.sides()) {
    for (const std::string& text : lines_with(size_words, *side)) {
      pace.bytes += memory_behind_colon(text);
      pace.particles += count_of(text, "water particles") + count_of(text, "wall particles");
      elastic += elastic_seconds(view, text) + finite_element_seconds(view, text);
    }
  }
  const bool plane = view.number("fluid.dimension").value_or(2) < 2.5;
  pace.frame_bytes = pace.particles * frame_bytes_each;
  pace.seconds = pace.particles * pace.steps * pace.iterations * (plane ? plane_seconds : space_seconds);
  if (sound && pace.step <= sound_step) pace.seconds *= shared;
  pace.seconds += elastic * pace.windows * pace.iterations;
  pace.seconds += seconds_beside_steps(view, pace.particles);
  return pace;
}

std::vector<std::string> pace_lines(const CaseView& view) {
  const auto pace = pace_of(view);
  if (!pace) return {};
  const WindowChoice& chosen = view.common.chosen;
  const bool by_hand = std::abs(pace->window - chosen.window) > 1e-9 * chosen.window;
  std::vector<std::string> lines = {
      fmt::format("time step about {:.2g} s: {}", pace->step, step_reason(view, *pace)),
      by_hand ? fmt::format("window {:.6g} s, as given; the default would be {:.6g} s: {}", pace->window,
                            chosen.window, chosen.why)
              : fmt::format("window {:.6g} s: {}", pace->window, chosen.why)};
  const bool elastic = view.any_deforms();
  if (pace->particles > 0)
    lines.push_back(fmt::format(
        "about {} steps of {} particles{}: some {} on one core, within a factor of three{}; {} of memory",
        grouped(std::llround(pace->steps)), grouped(std::llround(pace->particles)),
        pace->iterations > 1 ? fmt::format(", {:g} iterations of a window", pace->iterations) : "",
        cost_of(pace->seconds), elastic ? " (a soft or light body: up to ten times as long)" : "",
        memory_text(pace->bytes)));
  if (const std::string frames = frames_text(view, *pace); !frames.empty()) lines.push_back(frames);
  return lines;
}

namespace {

/// "a 40th of" or "40 times".
std::string times(double ratio) {
  return ratio < 1 ? fmt::format("1/{:.0f} of", 1 / ratio) : fmt::format("{:.0f} times", ratio);
}

bool is_far_off(double ratio) {
  return ratio > 0 && std::isfinite(ratio) && (ratio >= far_off || ratio <= 1 / far_off);
}

void look_at_steps(const CaseView& view, const Pace& pace, std::vector<std::string>& lines) {
  // A window longer than the usual one is not judged where the flow is not known.
  if (const double ratio = pace.window / pace.chosen_window;
      is_far_off(ratio) && (ratio < 1 || view.common.chosen.known)) {
    const std::string cost = ratio < 1 ? fmt::format("{:.0f} times as many windows", 1 / ratio)
                             : !view.structures.empty()
                                 ? "the load is a mean over it, and the body's answer within it is lost"
                                 : "the history has few rows";
    lines.push_back(fmt::format("coupling.surface.window = {:.3g} is {} what Strake would take, {:.3g} s: {}",
                                pace.window, times(ratio), pace.chosen_window, cost));
  }
  const double given = view.number("fluid.scheme.time_step").value_or(infinite);
  // The step is judged with the window that Strake would take: one that is far off has its own line.
  if (const double ratio = given / pace.chosen_step; given < infinite && ratio < 1 && is_far_off(ratio))
    lines.push_back(
        fmt::format("fluid.scheme.time_step = {:.3g} is {} what Strake would take, some {:.1g} s: the run "
                    "takes about {:.0f} times as long",
                    given, times(ratio), pace.chosen_step, 1 / ratio));
  if (const double ratio = pace.step / sound_step;
      pace.chosen_step <= sound_step && ratio > 1 && is_far_off(ratio))
    lines.push_back(
        fmt::format("steps of {:.3g} s are {} what Strake would take, {:.1g} s: the first pressure of a "
                    "level face, rho c "
                    "V, is not resolved",
                    pace.step, times(ratio), sound_step));
}

/// Frames that fill a disk: of a long run with the default of output.every.
void look_at_frames(const CaseView& view, const Pace& pace, std::vector<std::string>& lines) {
  constexpr double usual = 200;  // frames of a film
  if (frames_of(view) < 2 * usual || frames_of(view) * pace.frame_bytes < much_disk) return;
  lines.push_back(fmt::format("{}; output.every = {:.1g} makes {:g}", frames_text(view, pace),
                              view.common.end_time / usual, usual));
}

/// Gravity that points up, or along the water's level: in Strake y points up.
void look_at_gravity(const CaseView& view, std::vector<std::string>& lines) {
  const auto gravity = numbers_in(at_or(view.value, "fluid.gravity"));
  if (gravity.size() < 2 || at_or(view.value, "fluid.open_top") == "false") return;
  const bool space = view.number("fluid.dimension").value_or(2) > 2.5 && gravity.size() > 2;
  const double along_x = std::abs(gravity[0]), along_z = space ? std::abs(gravity[2]) : 0;
  if (gravity[1] > 0)
    lines.push_back(
        fmt::format("fluid.gravity points up, {:.3g} m/s^2 along y: the water leaves the tank, which is "
                    "open above; [0, -9.81] points down",
                    gravity[1]));
  else if (std::max(along_x, along_z) > -gravity[1])
    lines.push_back(
        fmt::format("fluid.gravity points sideways, {:.3g} m/s^2 along {}: the water leaves the tank, which "
                    "is open above along y; [0, -9.81, 0] points down",
                    along_x > along_z ? gravity[0] : gravity[2], along_x > along_z ? "x" : "z"));
}

/// Values that another unit or another sign explains: g/cm³, GPa, mm/s.
void look_at_units(const CaseView& view, std::vector<std::string>& lines) {
  constexpr double fastest = 300;  // [m/s] a fifth of the speed of sound in water
  if (const double speed = view.common.chosen.speed; speed > fastest)
    lines.push_back(
        fmt::format("a speed of {:.3g} m/s: above {:g} m/s water is not nearly incompressible. Lengths are "
                    "in m, speeds in m/s",
                    speed, fastest));
  look_at_gravity(view, lines);
  constexpr double earth = 9.81;  // [m/s²]
  if (const double g = norm_of(view, "fluid.gravity"); g >= far_off * earth)
    lines.push_back(fmt::format("fluid.gravity of {:.3g} m/s^2 is {:.0f} times that of the earth, 9.81 m/s^2",
                                g, g / earth));
  constexpr double thin = 1e-6, thick = 500;  // [m²/s] of water; glycerine is near 1200 times as thick
  if (const double ratio = view.number("fluid.kinematic_viscosity").value_or(thin) / thin; ratio >= thick)
    lines.push_back(fmt::format(
        "fluid.kinematic_viscosity = {:.3g} m^2/s is {:.3g} times that of water, 1e-6: 1 mm^2/s (cSt) "
        "is 1e-6, and 1e-3 Pa s in water too",
        ratio * thin, ratio));
  constexpr double water = 1000;  // [kg/m³]
  if (const double ratio = view.number("fluid.density").value_or(water) / water; is_far_off(ratio))
    lines.push_back(
        fmt::format("fluid.density = {:.3g} is {} that of water, 1000 kg/m^3", ratio * water, times(ratio)));
  constexpr double degree = std::numbers::pi / 180;  // [rad]
  if (const double deadrise = view.number("structure.wedge.deadrise").value_or(infinite);
      deadrise < 90 * degree)
    lines.push_back(
        fmt::format("structure.wedge.deadrise = {:.3g} deg is nearly level: angles are in degrees, and "
                    "{:.3g} rad are {:.3g}",
                    deadrise, deadrise, deadrise / degree));
  const double rate = std::abs(view.number("structure.angular_velocity").value_or(0)),
               turns = 0.5 * std::numbers::inv_pi * rate * view.common.end_time;
  if (turns > 1)
    lines.push_back(fmt::format(
        "structure.angular_velocity of {:.4g} rad/s turns the body {:.2g} times in the run; {:.4g} deg/s are "
        "{:.3g} rad/s",
        rate, turns, rate, rate * degree));
}

/// A vector with a length along z in a case of the plane, which nothing reads: [0, -9,81] for [0, -9.81].
void look_at_plane(const CaseView& view, std::vector<std::string>& lines) {
  if (view.number("fluid.dimension").value_or(2) > 2.5) return;
  std::vector<std::string> keys = {"fluid.gravity", "fluid.initial_velocity.value"};
  for (const SideView& side : view.structures)
    for (const char* key : {".velocity", ".initial_velocity.value"})
      keys.push_back((side.is_body ? "structures." + side.side : "structure") + key);
  for (const std::string& key : keys)
    if (const auto vector = numbers_in(at_or(view.value, key)); vector.size() > 2 && vector[2] != 0)
      lines.push_back(
          fmt::format("{} = [{:g}, {:g}, {:g}] has a part along z, which a case in the plane leaves out: a "
                      "number has a decimal point, [0, -9.81]",
                      key, vector[0], vector[1], vector[2]));
}

/// A body that stays where it is while the tank moves past it, which is seldom meant of one that is held.
void look_at_tank(const CaseView& view, std::vector<std::string>& lines) {
  const auto given = [&](const char* key) { return !at_or(view.value, key).empty(); };
  const bool moves = given("fluid.motion.file") || view.number("fluid.motion.amplitude").value_or(0) > 0 ||
                     view.number("fluid.motion.roll").value_or(0) > 0;
  const bool one = view.structures.size() == 1 && !view.structures.front().is_body;
  if (!moves || !one || view.moves_freely() || given("structure.motion.file")) return;
  const std::string& solver = view.structures.front().solver;
  if (solver == "fem" || solver == "particle" || solver == "ccx" || solver == "rigid")
    lines.push_back(
        "fluid.motion moves the tank, and what holds the body stays at rest: "
        "structure.motion.file moves it along, with the tank's motion as a table");
}

}  // namespace

std::vector<std::string> far_off_lines(const CaseView& view, double extent) {
  std::vector<std::string> lines;
  look_at_materials(view, lines);
  const auto pace = pace_of(view);
  if (!pace || view.common.preset != "improved") return lines;
  look_at_steps(view, *pace, lines);
  look_at_frames(view, *pace, lines);
  look_at_units(view, lines);
  look_at_plane(view, lines);
  look_at_tank(view, lines);
  constexpr double usual = 40;  // spacings across a body
  const double l0 = view.number("fluid.spacing").value_or(0);
  if (const double ratio = extent > 0 ? l0 / (extent / usual) : 1; is_far_off(ratio))
    lines.push_back(fmt::format(
        "fluid.spacing = {:.3g} is {} a {:.0f}th of the body's {:.3g} m, {:.2g} m: {}", l0, times(ratio),
        usual, extent, extent / usual,
        ratio > 1 ? "forces are not to be trusted"
                  : fmt::format("some {:.0e} times the run time",
                                std::pow(1 / ratio, view.number("fluid.dimension").value_or(2) + 1))));
  constexpr double sound = 1500;  // [m/s]
  const double c = view.number("fluid.sound_speed").value_or(infinite);
  if (is_far_off(c / sound))
    lines.push_back(fmt::format(
        "fluid.sound_speed = {:.3g} is {} that of water, {:g} m/s: {}", c, times(c / sound), sound,
        c < sound ? "no flat impact has more than rho c V, and the water is as soft"
                  : "the first pressure of a flat impact, rho c V, is as much higher"));
  return lines;
}

}  // namespace strake
