#include "proto/case/window_choice.hpp"

#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/files/motion_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <system_error>

namespace strake {
namespace {

// The cases of a wedge, cylinder and sphere were tuned by hand to windows of 0.04 to 0.06 l0/U before.
constexpr double travel = 0.05;                               // [l0] of the body in a window
constexpr double gravity_steps = 4;                           // of 0.05 √(l0/g), fluid/THEORY.md (F63)
constexpr double sound_travel = 20;                           // [l0] of the structure's sound in a window
constexpr double layer_travel = 2;                            // [l0] of the water's sound in a window
constexpr double level_angle = 1;                             // [deg] of a face that counts as level
constexpr double rows = 100;                                  // of the history, at least
constexpr double rows_of_water = 400;                         // the same for water alone
constexpr double steel_young = 2.1e11, steel_density = 7800;  // [Pa], [kg/m³] where the case gives none

double first_of(const CaseFile& file, const std::string& path, double otherwise) {
  const std::vector<double> numbers = file.numbers_at(path);
  return numbers.empty() ? otherwise : numbers.front();
}

double norm_of(const CaseFile& file, const std::string& path, double otherwise) {
  const std::vector<double> numbers = file.numbers_at(path);
  if (numbers.empty()) return otherwise;
  double square = 0;
  for (const double x : numbers) square += x * x;
  return std::sqrt(square);
}

bool is_elastic(const CommonKeys& keys) {
  return keys.structure_solver == "fem" || keys.structure_solver == "particle" ||
         keys.structure_solver == "ccx";
}

/// A program of the user's, or one with a preCICE adapter.
bool is_foreign(const CommonKeys& keys) {
  const std::string& solver = keys.structure_solver;
  return !is_elastic(keys) && solver != "rigid" && solver != "replay" && solver != "none";
}

/// Whether the body may bend and be light.
bool may_deform(const CommonKeys& keys) {
  return is_elastic(keys) || is_foreign(keys) || keys.structure_solver == "replay";
}

/// The window of the run whose motion a replay plays [s]; 0 where nothing tells it.
double recorded_window(const CaseFile& file, const CommonKeys& keys) {
  const std::string run = file.text_at("structure.replay.run");
  const std::filesystem::path recorded = file.folder() / run / "case.toml";
  std::error_code ignored;
  if (keys.structure_solver != "replay" || run.empty() ||
      !std::filesystem::is_regular_file(recorded, ignored))
    return 0;
  try {
    const CaseFile told = CaseFile::load(recorded);
    const bool volume = told.text_at("coupling.interface") == "volume";
    return first_of(told, volume ? "coupling.volume.window" : "coupling.surface.window", 0);
  } catch (const Error&) {  // the structure's own program says what is wrong with the record
    return 0;
  }
}

bool falls_free(const CaseFile& file) {
  for (const char* way : {"x", "y", "z", "angle", "rotation"})
    if (file.is_true(std::string("structure.free.") + way)) return true;
  return false;
}

bool tank_moves(const CaseFile& file) {
  return file.has("fluid.motion.file") || norm_of(file, "fluid.motion.amplitude", 0) > 0 ||
         norm_of(file, "fluid.motion.roll", 0) > 0;
}

bool is_driven(const CaseFile& file) {
  return file.has("structure.motion.file") || tank_moves(file);
}

/// Height of the lowest point of a plate or of boxes [m]; infinite where it is not known.
double lowest_of_body(const CaseFile& file) {
  double lowest = std::numeric_limits<double>::infinity();
  if (file.has("structure.placed")) return lowest;
  if (file.has("structure.plate")) {
    const std::vector<double> bottom = file.numbers_at("structure.plate.bottom");
    lowest = bottom.size() > 1 ? bottom[1] : 0;
  }
  for (int k = 0;; ++k) {
    const std::vector<double> corner = file.numbers_at(fmt::format("structure.box[{}].min", k));
    if (corner.size() < 2) return lowest;
    lowest = std::min(lowest, corner[1]);
  }
}

/// Whether the tank moves and its water comes to a body that reaches below the water's level and has no
/// motion but the tank's: a flap on the floor, a baffle.
bool stands_in_moving_tank(const CaseFile& file) {
  const std::vector<double> water = file.numbers_at("fluid.water");
  if (!tank_moves(file) || falls_free(file) || (water.size() != 4 && water.size() != 6)) return false;
  for (const char* path : {"structure.velocity", "structure.initial_velocity.value"})
    if (norm_of(file, path, 0) > 0) return false;
  return lowest_of_body(file) < water[water.size() / 2 + 1] - first_of(file, "fluid.spacing", 0);
}

/// Whether the body moves against the water, or may come to.
bool may_move(const CaseFile& file, const CommonKeys& keys) {
  for (const char* path :
       {"structure.velocity", "structure.angular_velocity", "structure.initial_velocity.value"})
    if (norm_of(file, path, 0) > 0) return true;
  if (file.has("structure.initial_velocity.file") || falls_free(file) || is_driven(file)) return true;
  // An elastic plate without supports is free as a whole.
  return may_deform(keys) && !file.has("structure.plate.supports") && !file.has("structure.box");
}

/// Whether a body of boxes stands on an edge or a corner: [structure.placed] turns all of its faces by more
/// than level_angle out of the level. Three directions are normal to faces; the turn by angle φ about the
/// unit axis a gives each the height cos φ δ_iy + sin φ (a × e_i)_y + (1 − cos φ) a_i a_y (Rodrigues).
bool is_turned(const CaseFile& file) {
  const double turn = first_of(file, "structure.placed.angle", 0) * std::numbers::pi / 180;
  std::vector<double> axis = file.numbers_at("structure.placed.axis");
  if (axis.size() != 3) axis = {0, 0, 1};
  const double norm = norm_of(file, "structure.placed.axis", 1);
  if (turn == 0 || norm == 0) return false;
  const double a = axis[0] / norm, b = axis[1] / norm, c = axis[2] / norm, s = std::sin(turn),
               t = 1 - std::cos(turn);
  const double level = std::cos(level_angle * std::numbers::pi / 180);
  for (const double height : {c * s + a * b * t, 1 - t + b * b * t, -a * s + b * c * t})
    if (std::abs(height) >= level) return false;
  return true;
}

/// Whether the body may meet the water with a level face: a plate or box that moves. So may a body that only
/// its own program, or an earlier run, knows.
bool may_fall_level(const CaseFile& file, const CommonKeys& keys) {
  const std::string& solver = keys.structure_solver;
  if (file.only_declares()) return true;
  if (solver == "none") return false;
  if (is_foreign(keys)) return !file.is_true("fluid.submerged");
  if (solver == "replay" && recorded_window(file, keys) == 0) return true;
  for (const char* shape : {"mesh", "outline", "offsets", "wedge", "cylinder", "sphere"})
    if (file.has(std::string("structure.") + shape)) return false;
  if (norm_of(file, "structure.plate.angle", 0) > level_angle || is_turned(file)) return false;
  return !file.is_true("fluid.submerged") && !stands_in_moving_tank(file) && may_move(file, keys);
}

/// Height of a box that a key gives by two corners [m]; 0 if unknown.
double height_of(const CaseFile& file, const std::string& path) {
  const std::vector<double> corners = file.numbers_at(path);
  if (corners.size() != 4 && corners.size() != 6) return 0;
  return std::max(0.0, corners[corners.size() / 2 + 1] - corners[1]);
}

/// Depth of the water [m]: the height of `fluid.water`, or of the tank; 0 if unknown.
double depth_of(const CaseFile& file) {
  const double water = height_of(file, "fluid.water");
  return water > 0 ? water : height_of(file, "fluid.tank");
}

/// Largest speed of a free body whose speed at t = 0 is given [m/s]:
///   v + g end_time,   and at most   max(v, √(g H)) in the water,   √(v² + 2 g H_tank) above it.
///
/// A body that stands in the water at the start is carried by it and does not fall: it heaves with the
/// waves. One above the water falls from the tank's top to its floor at most.
double speed_of_free_body(const CaseFile& file, double end_time, double speed, double g) {
  const double fall = speed + g * end_time;
  if (file.is_true("fluid.submerged")) {
    const double depth = depth_of(file);
    return depth > 0 ? std::min(fall, std::max(speed, std::sqrt(g * depth))) : fall;
  }
  const double height = height_of(file, "fluid.tank");
  return height > 0 ? std::min(fall, std::sqrt(speed * speed + 2 * g * height)) : fall;
}

/// The body's table of motion, structure.motion.file; nothing where there is none. With a tank that moves as
/// well, the speed against the water is not known. The structure's own program refuses a table that cannot be
/// read.
std::optional<MotionTable> table_of(const CaseFile& file) {
  const std::string name = file.text_at("structure.motion.file");
  std::error_code ignored;
  const std::filesystem::path path = file.folder() / name;
  if (name.empty() || tank_moves(file) || !std::filesystem::is_regular_file(path, ignored)) return {};
  try {
    return read_motion(path);
  } catch (const Error&) {
    return {};
  }
}

/// Whether a body that starts out of the water has no speed of its own there, and gets one later.
bool starts_at_rest(const CaseFile& file, double by_table) {
  for (const char* path :
       {"structure.velocity", "structure.angular_velocity", "structure.initial_velocity.value"})
    if (norm_of(file, path, 0) > 0) return false;
  return !file.is_true("fluid.submerged") && !tank_moves(file) && (by_table > 0 || falls_free(file));
}

/// Speed at t = 0 of the body against water that fluid.initial_velocity sets in motion [m/s]; 0 where that is
/// at rest.
double speed_against_water(const CaseFile& file) {
  const std::vector<double> water = file.numbers_at("fluid.initial_velocity.value"),
                            body = file.numbers_at("structure.velocity");
  if (norm_of(file, "fluid.initial_velocity.value", 0) == 0) return 0;
  double square = 0;
  for (std::size_t k = 0; k < water.size(); ++k) {
    const double difference = water[k] - (k < body.size() ? body[k] : 0);
    square += difference * difference;
  }
  return std::sqrt(square);
}

/// How the body moves: by a table, and how far it reaches from the point that it turns about [m].
struct Moves {
  double by_table = 0;  // [m/s] its fastest point, at most
  double reach = 0;     // 0: it does not turn
};

/// Speed of the body's fastest point, |v| + |ω| r, or of waves in the water [m/s].
double speed_of(const CaseFile& file, const CommonKeys& keys, const Moves& moves, double g) {
  const double turn = std::abs(first_of(file, "structure.angular_velocity", 0)) * moves.reach;
  double speed = std::max({norm_of(file, "structure.velocity", 0) + turn,
                           norm_of(file, "structure.initial_velocity.value", 0), moves.by_table,
                           speed_against_water(file)});
  if (falls_free(file)) speed = speed_of_free_body(file, keys.end_time, speed, g);
  if (may_deform(keys) || is_driven(file) || speed == 0)
    speed = std::max(speed, std::sqrt(g * depth_of(file)));
  return speed;
}

/// Sets the speeds of the choice. Returns whether the turn of the body makes the largest.
bool find_speeds(const CaseFile& file, const CommonKeys& keys, double g, WindowChoice& choice) {
  const std::optional<MotionTable> table = table_of(file);
  const bool turns = norm_of(file, "structure.angular_velocity", 0) > 0 || (table && table->turns());
  const auto moves = [&](double reach) {
    return Moves{table ? table->largest_speed(keys.end_time, reach) : 0, reach};
  };
  const Moves whole = moves(turns ? reach_of_body(file) : 0);
  choice.by_table = whole.by_table;
  choice.from_rest = starts_at_rest(file, choice.by_table);
  const double turned = speed_of(file, keys, whole, g), still = speed_of(file, keys, moves(0), g);
  choice.speed = std::max(turned, still);  // a slow turn is no measure of waves
  return turns && turned > still;
}

/// Takes the bound if it is shorter than those before, with its words.
void bound(WindowChoice& choice, double window, const std::string& why) {
  if (!(window > 0) || !(window < choice.window)) return;
  choice.window = window;
  choice.why = why;
}

void bound_by_body(const CaseFile& file, const CommonKeys& keys, double l0, double g, bool by_turn,
                   WindowChoice& choice) {
  if (choice.speed > 0)
    bound(choice, travel * l0 / choice.speed,
          by_turn ? fmt::format("the body's fastest point moves at {:.3g} m/s as it turns: a twentieth of a "
                                "spacing in it",
                                choice.speed)
                  : fmt::format("at {:.3g} m/s the body or the water moves a twentieth of a spacing in it",
                                choice.speed));
  if (g > 0)
    bound(choice, gravity_steps * 0.05 * std::sqrt(l0 / g), "four steps of the limit that gravity sets");
  if (!is_elastic(keys) && !is_foreign(keys)) return;
  const double young = first_of(file, "structure.material.young", steel_young),
               density = first_of(file, "structure.material.density", steel_density);
  if (young > 0 && density > 0)
    bound(choice, sound_travel * l0 / std::sqrt(young / density),
          "the structure's sound travels twenty spacings in it, so that its bending is followed");
}

/// Keeps the window short against the sound of a thin layer of water, which a light body lets ring. Two rows
/// have half a period of 4.1 l0/c.
void bound_by_layers(const CaseFile& file, const CommonKeys& keys, double l0, WindowChoice& choice) {
  if (!may_deform(keys) && !falls_free(file)) return;
  // An infinite value is no number here.
  const bool incompressible = file.has("fluid.sound_speed") && file.numbers_at("fluid.sound_speed").empty(),
             limited = file.has("fluid.scheme.time_step");
  const double usual = choice.level && !limited ? 2e-6 : 0,
               step = first_of(file, "fluid.scheme.time_step", usual),
               speed = first_of(file, "fluid.sound_speed", 1500);
  if (!incompressible && step > 0 && speed * step < l0)
    bound(choice, layer_travel * l0 / speed,
          "the water's sound, which the steps resolve, travels two spacings in it: in longer windows thin "
          "layers of water ring under a light body");
}

}  // namespace

double round_window(double value, double whole) {
  if (!(value > 0) || !std::isfinite(value)) return value;
  constexpr std::array<double, 5> steps = {5, 4, 2.5, 2, 1};
  constexpr double round_off = 1e-9;
  constexpr int looks = 5;  // down to a tenth of the largest
  const auto power = static_cast<int>(std::floor(std::log10(value) + round_off));
  double largest = 0;
  int looked = 0;
  for (int p = power; looked < looks; --p)
    for (const double step : steps) {
      const double window = p < 0 ? step / std::pow(10.0, -p) : step * std::pow(10.0, p);
      if (window > value * (1 + round_off) || looked == looks) continue;
      ++looked;
      if (largest == 0) largest = window;
      const double parts = whole / window;
      if (std::abs(parts - std::round(parts)) < round_off * std::max(1.0, parts)) return window;
    }
  return largest;
}

WindowChoice choose_window(const CaseFile& file, const CommonKeys& keys) {
  WindowChoice choice;
  choice.level = may_fall_level(file, keys);
  const double l0 = first_of(file, "fluid.spacing", 0), g = norm_of(file, "fluid.gravity", 9.81);
  const bool by_turn = find_speeds(file, keys, g, choice);
  const std::string& solver = keys.structure_solver;
  const double recorded = recorded_window(file, keys);
  const bool own = is_elastic(keys) || solver == "rigid" || solver == "none" || recorded > 0 ||
                   (is_foreign(keys) && !choice.level);
  choice.known = own && keys.preset != "paper" && keys.fluid_solver == "mps";
  if (!choice.known) {
    choice.why = is_foreign(keys)
                     ? "that of a level impact, as only its program knows the body; coupling.surface.window "
                       "sets it, and "
                       "with fluid.submerged = true (the body stands in the water) it is longer"
                     : "the usual one where Strake does not know the flow: coupling.surface.window sets it";
    return choice;
  }
  if (choice.level) {
    choice.why = "a level face may meet the water: five steps of 2e-6 s, which resolve its sound";
    bound_by_layers(file, keys, l0, choice);
    choice.window = round_window(choice.window);
    return choice;
  }
  if (!(l0 > 0) || !(keys.end_time > 0)) return choice;  // refused elsewhere
  if (solver == "none") {
    choice.window = keys.end_time / rows_of_water;
    choice.why = fmt::format("about {:g} rows of the history: water alone exchanges nothing", rows_of_water);
  } else {
    choice.window = keys.end_time / rows;
    choice.why = fmt::format("about {:g} rows of the history", rows);
    bound_by_body(file, keys, l0, g, by_turn, choice);
    bound_by_layers(file, keys, l0, choice);
    bound(choice, recorded, "that of the run whose motion is played");
  }
  const double every = first_of(file, "output.every", 0);
  bound(choice, every, "as long as output.every");
  // Frames lie evenly in time, since the times of frames are ends of windows. So a case with another
  // output.every may have other windows, and results that differ by the error of a window.
  const double undivided = round_window(choice.window);
  choice.window = round_window(choice.window, std::max(0.0, every));
  if (choice.window < undivided) choice.why += fmt::format("; {:g} s divides output.every", choice.window);
  const double step = first_of(file, "fluid.scheme.time_step", 0);
  if (step > choice.window) {
    choice.window = step;
    choice.why = "as long as fluid.scheme.time_step";
  }
  return choice;
}

}  // namespace strake
