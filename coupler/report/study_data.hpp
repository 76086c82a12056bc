#pragma once

#include "coupler/study/results.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake::report {

/// study.json as `strake study` writes it. What is missing is empty.
struct StudyData {
  struct Axis {
    std::string name;
    std::vector<std::string> labels;
  };
  struct Run {
    std::string name, state;                    // "done" | "failed" | "missing"
    std::map<std::string, std::string> labels;  // axis → label
    std::filesystem::path folder;
    std::optional<double> exit_code, seconds;
    std::map<std::string, std::optional<double>> values;  // "mid.y:first_peak"
  };
  struct QuantityOfRuns {
    std::string probe, metric, unit;
  };
  struct Reference {
    std::string title, axis, probe, metric, kind, source;
    std::map<std::string, std::optional<double>> values;  // by label on the axis
  };
  struct Convergence {
    std::string title, axis, probe, metric, unit, remark;
    std::vector<double> along, values;  // NaN: not known
    std::optional<double> order, extrapolated, gci;
  };
  std::string title, name, file, of_case;
  std::vector<std::string> commands;
  std::vector<Axis> axes;
  std::vector<Run> runs;
  std::vector<QuantityOfRuns> columns;
  std::vector<study::CheckResult> checks;
  std::vector<Reference> references;
  std::vector<Convergence> convergence;
  std::vector<study::ClaimResult> claims;
  std::optional<double> seconds;
};

/// Throws Error(case_file) where study.json is missing or no JSON object.
StudyData read_study(const std::filesystem::path& folder);

}  // namespace strake::report
