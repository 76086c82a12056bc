#pragma once

#include "coupler/report/recorded.hpp"
#include "coupler/report/study_data.hpp"

#include <map>
#include <string>
#include <vector>

namespace strake::report {

/// The parts of a report on runs, each a section of the page; empty where there is nothing to say. Every run
/// keeps its place in `runs` as its colour.

std::string what_was_run(const std::vector<Recorded>&);
std::string drawing_of_case(const std::vector<Recorded>&);
/// What the case sets; keys that differ between runs come first. Defaults are folded away.
std::string settings(const std::vector<Recorded>&);
/// `at`: times [s]; empty: contact, first peak, end.
std::string pictures(const std::vector<Recorded>&, const std::vector<double>& at);
std::string histories(const std::vector<Recorded>&);
/// Every metric of every probe with a column for each reference, its kind and the deviation from it.
std::string metrics(const std::vector<Recorded>&);
/// Where and when structures that may fail began to.
std::string failures(const std::vector<Recorded>&);
std::string checks(const std::vector<Recorded>&);
/// What the runs cannot show: air, the influence of the spacing. Empty where there is no water.
std::string limits(const std::vector<Recorded>&);
/// What the guards of the runs found.
std::string alarms(const std::vector<Recorded>&);
/// What the spacings resolve, and whether a second one was run.
std::string resolution(const std::vector<Recorded>&);
std::string how_to_run_again(const std::vector<Recorded>&);

/// What a column is called above a table or a plot, and on its axis.
struct Names {
  std::string title, axis;
};
Names names_of(const std::vector<Recorded>&, const std::string& column);

/// The plots of `histories` alone: one figure per quantity that any of the runs recorded, and its first peak.
/// heading: before each title, e.g. "6.26 m/s".
std::string history_figures(const std::vector<Recorded>&, const std::string& heading);

/// The parts of a study's page; `runs` has the readable content of its run folders, by the run's name.
using RunsByName = std::map<std::string, Recorded>;

std::string study_summary(const StudyData&);
std::string study_histories(const StudyData&, const RunsByName&);
std::string study_convergence(const StudyData&);
std::string study_checks(const StudyData&);
std::string study_claims(const StudyData&);
std::string study_runs(const StudyData&, const RunsByName&);

/// The whole page: one file, its style within, nothing fetched from anywhere. The contents are made from the
/// sections of `body`.
std::string page(const std::string& title, const std::string& lead, const std::string& body);

}  // namespace strake::report
