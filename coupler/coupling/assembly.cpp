#include "coupler/coupling/assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr const char* saved_velocity = "bodies.velocity";  // [m/s] in coupler.h5

/// The columns of one body out of a field of all.
Field cut(const Field& all, Index first, Index count) {
  return {all.quantity, all.unit, all.conservative, MatrixXd(all.value.middleCols(first, count))};
}

/// A load as a body takes it that knows no histories: of a mean its mean over the window, else the last
/// value.
///   f = Σ_j f_j (t_j − t_(j−1)) / dt, where f_j is the mean since the sample before.
Sample without_history(const Window& window, const std::vector<Sample>& samples) {
  Sample last = samples.back();
  for (std::size_t k = 0; k < last.fields.size(); ++k) {
    if (!last.fields[k].conservative) continue;
    double begin = window.t;
    MatrixXd mean = MatrixXd::Zero(last.fields[k].value.rows(), last.fields[k].value.cols());
    for (const Sample& sample : samples) {
      if (sample.time <= window.t) continue;
      mean += (sample.time - begin) / window.dt * sample.fields[k].value;
      begin = sample.time;
    }
    last.fields[k].value = std::move(mean);
  }
  return last;
}

/// Whether the load is a history: more than one sample inside the window.
bool is_history(const Window& window, const std::vector<Sample>& samples) {
  return std::count_if(samples.begin(), samples.end(),
                       [&](const Sample& sample) { return sample.time > window.t; }) > 1;
}

}  // namespace

Assembly::Assembly(std::vector<Body> bodies, std::set<std::string> probes, double nearest)
    : bodies_(std::move(bodies)), probes_(std::move(probes)), nearest_(nearest) {
  join_meshes();
  join_descriptions();
  refuse_contact(ExitCode::case_file, "at the start", committed_.displacement);
}

void Assembly::join_meshes() {
  Index points = 0, faces = 0;
  bool masses = true;
  mesh_.name = "structure";
  mesh_.dimension = bodies_.front().solver->mesh().dimension;
  for (const Body& body : bodies_) {
    const InterfaceMesh& own = body.solver->mesh();
    if (!own.meshes.empty())
      throw Error(ExitCode::case_file, body.name,
                  fmt::format("has {} meshes, and one of several bodies has one mesh", own.meshes.size()),
                  "give all its data on one mesh, or compute it as [structure], the only body");
    if (own.dimension != mesh_.dimension)
      throw Error(
          ExitCode::case_file, body.name,
          fmt::format("has {} dimensions, {} has {}", own.dimension, bodies_.front().name, mesh_.dimension),
          "all bodies of a case lie in one space");
    mesh_.parts.push_back({body.name, points, faces});
    points += own.position.cols();
    faces += own.faces.cols();
    masses = masses && own.mass.size() > 0;
  }
  mesh_.position.resize(3, points);
  mesh_.faces.resize(mesh_.dimension, faces);
  if (masses) mesh_.mass.resize(points);
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const InterfaceMesh& own = bodies_[k].solver->mesh();
    const auto& [name, point, face] = mesh_.parts[k];
    mesh_.position.middleCols(point, own.position.cols()) = own.position;
    if (own.faces.cols() > 0)
      mesh_.faces.middleCols(face, own.faces.cols()) = own.faces.array() + static_cast<int>(point);
    if (masses) mesh_.mass.segment(point, own.mass.size()) = own.mass;
  }
}

Index Assembly::points_of(std::size_t body) const {
  return bodies_[body].solver->mesh().position.cols();
}

void Assembly::join_descriptions() {
  const Index n = mesh_.position.cols();
  committed_ = {MatrixXd(MatrixXd::Zero(3, n)), MatrixXd(MatrixXd::Zero(3, n))};
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Body& body = bodies_[k];
    const StructureSample sent = fields_of_structure(*body.solver);
    if (!sent.motion || !sent.others.empty())
      throw Error(ExitCode::case_file, body.name, "sends other fields than its displacement",
                  "several bodies exchange displacement and force with the water; a case of one body may "
                  "exchange other fields");
    announced_.push_back(sent);
    const Index first = mesh_.parts[k].first_point, count = points_of(k);
    committed_.displacement.edit().middleCols(first, count) = sent.motion->displacement;
    committed_.velocity.edit().middleCols(first, count) = sent.motion->velocity;
    const Description& own = body.solver->description();
    description_.prescribed = (k == 0 || description_.prescribed) && own.prescribed;
    description_.history = description_.history || own.history;
    description_.partner_initial = description_.partner_initial || own.partner_initial;
    description_.cannot_resume = description_.cannot_resume || own.cannot_resume;
    description_.dt_limit = std::min(description_.dt_limit, own.dt_limit);
    for (const Column& column : own.columns)
      description_.columns.push_back({column_name(body.name, column.name), column.unit});
  }
  last_ = committed_;
  description_.initial = StructureSample{0, committed_, {}}.fields();
}

std::string Assembly::column_name(const std::string& body, const std::string& column) const {
  const bool of_probe = probes_.contains(column) || probes_.contains(column.substr(0, column.rfind('.')));
  return of_probe ? column : body + "." + column;
}

void Assembly::refuse_contact(ExitCode code, const std::string& when, const Points& displacement) const {
  auto gap = closest_bodies(mesh_, displacement, nearest_);
  const bool close = gap.has_value();
  if (code == ExitCode::case_file)
    if (const auto within = body_inside_another(mesh_, displacement)) gap = within;
  if (!gap) return;
  const std::string place =
      mesh_.dimension == 2 ? fmt::format("({:.4g}, {:.4g}) m", gap->at.x(), gap->at.y())
                           : fmt::format("({:.4g}, {:.4g}, {:.4g}) m", gap->at.x(), gap->at.y(), gap->at.z());
  const std::string what =
      gap->inside
          ? fmt::format("{} {} {} {}", gap->one, close ? "reaches into" : "lies inside", gap->other, when)
          : fmt::format("{:.3g} m apart {}, the nearest is one fluid.spacing, {:.3g} m", gap->distance, when,
                        nearest_);
  throw Error(code, fmt::format("{} and {}, at {}", gap->one, gap->other, place), what,
              gap->inside ? "move one of them"
              : code == ExitCode::case_file
                  ? "move one of them, or choose a smaller fluid.spacing"
                  : "end the run before they meet, or choose a smaller fluid.spacing; Strake computes no "
                    "contact of bodies");
}

Input Assembly::input_of(std::size_t body, const Window& window, const Input& all) const {
  const Description& own = bodies_[body].solver->description();
  const Index first = mesh_.parts[body].first_point, count = points_of(body);
  Input input;
  for (const Sample& sample : all.samples) {
    const bool earlier = sample.time <= window.t && all.samples.size() > 1;
    if (earlier && !own.history && !own.partner_initial) continue;
    Sample part{sample.time, {}};
    for (const Field& field : sample.fields) part.fields.push_back(cut(field, first, count));
    input.samples.push_back(std::move(part));
  }
  if (!own.history && is_history(window, input.samples))
    input.samples = {without_history(window, input.samples)};
  return input;
}

void Assembly::start(const Window& window, const Input& input) {
  window_ = window;
  if (begins_) begin_ = {StructureSample{window.t, committed_, {}}};
  begins_ = false;
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    bodies_[k].solver->start_with(window, input_of(k, window, input));
}

Advanced Assembly::finish() {
  Advanced all;
  last_ = committed_;
  sends_velocity_.assign(bodies_.size(), false);
  bool velocity = false;  // some body sends its own
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    Advanced own = bodies_[k].solver->finish();
    if (own.retry_smaller_dt) {
      if (!all.retry_smaller_dt || own.dt_limit < all.dt_limit) {
        all.dt_limit = own.dt_limit;
        all.why = bodies_[k].name + (own.why.empty() ? "" : ": " + own.why);
        all.fix = own.fix;
      }
      all.retry_smaller_dt = true;
      continue;
    }
    if (all.retry_smaller_dt) continue;
    all.dt_limit = std::min(all.dt_limit, own.dt_limit);
    gather_monitor(bodies_[k].name, own.monitor, all.monitor);
    sends_velocity_[k] = take_motion(k, own);
    velocity = sends_velocity_[k] || velocity;
  }
  if (all.retry_smaller_dt) return all;
  all.output = StructureSample{0, last_, {}}.fields();
  if (!velocity) all.output.pop_back();
  return all;
}

/// A body that sends no velocity has the one of constant acceleration, v = 2 (u − u_0)/dt − v_0.
bool Assembly::take_motion(std::size_t body, Advanced& answer) {
  const Index first = mesh_.parts[body].first_point, count = points_of(body);
  const Place place{bodies_[body].name.c_str(), window_, 0, 0};
  StructureSample sent =
      received_fields(std::move(answer.output), announced_[body], bodies_[body].solver->mesh(), place);
  const MatrixXd before = committed_.displacement.middleCols(first, count);
  const bool sends = sent.motion->velocity.size() > 0;
  if (!sends)
    sent.motion->velocity = MatrixXd(2 / window_.dt * (sent.motion->displacement - before) -
                                     committed_.velocity.middleCols(first, count));
  last_.displacement.edit().middleCols(first, count) = sent.motion->displacement;
  last_.velocity.edit().middleCols(first, count) = sent.motion->velocity;
  return sends;
}

/// Counts, seconds and memory of all bodies are added; of a check the largest value counts.
void Assembly::gather_monitor(const std::string& body, const std::map<std::string, double>& own,
                              std::map<std::string, double>& all) const {
  for (const auto& [name, value] : own) {
    const auto [entry, first] = all.try_emplace(name, value);
    if (name.starts_with("check.")) {
      entry->second = std::max(entry->second, value);
    } else if (name.starts_with("count.") || name.starts_with("memory.")) {
      if (!first) entry->second += value;
    } else {
      if (first) all.erase(entry);
      const bool stage = name.starts_with("seconds."), alarm = name.starts_with("alarm.");
      const std::string column = name.substr(0, name.find(':'));
      all[stage   ? "seconds." + body + "." + name.substr(8)
          : alarm ? name
                  : column_name(body, column) + name.substr(column.size())] = value;
    }
  }
}

void Assembly::rewind() {
  for (const Body& body : bodies_) body.solver->rewind();
  last_ = committed_;
}

void Assembly::commit(bool write_output) {
  refuse_contact(ExitCode::solver_fault, fmt::format("at t = {:.6g} s", window_.t + window_.dt),
                 last_.displacement);
  for (const Body& body : bodies_) body.solver->commit(write_output);
  keep_begin();
  committed_ = last_;
}

/// Keeps the motion after the first window, and corrects that after the second where a body sends none.
void Assembly::keep_begin() {
  if (begin_.empty()) return;
  StructureSample now = {window_.t + window_.dt, last_, {}};
  if (begin_.size() == 1) {
    begin_.push_back(std::move(now));
    return;
  }
  correct_start(begin_[0], begin_[1], now);
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    if (!sends_velocity_[k])
      last_.velocity.edit().middleCols(mesh_.parts[k].first_point, points_of(k)) =
          now.motion->velocity.middleCols(mesh_.parts[k].first_point, points_of(k));
  begin_.clear();
}

void Assembly::checkpoint(const std::filesystem::path& folder) {
  for (const Body& body : bodies_) body.solver->checkpoint(folder);
}

void Assembly::resume(const std::filesystem::path& folder) {
  for (const Body& body : bodies_) body.solver->resume(folder);
}

void Assembly::save(Archive& archive) const {
  archive.real[saved_velocity] = committed_.velocity;
}

void Assembly::load(const Archive& archive, const StructureSample& now, long windows) {
  // After one window: the start is what the bodies announced, at t = 0. So no checkpoint has to hold it.
  if (windows == 1) begin_ = {StructureSample{0, committed_, {}}, now};
  begins_ = windows == 0;
  committed_ = *now.motion;
  const auto saved = archive.real.find(saved_velocity);
  if (saved != archive.real.end() && saved->second.cols() == mesh_.position.cols())
    committed_.velocity = saved->second;
  last_ = committed_;
}

}  // namespace strake
