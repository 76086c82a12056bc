#include "coupler/participant/interface_record.hpp"

#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "proto/files/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Two times are the same within this part of a window.
constexpr double slack = 1e-6;

std::filesystem::path block_path(const std::filesystem::path& run_folder, std::size_t block) {
  return run_folder / "interface" / fmt::format("{:06}.h5", block + 1);
}

/// One column per window, 3n values each.
template <class Matrix>
MatrixXd columns(const std::vector<Matrix>& fields) {
  MatrixXd all(fields.front().size(), static_cast<Index>(fields.size()));
  for (std::size_t w = 0; w < fields.size(); ++w) all.col(static_cast<Index>(w)) = fields[w].reshaped();
  return all;
}

Points field(const MatrixXd& all, Index window) {
  return all.col(window).reshaped(3, all.rows() / 3);
}

Archive to_archive(const InterfaceRecord& record) {
  const auto n_windows = static_cast<Index>(record.windows.size());
  Archive archive;
  archive.integer["mesh"] = {record.mesh.dimension, record.mesh.faces.rows(), record.mesh.faces.cols()};
  if (record.mesh.faces.size() > 0) {
    auto& faces = archive.integer["faces"];
    for (const int point : record.mesh.faces.reshaped()) faces.push_back(point);
  }
  for (const MeshPart& part : record.mesh.parts)
    archive.integer["body." + part.name] = {part.first_point, part.first_face};
  archive.real["position"] = record.mesh.position;
  if (record.mesh.mass.size() > 0) archive.real["mass"] = record.mesh.mass;
  if (record.initial_displacement.size() > 0)
    archive.real["initial_displacement"] = record.initial_displacement;
  if (record.initial_velocity.size() > 0) archive.real["initial_velocity"] = record.initial_velocity;
  MatrixXd& time = archive.real["time"] = MatrixXd(1, n_windows);
  MatrixXd& dt = archive.real["dt"] = MatrixXd(1, n_windows);
  for (Index w = 0; w < n_windows; ++w) {
    time(0, w) = record.windows[static_cast<std::size_t>(w)].t;
    dt(0, w) = record.windows[static_cast<std::size_t>(w)].dt;
  }
  for (const auto& [name, other] : record.other) archive.real[name] = columns(other.value);
  if (record.displacement.empty()) return archive;
  archive.real["displacement"] = columns(record.displacement);
  archive.real["force"] = columns(record.force);
  // A structure that sends velocity sends it in every window; where it did not in some, none is kept.
  const bool moving = std::none_of(record.velocity.begin(), record.velocity.end(),
                                   [](const Points& v) { return v.size() == 0; });
  if (moving) archive.real["velocity"] = columns(record.velocity);
  return archive;
}

ArchiveUnits units_of(const InterfaceRecord& record) {
  ArchiveUnits unit = {{"position", "m"},           {"mass", "kg"},      {"initial_displacement", "m"},
                       {"initial_velocity", "m/s"}, {"time", "s"},       {"dt", "s"},
                       {"displacement", "m"},       {"velocity", "m/s"}, {"force", "N"}};
  for (const auto& [name, other] : record.other) unit[name] = other.unit;
  return unit;
}

/// Of a field that is recorded by its sender and quantity, not as motion or force.
bool is_other(const std::string& name) {
  return name.starts_with("structure.") || name.starts_with("fluid.") || name.starts_with("attachments.");
}

class BlockReader {
 public:
  BlockReader(const std::filesystem::path& path, const Archive& archive) : path_(path), archive_(archive) {}
  MatrixXd real(const std::string& name, Index rows, Index columns, bool required = true) const {
    const auto found = archive_.real.find(name);
    if (found == archive_.real.end()) {
      if (required) throw broken(name + " is missing");
      return {};
    }
    if ((rows >= 0 && found->second.rows() != rows) || (columns >= 0 && found->second.cols() != columns))
      throw broken(fmt::format("{} is {}×{}, expected {}×{}", name, found->second.rows(),
                               found->second.cols(), rows, columns));
    if (!found->second.allFinite()) throw broken(name + " holds what is no finite number");
    return found->second;
  }
  std::vector<std::int64_t> integer(const std::string& name, std::size_t size) const {
    const auto found = archive_.integer.find(name);
    if (found == archive_.integer.end() || found->second.size() != size)
      throw broken(fmt::format("{} is missing or does not have {} values", name, size));
    return found->second;
  }
  Error broken(const std::string& problem) const {
    return {ExitCode::case_file, path_.string(), "is no interface record\n  " + problem,
            "name a run folder whose coupled run went well"};
  }

 private:
  const std::filesystem::path& path_;
  const Archive& archive_;
};

/// Sizes are compared with what the file holds before anything of that size is made.
InterfaceMesh read_mesh(const BlockReader& in, const Archive& archive) {
  InterfaceMesh mesh;
  mesh.name = "structure";
  mesh.position = in.real("position", 3, -1);
  const Index n = mesh.position.cols();
  const auto shape = in.integer("mesh", 3);
  const auto found = archive.integer.find("faces");
  const std::vector<std::int64_t> faces =
      found != archive.integer.end() ? found->second : std::vector<std::int64_t>{};
  const auto size = static_cast<std::int64_t>(faces.size());
  if (shape[0] < 2 || shape[0] > 3 || shape[1] < 0 || shape[1] > 4 || shape[2] < 0 || shape[2] > size ||
      shape[1] * shape[2] != size)
    throw in.broken("mesh has no such faces");
  mesh.dimension = static_cast<int>(shape[0]);
  mesh.faces.resize(shape[1], shape[2]);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (faces[k] < 0 || faces[k] >= n) throw in.broken(fmt::format("a face names point {}", faces[k]));
    mesh.faces.reshaped()[static_cast<Index>(k)] = static_cast<int>(faces[k]);
  }
  mesh.parts = parts_in(archive);
  MeshPart before;
  for (const MeshPart& part : mesh.parts) {
    if (part.first_point < before.first_point || part.first_point > n ||
        part.first_face < before.first_face || part.first_face > shape[2])
      throw in.broken(fmt::format("body {} has no such points or faces", part.name));
    before = part;
  }
  mesh.mass = in.real("mass", n, 1, false).reshaped();
  return mesh;
}

/// One file, as it stands: velocities that were not sent stay empty.
InterfaceRecord read_block(const std::filesystem::path& path) {
  const Archive archive = read_archive(path);
  const BlockReader in(path, archive);
  InterfaceRecord record;
  record.mesh = read_mesh(in, archive);
  const Index n = record.mesh.position.cols();
  if (const MatrixXd u = in.real("initial_displacement", 3, n, archive.real.contains("displacement"));
      u.size() > 0)
    record.initial_displacement = u;
  if (const MatrixXd v = in.real("initial_velocity", 3, n, false); v.size() > 0) record.initial_velocity = v;
  const MatrixXd time = in.real("time", 1, -1), dt = in.real("dt", 1, time.cols());
  const ArchiveUnits unit = read_archive_units(path);
  for (const auto& [name, values] : archive.real) {
    if (!is_other(name)) continue;
    if (n == 0 || values.rows() % n != 0) throw in.broken(fmt::format("{} does not fit {} points", name, n));
    const MatrixXd all = in.real(name, -1, time.cols());
    auto& other = record.other[name];
    if (const auto own = unit.find(name); own != unit.end()) other.unit = own->second;
    for (Index w = 0; w < time.cols(); ++w) other.value.push_back(all.col(w).reshaped(all.rows() / n, n));
  }
  const bool plays = record.other.empty() || archive.real.contains("displacement");
  const MatrixXd displacement = in.real("displacement", 3 * n, time.cols(), plays);
  const MatrixXd velocity = in.real("velocity", 3 * n, time.cols(), false);
  const MatrixXd force = in.real("force", 3 * n, time.cols(), plays);
  for (Index w = 0; w < time.cols(); ++w) {
    if (!(dt(0, w) > 0)) throw in.broken(fmt::format("window {} has length {:g} s", w, dt(0, w)));
    record.windows.push_back({time(0, w), dt(0, w)});
    if (!plays) continue;
    record.displacement.push_back(field(displacement, w));
    record.velocity.push_back(velocity.size() > 0 ? field(velocity, w) : Points());
    record.force.push_back(field(force, w));
  }
  return record;
}

/// The window that ends at or after `time`, and how far it is gone, 0 to 1.
struct Within {
  std::size_t window;
  double s;
};
Within locate(const std::vector<Window>& windows, double time) {
  const auto found = std::lower_bound(windows.begin(), windows.end(), time,
                                      [](const Window& w, double t) { return w.t + w.dt * (1 + slack) < t; });
  const auto window = std::min(static_cast<std::size_t>(found - windows.begin()), windows.size() - 1);
  double s = std::clamp((time - windows[window].t) / windows[window].dt, 0.0, 1.0);
  if (s < slack) s = 0;
  if (s > 1 - slack) s = 1;
  return {window, s};
}

/// Displacement and velocity at the begin of a window. Without a first velocity it is the secant's.
std::pair<Points, Points> start_of_window(const InterfaceRecord& record, std::size_t k) {
  if (k > 0) return {record.displacement[k - 1], record.velocity[k - 1]};
  const Points& u0 = record.initial_displacement;
  if (record.initial_velocity.size() > 0) return {u0, record.initial_velocity};
  return {u0, Points((record.displacement[0] - u0) / record.windows[0].dt)};
}

}  // namespace

void InterfaceRecord::append(const Window& window, const Points& u, const Points& v, const Points& f) {
  const Points& before = displacement.empty() ? initial_displacement : displacement.back();
  const Points& speed = velocity.empty() ? initial_velocity : velocity.back();
  const Points secant = (u - before) / window.dt;
  Points followed = v;
  if (v.size() == 0) followed = speed.size() == 0 ? secant : Points(2 * secant - speed);
  windows.push_back(window);
  displacement.push_back(u);
  velocity.push_back(std::move(followed));
  force.push_back(f);
}

// Cubic in s = (t − t_n)/dt with the values u and slopes v of both ends:
//   u(s) = u_0 + (3s² − 2s³)(u_1 − u_0) + dt [(s − 2s² + s³) v_0 + (s³ − s²) v_1]
Points InterfaceRecord::displacement_at(double time) const {
  if (windows.empty() || time <= start()) return initial_displacement;
  const auto [k, s] = locate(windows, time);
  if (s == 1) return displacement[k];
  const auto [u0, v0] = start_of_window(*this, k);
  const double dt = windows[k].dt;
  return u0 + (3 - 2 * s) * s * s * (displacement[k] - u0) +
         dt * (s * (1 - s) * (1 - s) * v0 + s * s * (s - 1) * velocity[k]);
}

// v(s) = (6s − 6s²)(u_1 − u_0)/dt + (1 − 4s + 3s²) v_0 + (3s² − 2s) v_1
Points InterfaceRecord::velocity_at(double time) const {
  if (windows.empty()) return initial_velocity;
  const auto [k, s] = locate(windows, time);
  if (s == 1) return velocity[k];
  const auto [u0, v0] = start_of_window(*this, k);
  const double dt = windows[k].dt;
  if (s == 0) return v0;
  return 6 * s * (1 - s) / dt * (displacement[k] - u0) + (1 - s) * (1 - 3 * s) * v0 +
         s * (3 * s - 2) * velocity[k];
}

// Σ_w f_w |[t, t + dt] ∩ window w| / dt
Points InterfaceRecord::mean_force(double t, double dt) const {
  Points sum = Points::Zero(3, mesh.position.cols());
  const auto first = std::lower_bound(windows.begin(), windows.end(), t,
                                      [](const Window& w, double time) { return w.t + w.dt <= time; });
  for (auto w = static_cast<std::size_t>(first - windows.begin());
       w < windows.size() && windows[w].t < t + dt; ++w) {
    const double overlap = std::min(t + dt, windows[w].t + windows[w].dt) - std::max(t, windows[w].t);
    // The same window again: its force untouched by round-off of the times.
    if (std::abs(overlap - dt) <= slack * dt && std::abs(windows[w].dt - dt) <= slack * dt) return force[w];
    sum += std::max(overlap, 0.0) / dt * force[w];
  }
  return sum;
}

InterfaceRecorder::InterfaceRecorder(std::filesystem::path run_folder, InterfaceMesh mesh,
                                     const std::vector<Field>& initial, int windows_per_file)
    : folder_(std::move(run_folder)), per_file_(static_cast<std::size_t>(std::max(1, windows_per_file))) {
  const Field* u = find(initial, "displacement");
  const Field* v = find(initial, "velocity");
  const bool moves = initial.empty() || u || v;  // else it sends fields of other quantities
  if (moves) record_.initial_displacement = Points::Zero(3, mesh.position.cols());
  if (u) record_.initial_displacement = u->value;
  if (v) record_.initial_velocity = v->value;
  record_.mesh = std::move(mesh);
  std::error_code error;
  std::filesystem::create_directories(folder_ / "interface", error);
  if (error) throw Error(ExitCode::cannot_write, (folder_ / "interface").string(), error.message());
}

std::filesystem::path InterfaceRecorder::file(std::size_t block) const {
  return block_path(folder_, block);
}

void InterfaceRecorder::append(const Window& window, const Values& displacement, const Values& velocity,
                               const Values& force, const std::vector<Field>& from_structure,
                               const std::vector<Field>& from_fluid,
                               const std::vector<Field>& from_attachments) {
  record_.windows.push_back(window);
  if (displacement.size() > 0) {
    record_.displacement.push_back(displacement);
    record_.velocity.push_back(velocity);
    record_.force.push_back(force);
  }
  const auto add = [this](const std::string& side, const std::vector<Field>& fields) {
    for (const Field& field : fields) {
      InterfaceRecord::Other& other = record_.other[side + field.quantity];
      other.unit = field.unit;
      other.value.push_back(field.value);
    }
  };
  add("structure.", from_structure);
  add("fluid.", from_fluid);
  add("attachments.", from_attachments);
  if (record_.windows.size() < per_file_) return;
  write_block(block_++);
  keep(0);
}

/// Of the block's windows the first n.
void InterfaceRecorder::keep(std::size_t n) {
  record_.windows.resize(n);
  for (auto* fields : {&record_.displacement, &record_.velocity, &record_.force})
    fields->resize(std::min(n, fields->size()));
  for (auto& [name, other] : record_.other) other.value.resize(n);
}

void InterfaceRecorder::write_block(std::size_t block) {
  // The part of a block that `flush` wrote is replaced only by bytes that are on the disk as well.
  std::error_code ignored;
  const bool replaces = std::filesystem::exists(file(block), ignored);
  write_archive(file(block), to_archive(record_), units_of(record_), replaces);
}

void InterfaceRecorder::flush() {
  if (!record_.windows.empty()) write_block(block_);
  for (; on_disk_ < block_; ++on_disk_) sync_to_disk(file(on_disk_));
  if (!record_.windows.empty()) sync_to_disk(file(block_));
  sync_to_disk(folder_ / "interface");
}

void InterfaceRecorder::resume(double time) {
  std::size_t files = 0;
  std::error_code ignored;
  while (std::filesystem::exists(file(files), ignored)) ++files;
  double end = 0;
  const auto reaches = [&] { return end >= time * (1 - slack); };
  for (block_ = 0; block_ < files && !reaches(); ++block_) {
    InterfaceRecord kept = read_block(file(block_));
    const auto beyond = std::find_if(kept.windows.begin(), kept.windows.end(),
                                     [time](const Window& w) { return w.t + w.dt > time + slack * w.dt; });
    const auto n = static_cast<std::size_t>(beyond - kept.windows.begin());
    if (n > 0) end = kept.windows[n - 1].t + kept.windows[n - 1].dt;
    if (n >= per_file_) continue;
    record_.windows = std::move(kept.windows);
    record_.displacement = std::move(kept.displacement);
    record_.velocity = std::move(kept.velocity);
    record_.force = std::move(kept.force);
    record_.other = std::move(kept.other);
    keep(n);
    break;
  }
  if (!reaches())
    throw Error(ExitCode::case_file, (folder_ / "interface").string(),
                fmt::format("ends at {:.6g} s, the checkpoint was taken at {:.6g} s", end, time),
                "run it again with --force, or under another --tag");
  flush();
  for (std::size_t b = record_.windows.empty() ? block_ : block_ + 1; b < files; ++b)
    std::filesystem::remove(file(b), ignored);
}

InterfaceRecord read_interface_record(const std::filesystem::path& run_folder) {
  std::error_code none;
  if (!std::filesystem::exists(block_path(run_folder, 0), none))
    throw Error(ExitCode::case_file, (run_folder / "interface").string(), "holds no interface record",
                "name the folder of a coupled run, e.g. runs/plate_entry");
  InterfaceRecord record;
  for (std::size_t b = 0; std::filesystem::exists(block_path(run_folder, b), none); ++b) {
    const std::filesystem::path path = block_path(run_folder, b);
    const InterfaceRecord block = read_block(path);
    if (b == 0) {
      record.mesh = block.mesh;
      record.initial_displacement = block.initial_displacement;
      record.initial_velocity = block.initial_velocity;
    }
    if (block.mesh.position.cols() != record.mesh.position.cols())
      throw Error(ExitCode::case_file, path.string(),
                  fmt::format("has {} interface points, the files before it {}", block.mesh.position.cols(),
                              record.mesh.position.cols()),
                  "the files of one run belong together");
    if (block.displacement.empty() && !block.windows.empty()) {
      std::string names;
      for (const auto& [name, other] : block.other) names += (names.empty() ? "" : ", ") + name;
      throw Error(ExitCode::case_file, path.string(),
                  fmt::format("holds no motion and force, which is what can be played, but {}", names),
                  "name the folder of a run that exchanged displacement and force");
    }
    for (const auto& [name, other] : block.other) {
      auto& all = record.other[name];
      all.unit = other.unit;
      all.value.insert(all.value.end(), other.value.begin(), other.value.end());
    }
    for (std::size_t w = 0; w < block.windows.size(); ++w) {
      if (!record.windows.empty() &&
          std::abs(block.windows[w].t - record.end()) > slack * block.windows[w].dt)
        throw Error(ExitCode::case_file, path.string(),
                    fmt::format("goes on at {:g} s, the files before it end at {:g} s", block.windows[w].t,
                                record.end()),
                    "the files of one run belong together");
      record.append(block.windows[w], block.displacement[w], block.velocity[w], block.force[w]);
    }
  }
  return record;
}

}  // namespace strake
