#pragma once

#include "proto/files/json_file.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace strake {

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

/// {"start": {"time", "x", "y", "z"}, "crack": …, "parted": …, "energy"}; null where nothing can fail.
/// Of several bodies these by name.
Json failure_json(const std::map<std::string, double>& monitor, const std::vector<std::string>& bodies = {});

}  // namespace strake
