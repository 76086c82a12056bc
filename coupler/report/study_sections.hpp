#pragma once

#include "coupler/report/recorded.hpp"
#include "coupler/report/study_data.hpp"

#include <map>
#include <string>

namespace strake::report {

/// The parts of a study's page; `runs` has the readable content of its run folders, by the run's name.
using RunsByName = std::map<std::string, Recorded>;

std::string study_summary(const StudyData&);
std::string study_histories(const StudyData&, const RunsByName&);
std::string study_convergence(const StudyData&);
std::string study_checks(const StudyData&);
std::string study_claims(const StudyData&);
std::string study_runs(const StudyData&, const RunsByName&);

}  // namespace strake::report
