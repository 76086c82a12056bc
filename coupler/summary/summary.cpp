#include "coupler/summary/summary.hpp"

#include "coupler/compare/record.hpp"
#include "coupler/coupling/window_report.hpp"
#include "coupler/summary/history_metrics.hpp"
#include "coupler/summary/notes.hpp"
#include "proto/lookup.hpp"
#include "proto/probe.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sys/resource.h>
#include <utility>

namespace strake {

namespace {

Json lookup(const std::map<std::string, double>& monitor, const std::string& key) {
  return finite(at_or(monitor, key, std::nan("")));
}

// Counts are whole numbers, and read better as such.
Json count(const std::map<std::string, double>& monitor, const std::string& what) {
  const double value = at_or(monitor, "count." + what, std::nan(""));
  return std::isfinite(value) ? Json(static_cast<long long>(std::llround(value))) : Json();
}

Json either(const std::map<std::string, double>& first, const std::map<std::string, double>& second,
            const std::string& key) {
  return first.count(key) != 0 ? lookup(first, key) : lookup(second, key);
}

Json stages(const std::map<std::string, double>& monitor) {
  const std::string prefix = "seconds.";
  Json seconds = Json::object();
  for (const auto& [key, value] : monitor)
    if (key.starts_with(prefix)) seconds[key.substr(prefix.size())] = finite(value);
  return seconds;
}

/// What each rank of a solver has done; empty where it has one.
Json ranks(const std::map<std::string, double>& monitor, const std::string& body = "") {
  Json list = Json::array();
  for (const RankShare& share : rank_shares(monitor, body))
    list.push_back({{"busy", finite(share.busy)},
                    {"halo", finite(share.halo)},
                    {"waiting", finite(share.waiting)},
                    {"particles", std::llround(share.particles)},
                    {"ghosts", std::llround(share.ghosts)},
                    {"cpu", finite(share.cpu)},
                    {"memory_bytes", std::llround(share.memory)},
                    {"sent_bytes", std::llround(share.sent)}});
  return list;
}

/// The ranks of both sides, and of each of several bodies that has ranks.
Json all_ranks(const std::map<std::string, double>& fluid, const std::map<std::string, double>& structure,
               const std::vector<std::string>& bodies) {
  Json all = {{"fluid", ranks(fluid)}, {"structure", ranks(structure)}};
  for (const std::string& body : bodies)
    if (Json list = ranks(structure, body); !list.empty()) all[body] = std::move(list);
  return all;
}

Json bytes(double value) {
  return std::isfinite(value) && value > 0 ? Json(std::llround(value)) : Json(nullptr);
}

const char* const metrics[] = {"first_peak", "time_of_first_peak", "peak", "time_of_peak",
                               "impulse",    "mean_peak_50us",     "final"};

}  // namespace

Json json_of(const Verdict& verdict) {
  const bool judged = verdict.result != Verdict::Result::not_reached;  // not reached: pass is null
  return {{"probe", verdict.probe},
          {"metric", verdict.metric},
          {"value", finite(verdict.value)},
          {"reference", finite(verdict.reference)},
          {"tolerance", finite(verdict.tolerance)},
          {"pass", judged ? Json(verdict.result == Verdict::Result::pass) : Json(nullptr)},
          {"kind", verdict.kind},
          {"source", verdict.source}};
}

Summary::Summary(std::string case_name, std::string tag)
    : case_(std::move(case_name)), tag_(std::move(tag)) {}

void Summary::describe(const std::vector<Column>& columns) {
  for (const Column& column : columns) unit_[column.name] = column.unit;
}

void Summary::add(const CommittedWindow& window) {
  const WindowReport& report = window.report;
  time_ = window.time;
  ++windows_;
  iterations_ += report.iterations;
  max_iterations_ = std::max(max_iterations_, report.iterations);
  unconverged_ += report.converged ? 0 : 1;
  taken_back_ += window.taken_back;
  coupled_ = coupled_ || !report.log.empty() || (!report.fluid.empty() && !report.structure.empty());
  work_gap_ = std::max(work_gap_, report.work.gap());
  fluid_ = report.fluid;
  structure_ = report.structure;
  results_.clear();  // a metric that a probe no longer reports is withdrawn
  for (const auto* monitor : {&report.fluid, &report.structure})
    for (const auto& [key, value] : *monitor) {
      const auto colon = key.find(':');
      if (colon == std::string::npos) continue;
      const std::string probe = key.substr(0, colon);
      results_[key] = value;
      const bool known = std::find(probes_.begin(), probes_.end(), probe) != probes_.end();
      if (!known && key != contact_of_body) probes_.push_back(probe);
    }
  drop_peaks_before_contact();
}

/// Earliest contact that a sensor has found [s]; 0 where nobody looks for one, infinite while it is awaited.
double Summary::contact_time() const {
  if (fluid_.contains("count.awaiting_contact")) return std::numeric_limits<double>::infinity();
  std::optional<double> contact;
  for (const auto& [key, value] : results_)
    if (key.ends_with(":contact")) contact = std::min(contact.value_or(value), value);
  return contact.value_or(0);
}

/// A first peak is one after contact (cases/VALIDATION.md, "Definitions"), which only the fluid detects.
/// Values of a structure's probe before contact are vibrations of a body in the air. A gauge, and a sensor on
/// a wall, know no contact.
void Summary::drop_peaks_before_contact() {
  const double contact = contact_time();
  for (const std::string& probe : probes_) {
    const auto time = results_.find(probe + ":time_of_first_peak");
    if (time == results_.end() || time->second >= contact || !structure_.contains(time->first)) continue;
    results_.erase(time);
    results_.erase(probe + ":first_peak");
  }
}

void Summary::take_history(const Table& history) {
  const double contact = contact_time();
  of_history_ = columns_without_record(history, probes_);
  blows_ = blow_lines(history, of_history_);
  for (const std::string& column : of_history_)
    for (const auto& [metric, value] :
         metrics_of_column(history, column, std::isfinite(contact) ? std::optional(contact) : std::nullopt))
      results_[column + ":" + metric] = value;
  drop_peaks_of_the_start(history);
  drop_peaks_of_round_off();
}

/// Which time round-off first falls by a fifth tells nothing.
void Summary::drop_peaks_of_round_off() {
  std::map<std::string, double> largest;  // by vector
  const auto peak = [&](const std::string& probe) { return std::abs(at_or(results_, probe + ":peak")); };
  for (const auto* names : {&probes_, &of_history_})
    for (const std::string& probe : *names)
      if (!is_moment(probe)) largest[vector_of(probe)] = std::max(largest[vector_of(probe)], peak(probe));
  for (const auto* names : {&probes_, &of_history_})
    for (const std::string& probe : *names) {
      if (!results_.contains(probe + ":peak") || peak(probe) > round_off_share * largest[vector_of(probe)])
        continue;
      results_.erase(probe + ":first_peak");
      results_.erase(probe + ":time_of_first_peak");
    }
}

/// A quantity that falls from the value it began with has no first peak.
void Summary::drop_peaks_of_the_start(const Table& history) {
  const bool met_water =
      std::ranges::any_of(results_, [](const auto& result) { return result.first.ends_with(":contact"); });
  for (const auto* names : {&probes_, &of_history_})
    for (const std::string& probe : *names) {
      const auto value = results_.find(probe + ":first_peak"),
                 time = results_.find(probe + ":time_of_first_peak");
      if (value == results_.end() || time == results_.end()) continue;
      const bool begins_with_contact = results_.contains(probe + ":contact") || (is_load(probe) && met_water);
      if (!falls_towards(curve_of(history, probe), {time->second, value->second}, begins_with_contact))
        continue;
      results_.erase(value);
      results_.erase(time);
    }
}

double Summary::mean_iterations() const {
  return windows_ == 0 ? 0 : static_cast<double>(iterations_) / static_cast<double>(windows_);
}

std::vector<RaisedAlarm> Summary::alarms() const {
  std::map<std::string, double> both = structure_;
  both.insert(fluid_.begin(), fluid_.end());
  return alarms_of(both);
}

Json Summary::json() const {
  Json json;
  json["case"] = case_;
  json["tag"] = tag_;
  json["exit_code"] = static_cast<int>(exit_code);
  json["end_time"] = finite(time_);
  json["windows"] = windows_;
  json["iterations"] = {{"mean", mean_iterations()},
                        {"max", max_iterations_},
                        {"unconverged", unconverged_},
                        {"taken_back", taken_back_}};
  json["particles"] = {
      {"fluid", count(fluid_, "fluid")},
      {"wall", count(fluid_, "wall")},
      {"solid", structure_.count("count.solid") != 0 ? count(structure_, "solid") : count(fluid_, "solid")}};
  json["steps"] = {{"fluid", count(fluid_, "steps")}, {"structure", count(structure_, "steps")}};
  json["steps_committed"] = {{"fluid", count(fluid_, "steps_committed")},
                             {"structure", count(structure_, "steps_committed")}};
  Json coupler = Json::object();
  for (const auto& [stage, seconds] : coupler_seconds) coupler[stage] = finite(seconds);
  json["seconds"] = {{"wall", finite(wall_seconds)},
                     {"fluid", stages(fluid_)},
                     {"structure", stages(structure_)},
                     {"coupler", coupler}};
  json["ranks"] = all_ranks(fluid_, structure_, bodies);
  json["peak_memory_bytes"] = {{"fluid", bytes(at_or(fluid_, "memory.peak"))},
                               {"structure", bytes(at_or(structure_, "memory.peak"))},
                               {"coupler", bytes(coupler_memory)}};

  json["probes"] = Json::object();
  for (const auto* names : {&probes_, &of_history_})
    for (const std::string& probe : *names) {
      const auto unit = unit_.find(probe);
      Json entry;
      entry["unit"] = unit == unit_.end() ? Json(nullptr) : Json(unit->second);
      for (const char* metric : metrics) entry[metric] = lookup(results_, probe + ":" + metric);
      json["probes"][probe] = entry;
    }

  json["checks"]["work_gap"] = coupled_ && mechanical ? finite(work_gap_) : Json(nullptr);
  for (const char* check :
       {"momentum_gap", "structure_energy_drift", "inner_fraction_min", "voids", "openings", "penetrations",
        "lost", "volume_drift", "largest_speed", "largest_pressure"})
    json["checks"][check] = either(fluid_, structure_, std::string("check.") + check);
  for (const std::string check : {"air_mass", "air_energy"})
    if (const auto found = fluid_.find("check." + check); found != fluid_.end())
      json["checks"][check] = finite(found->second);
  json["checks"]["grades"] = grades_of(json["checks"], number_of(json["particles"], "fluid").value_or(0));
  json["alarms"] = Json::array();
  for (const RaisedAlarm& alarm : alarms()) json["alarms"].push_back(json_of(alarm));

  std::vector<std::string> resolved = resolution;
  resolved.insert(resolved.end(), blows_.begin(), blows_.end());
  json["resolution"] = resolved;
  json["failure"] = failure_json(structure_, bodies);

  json["compare"] = Json::array();
  for (const Verdict& verdict : verdicts) json["compare"].push_back(json_of(verdict));
  return json;
}

void Summary::save(Archive& archive) const {
  archive.integer["summary.counts"] = {windows_, iterations_, unconverged_, max_iterations_, taken_back_};
  archive.real["summary.sums"] = Eigen::Vector4d(time_, work_gap_, wall_seconds, coupled_ ? 1 : 0);
}

void Summary::load(const Archive& archive) {
  const auto& counts = archive.integer.at("summary.counts");
  windows_ = static_cast<long>(counts.at(0));
  iterations_ = static_cast<long>(counts.at(1));
  unconverged_ = static_cast<long>(counts.at(2));
  max_iterations_ = static_cast<int>(counts.at(3));
  taken_back_ = static_cast<long>(counts.at(4));
  const Eigen::MatrixXd& sums = archive.real.at("summary.sums");
  time_ = sums(0);
  work_gap_ = sums(1);
  wall_seconds = sums(2);
  coupled_ = sums(3) > 0;
}

double cpu_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

namespace {

/// A metric below this share of its reference is noise before the event of its block. It is then judged at
/// the end of the run. The share is the 5 % of the first peak in cases/VALIDATION.md, "Definitions".
constexpr double too_early = 0.05;

}  // namespace

ComparisonStatus::ComparisonStatus(const CaseView& view) {
  const CaseLookup lookup = lookup_in(view.value);
  for (const CompareBlock& block : view.blocks)
    if (applies(block, lookup)) blocks_.push_back(block);
  settled_.assign(blocks_.size(), false);
}

std::vector<Verdict> ComparisonStatus::settle(const RunData& now) {
  std::vector<Verdict> news;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (settled_[i]) continue;
    const std::vector<Verdict> verdicts = judge(blocks_[i], now);
    bool known = !verdicts.empty();
    for (const Verdict& verdict : verdicts)
      known = known && verdict.result != Verdict::Result::not_reached &&
              std::abs(verdict.value.value_or(0)) >= too_early * std::abs(verdict.reference);
    if (!known) continue;
    settled_[i] = true;
    news.insert(news.end(), verdicts.begin(), verdicts.end());
  }
  return news;
}

std::vector<Verdict> ComparisonStatus::all(const RunData& data) const {
  std::vector<Verdict> verdicts;
  for (const CompareBlock& block : blocks_)
    for (Verdict& verdict : judge(block, data)) verdicts.push_back(std::move(verdict));
  return verdicts;
}

}  // namespace strake
