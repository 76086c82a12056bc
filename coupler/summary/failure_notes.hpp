#pragma once

#include "proto/files/json_file.hpp"

#include <map>
#include <string>
#include <vector>

namespace strake {

/// Reports of a structure on its failure, "failure.start.time", "failure.start.x" … for start, crack and
/// parted. They go to the summary, and once to the console and the log.
class FailureNotes {
 public:
  /// `dry_faces`: the water does not load the faces of a crack. The interface is then the surface of the
  /// whole body. Events up to `since` [s] were reported before a resume.
  FailureNotes(bool dry_faces, double since) : dry_faces_(dry_faces), since_(since) {}
  /// Lines for what has happened since the last call.
  std::vector<std::string> look(const std::map<std::string, double>& monitor);

 private:
  bool dry_faces_;
  double since_;
  std::map<std::string, bool> told_;
};

/// {"start": {"time", "x", "y", "z"}, "crack": …, "parted": …, "energy"}; null where nothing can fail.
Json failure_json(const std::map<std::string, double>& monitor);

}  // namespace strake
