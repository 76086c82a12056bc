#include "fluid/particles/state_archive.hpp"

#include "fluid/particles/archive_member.hpp"
#include "fluid/particles/columns.hpp"

#include <string_view>

namespace strake::fluid {

namespace {
constexpr const char* buckets_name = "rank_buckets";
}

template <int dim>
void save(const State<dim>& state, ArchiveSource& archive) {
  const auto write = [&](const char* name, const auto& member) { put(archive, name, member); };
  for_each_column(write, state);
  for_each_value(write, state);
}

template <int dim>
void save_share(const State<dim>& share, ArchiveSource& entries, ArchiveSource& values) {
  for_each_column([&](const char* name, const auto& column) { put(entries, name, column); }, share);
  for_each_value([&](const char* name, const auto& value) { put(values, name, value); }, share);
  if (share.rank_buckets.size() != share.kind.size()) return;  // the water was not divided yet
  values.integer.erase(buckets_name);
  put(entries, buckets_name, share.rank_buckets);
}

template <int dim>
std::vector<std::string> entry_names() {
  std::vector<std::string> names = {buckets_name};
  const State<dim> none;
  for_each_column([&](const char* name, const auto&) { names.emplace_back(name); }, none);
  return names;
}

namespace {

/// Whether version 0.1.0 did not have that member. Where a checkpoint lacks it, it is zero or empty.
bool is_newer(std::string_view name) {
  return name.starts_with("air_") || name.starts_with("rank_") || name == "pressure_acceleration" ||
         name.starts_with("face_lag") || name == "wet_part";
}

}  // namespace

template <int dim>
State<dim> load(const Archive& archive) {
  State<dim> state;
  const auto read = [&](const char* name, auto& member) {
    if (!is_newer(name) || archive.real.contains(name)) get(archive, name, member);
  };
  for_each_column(read, state);
  for_each_value(read, state);
  const Eigen::Index n = state.position.cols();
  if (state.pressure_acceleration.cols() == 0) state.pressure_acceleration.setZero(dim, n);
  for (Eigen::VectorXd* column : {&state.face_lag, &state.face_lag_rate})
    if (column->size() == 0) column->setZero(n);
  const auto check = [&](const char*, const auto& column) {
    if (length(column) != state.position.cols()) refuse("has arrays of different lengths");
  };
  for_each_column(check, state);
  return state;
}

Archive with_names(Archive archive) {
  if (!archive.real.contains("scalars") && !archive.integer.contains("counts")) return archive;
  const Eigen::MatrixXd scalars = entry(archive.real, "scalars");
  const std::vector<std::int64_t> counts = entry(archive.integer, "counts");
  if (scalars.size() != 4 || counts.size() != 6)
    throw Error(ExitCode::case_file, "checkpoint of the fluid", "was written by a version before 0.1.0",
                "resume with the version that started the run, or start it again");
  Eigen::Index scalar = 0;
  for (const char* name : {"time", "contact_time", "inner_fraction_min", "residual_step"})
    put(archive, name, scalars(scalar++));
  std::size_t count = 0;
  for (const char* name : {"step", "lost", "voids", "penetrations", "behind_walls", "openings"})
    put(archive, name, counts[count++]);
  archive.real.erase("scalars");
  archive.integer.erase("counts");
  return archive;
}

template void save<2>(const State<2>&, ArchiveSource&);
template void save<3>(const State<3>&, ArchiveSource&);
template void save_share<2>(const State<2>&, ArchiveSource&, ArchiveSource&);
template void save_share<3>(const State<3>&, ArchiveSource&, ArchiveSource&);
template std::vector<std::string> entry_names<2>();
template std::vector<std::string> entry_names<3>();
template State<2> load<2>(const Archive&);
template State<3> load<3>(const Archive&);

}  // namespace strake::fluid
