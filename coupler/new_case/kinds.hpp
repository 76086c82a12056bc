#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace strake {

/// A number of a new case that the user may give.
struct NewNumber {
  std::string name;         // of the option without its dashes: "deadrise"
  std::string unit, help;   // "deg", "of the faces against the horizontal"
  double value = 0;         // default; 0 where `follows` says what it follows from
  double min = 0, max = 0;  // both are allowed
  std::string follows = {};
};

/// What the user has given, by the names of NewNumber.
struct NewAnswers {
  std::map<std::string, double> number;
  std::string solver;          // empty: the first of the kind
  std::filesystem::path mesh;  // of the kind "mesh", from the working folder
  std::string mesh_text;       // the same from the case file's folder
  std::string up = "y";        // axis of the file that points up: y, or z as in many ships' files

  double value(const std::string& name) const { return number.at(name); }
};

/// What a case file holds beside its body: the water around it and the time that it takes.
struct NewScene {
  std::string title, physics;  // headline of the run; what is computed, in a sentence
  int dimension = 2;
  double spacing = 0;                       // [m] l0
  std::string spacing_limit;                // what the spacing does not resolve; empty: nothing to say
  double left = 0, right = 0;               // [m] walls of the tank along x
  double back = 0, front = 0;               // [m] the same along z, in three dimensions
  double bottom = 0, surface = 0, top = 0;  // [m] of tank and water; the surface lies under the body
  bool submerged = false;                   // the body stands in the water at the start
  double water_right = 0;                   // [m] where the water ends along x
  double end_time = 0;                      // [s]
  std::string end_reason;                   // what has happened by then
  std::string body;                         // TOML of [structure] and its probes
  std::string warning;                      // what to look at before a run; empty: nothing

  /// A length rounded up to whole spacings [m].
  double whole(double length) const { return spacing * std::ceil(length / spacing - 1e-9); }
};

/// A kind of case that `strake new` writes.
struct NewKind {
  std::string name, help;
  std::vector<std::string> solvers;  // choices of structure.solver; empty: there is no body
  std::vector<NewNumber> numbers;
  bool mesh = false;                                 // needs a mesh file
  std::function<NewScene(const NewAnswers&)> scene;  // of answers that are complete and within their bounds
};

/// All kinds, in the order in which they are listed.
const std::vector<NewKind>& new_kinds();

/// Completes the answers with defaults and refuses what lies outside the bounds; `command` is named in
/// errors. Throws Error(command_line).
NewAnswers complete(const NewKind&, NewAnswers given, const std::string& command);
/// Warns of a length in m that was probably meant in mm; empty where there is none.
std::string long_lengths(const NewKind&, const NewAnswers&);
/// Says that a number is outside its bounds: "expected 1 to 85 deg"; empty where it is within.
std::string out_of_bounds(const NewNumber&, double value);

}  // namespace strake
