#include "structure/ccx/whole_history.hpp"

#include "proto/error.hpp"
#include "structure/body/surface.hpp"
#include "structure/replay/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace strake::structure::ccx {
namespace {

// Window ends are sums of many; forces that crossed a mapping of coinciding points carry rounding.
constexpr double same_time = 1e-6, same_load = 1e-6;

/// The cubic through two values and their rates at both ends of an interval h; s = 0 … 1 along it.
struct Cubic {
  double a, b, da, db;  // factors of both values and both rates
  static Cubic at(double s, double h) {
    const double s2 = s * s, s3 = s2 * s;
    return {2 * s3 - 3 * s2 + 1, 3 * s2 - 2 * s3, h * (s3 - 2 * s2 + s), h * (s3 - s2)};
  }
  Points operator()(const Points& u0, const Points& v0, const Points& u1, const Points& v1) const {
    return a * u0 + b * u1 + da * v0 + db * v1;
  }
};

/// The interval of ascending times that contains `time`, and the position in it.
template <class Item>
std::pair<std::size_t, double> place(const std::vector<Item>& items, double time) {
  const auto above = std::upper_bound(items.begin(), items.end(), time,
                                      [](double t, const Item& item) { return t < item.time; });
  const auto last = static_cast<std::ptrdiff_t>(items.size()) - 2;
  const std::ptrdiff_t i = std::clamp<std::ptrdiff_t>(std::distance(items.begin(), above) - 1, 0, last);
  const Item &from = items[static_cast<std::size_t>(i)], &to = items[static_cast<std::size_t>(i) + 1];
  const double s = std::clamp((time - from.time) / (to.time - from.time), 0.0, 1.0);
  return {static_cast<std::size_t>(i), s < same_time ? 0 : s > 1 - same_time ? 1 : s};
}

}  // namespace

InterfaceRecord no_load(const Parameters& p) {
  InterfaceRecord record;
  record.mesh = surface(p);
  const Points nothing = Points::Zero(3, record.mesh.position.cols());
  record.initial_displacement = record.initial_velocity = nothing;
  const auto n = static_cast<long>(std::ceil(p.end_time / p.window * (1 - same_time)));
  for (long w = 0; w < n; ++w) {
    record.windows.push_back({.t = static_cast<double>(w) * p.window, .dt = p.window});
    record.force.push_back(nothing);
  }
  return record;
}

WholeHistory::WholeHistory(const Parameters& p, deck::Model model, const InterfaceRecord& record)
    : CalculixSolver(p, std::move(model)) {
  require_same_mesh(record.mesh, interface(), p.load_run.string());
  for (std::size_t w = 0; w < record.windows.size(); ++w) {
    if (record.windows[w].t > p.end_time * (1 - same_time)) break;
    windows_.push_back(record.windows[w]);
    force_.push_back(record.force[w]);
    largest_ = std::max(largest_, force_.back().cwiseAbs().maxCoeff());
  }
  if (windows_.empty())
    throw Error(ExitCode::case_file, p.load_run.string(), "has no window before end_time",
                "name a longer run");
  constexpr double most = 1e9;  // more windows than any record has
  wanted_.field_every =
      static_cast<int>(std::clamp(std::round(p.output_every / windows_.front().dt), 1.0, most));
  state_.now = at_rest();
  saved_ = state_;
}

void WholeHistory::begin_at(Now found) {
  state_.now = std::move(found);
  saved_ = state_;
}

void WholeHistory::require_known(double t, double dt, const Load& load) const {
  const std::string& source = parameters_.load_run.string();
  const double end = windows_.back().t + windows_.back().dt;
  if (t + dt > end + same_time * dt)
    throw Error(ExitCode::case_file, source,
                fmt::format("is over: the record ends at {:.6g} s, the window at {:.6g} s", end, t + dt),
                fmt::format("end_time = {:.6g}", end));
  const Points felt = load.mean(t, t + dt, interface().position.cols());
  Points expected = Points::Zero(3, felt.cols());
  for (std::size_t w = 0; w < windows_.size(); ++w) {
    const double from = std::max(t, windows_[w].t), to = std::min(t + dt, windows_[w].t + windows_[w].dt);
    if (to > from) expected += (to - from) / dt * force_[w];
  }
  if ((felt - expected).cwiseAbs().maxCoeff() > same_load * largest_)
    throw Error(ExitCode::case_file, "structure.ccx.calls = \"once\"",
                fmt::format("another load than the one recorded in {} has come", source),
                "structure.ccx.calls = \"window\" takes any load");
}

void WholeHistory::compute() {
  std::vector<deck::WindowLoad> loads;
  for (std::size_t w = 0; w < windows_.size(); ++w) loads.push_back(load_of(windows_[w], force_[w]));
  const double start = windows_.front().t;
  const std::string what =
      fmt::format("all {} windows to {:.6g} s", windows_.size(), windows_.back().t + windows_.back().dt);
  runner_.run(deck::calculix_windows(model_, wanted_, loads), {}, windows_.size(), what);
  std::vector<Printed> printed = read_printed(runner_.file("dat"), wanted_.node, model_.n_nodes());
  std::vector<BodyField> fields = read_fields(runner_.file("frd"), model_.n_nodes());
  if (printed.size() != windows_.size())
    runner_.fail(what, fmt::format("ended well and printed {} windows", printed.size()));
  // CalculiX counts from zero and prints few digits of a time; the windows' times are used instead.
  for (std::size_t w = 0; w < printed.size(); ++w) printed[w].time = windows_[w].t + windows_[w].dt;
  // It adds up the strain energies of all steps' ends.
  for (std::size_t w = printed.size() - 1; w > 0; --w) printed[w].strain -= printed[w - 1].strain;
  for (BodyField& field : fields) {
    const auto nearest = std::min_element(printed.begin(), printed.end(), [&](const auto& a, const auto& b) {
      return std::abs(a.time - start - field.time) < std::abs(b.time - start - field.time);
    });
    field.time = nearest->time;
  }
  const Now rest = at_rest();
  computed_ = {{.time = start, .displacement = rest.displacement, .velocity = rest.velocity}};
  std::move(printed.begin(), printed.end(), std::back_inserter(computed_));
  drawn_ = {rest.body};
  drawn_.front().time = start;
  std::move(fields.begin(), fields.end(), std::back_inserter(drawn_));
}

void WholeHistory::go_to(double time) {
  const auto [i, s] = place(computed_, time);
  const Printed &from = computed_[i], &to = computed_[i + 1];
  const Cubic between = Cubic::at(s, to.time - from.time);
  Now& now = state_.now;
  now.time = time;
  now.displacement = between(from.displacement, from.velocity, to.displacement, to.velocity);
  now.velocity = (1 - s) * from.velocity + s * to.velocity;
  state_.strain = ((1 - s) * from.strain + s * to.strain) / thickness_;
  state_.kinetic = ((1 - s) * from.kinetic + s * to.kinetic) / thickness_;
  if (drawn_.size() < 2) return;
  const auto [j, r] = place(drawn_, time);
  const BodyField &before = drawn_[j], &after = drawn_[j + 1];
  const Cubic drawn = Cubic::at(r, after.time - before.time);
  now.body.time = time;
  now.body.displacement = drawn(before.displacement, before.velocity, after.displacement, after.velocity);
  now.body.velocity = (1 - r) * before.velocity + r * after.velocity;
  now.body.von_mises = (1 - r) * before.von_mises + r * after.von_mises;
}

void WholeHistory::advance(double t, double dt, const Load& load) {
  require_known(t, dt, load);
  if (computed_.empty()) compute();
  go_to(t + dt);
  ++state_.steps;
}

Energy WholeHistory::energy() const {
  return {.kinetic = state_.kinetic, .strain = state_.strain, .external = 0};
}

void WholeHistory::write(Archive& archive) const {
  archive.real["ccx.time"] = Eigen::MatrixXd::Constant(1, 1, saved_.now.time);
  archive.integer["ccx.steps"] = {saved_.steps};
}

void WholeHistory::read(const Archive& archive) {
  state_.now = at_rest();
  state_.steps = static_cast<int>(archive.integer.at("ccx.steps").at(0));
  if (state_.steps > 0) {
    if (computed_.empty()) compute();
    go_to(archive.real.at("ccx.time")(0, 0));
  }
  saved_ = state_;
}

std::vector<std::string> WholeHistory::lines() const {
  const std::string load = parameters_.load_run.empty()
                               ? std::string("the case's own load")
                               : "the load recorded in " + parameters_.load_run.string();
  return {headline(),
          fmt::format("Newmark 1/4-1/2; one call before the first window, for {}: {} windows to {:.6g} s",
                      load, windows_.size(), windows_.back().t + windows_.back().dt),
          "energies in the frame of the supports; the work of the load is not followed"};
}

}  // namespace strake::structure::ccx
