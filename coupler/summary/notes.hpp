#pragma once

#include "proto/files/json_file.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace strake {

/// An alarm of a participant's guard: a value that the case cannot have, when and where.
struct RaisedAlarm {
  std::string kind;            // "speed", "pressure", "dry", "momentum", "volume", "hollow"
  double time = 0;             // [s]
  bool placed = false;         // whether the place is known
  double x = 0, y = 0, z = 0;  // [m]
  double value = 0, bound = 0;
  std::string line;  // time, place, what is wrong, the probable cause, what to try
};

/// The alarms in a monitor, "alarm.<kind>.time" and so on (proto/WIRE.md), the earliest first.
std::vector<RaisedAlarm> alarms_of(const std::map<std::string, double>& monitor);

/// Tells each alarm of a run once. Those up to `since` [s] were told before a resume.
class AlarmNotes {
 public:
  explicit AlarmNotes(double since) : since_(since) {}
  /// Lines for the alarms that were raised since the last call.
  std::vector<std::string> look(const std::map<std::string, double>& monitor);

 private:
  double since_;
  std::map<std::string, bool> told_;
};

/// As an entry of "alarms" in summary.json.
Json json_of(const RaisedAlarm&);

/// Reports of a structure on its failure, "failure.start.time", "failure.start.x" … for start, crack and
/// parted. They go to the summary, and once to the console and the log. Of several bodies their names stand
/// before: "left.failure.start.time".
class FailureNotes {
 public:
  /// `dry_faces`: the water does not load the faces of a crack. The interface is then the surface of the
  /// whole body. Events up to `since` [s] were reported before a resume.
  FailureNotes(bool dry_faces, double since, std::vector<std::string> bodies = {})
      : dry_faces_(dry_faces), since_(since), bodies_(std::move(bodies)) {}
  /// Lines for what has happened since the last call.
  std::vector<std::string> look(const std::map<std::string, double>& monitor);

 private:
  void look_at(const std::string& body, const std::map<std::string, double>& monitor,
               std::vector<std::string>& lines);

  bool dry_faces_;
  double since_;
  std::vector<std::string> bodies_;  // empty: one structure
  std::map<std::string, bool> told_;
};

/// What a solver with preCICE's functions does otherwise than it may think, from "precice.…" of its monitor
/// (proto/WIRE.md). Each is told once.
class PreciceNotes {
 public:
  explicit PreciceNotes(double window) : window_(window) {}  // of the case [s]
  /// side: "fluid", "structure".
  std::vector<std::string> look(const std::string& side, const std::map<std::string, double>& monitor);

 private:
  double window_;
  std::map<std::string, bool> told_;  // by side and kind
};

/// Values of programs that are not Strake's own and are no numbers (nan). Their cells in history.csv stay
/// empty. Each column is told once.
class EmptyCellNotes {
 public:
  explicit EmptyCellNotes(std::vector<std::string> columns)
      : columns_(std::move(columns)) {}  // of history.csv
  /// side: "fluid", "structure", the name of one of several bodies; of that one the columns are
  /// "SIDE.column".
  std::vector<std::string> look(const std::string& side, double time, bool one_of_several,
                                const std::map<std::string, double>& monitor);

 private:
  std::vector<std::string> columns_;
  std::map<std::string, bool> told_;
};

/// {"start": {"time", "x", "y", "z"}, "crack": …, "parted": …, "energy"}; null where nothing can fail.
/// Of several bodies these by name.
Json failure_json(const std::map<std::string, double>& monitor, const std::vector<std::string>& bodies = {});

/// How a check of a run turned out.
enum class Grade { good, poor, bad };
std::string name_of(Grade);

/// The bounds of a check, on its size.
struct CheckBounds {
  const char* key;    // in "checks" of summary.json
  const char* words;  // on the console
  double good, poor;  // good up to the first, poor up to the second, bad above
  bool per_particle;  // the value is a count, its bounds are shares of the water's particles
};

/// Grades each check that has bounds: {"momentum_gap": {"grade": "good", "good": 0.02, "poor": 0.1}, …}.
/// Checks that are null have none. particles: of the water.
Json grades_of(const Json& checks, double particles);

/// The last lines of a console on them, worst first: "bad     speed of the water 1.1 of its bound (to 1)".
std::vector<std::string> grade_lines(const Json& checks);

}  // namespace strake
