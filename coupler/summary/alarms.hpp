#pragma once

#include "proto/files/json_file.hpp"

#include <map>
#include <string>
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

}  // namespace strake
