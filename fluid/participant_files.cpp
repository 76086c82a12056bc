#include "fluid/participant.hpp"
#include "fluid/particles/state_archive.hpp"
#include "proto/error.hpp"
#include "proto/ranks/agreement.hpp"

#include <fmt/format.h>

#include <utility>

// Frames and checkpoints of the fluid.

namespace strake::fluid {

template <int dim>
void FluidParticipant<dim>::write_frame() {
  if (frames_.of_one) frames_.of_one->write(frame());
  if (frames_.of_ranks) frames_.of_ranks->write(frame());
}

/// Writes the water at t = 0, once: when the first window begins, not while `check` looks at a case.
template <int dim>
void FluidParticipant<dim>::write_first_frame() {
  if (!std::exchange(progress_.has_first_frame, true)) write_frame();
}

/// Returns the frame of all particles with a pressure: water, first layers of walls and bodies, structure
/// particles. Dummies and particles that have left the tank are not shown. Faces over air show its pressure
/// and its gap. Of several ranks each has the particles that it owns; before the water is divided, the first
/// one has the layer particles.
template <int dim>
Frame FluidParticipant<dim>::frame() const {
  const State<dim>& state = simulation_.state();
  const Subdomain<dim>* part = simulation_.ranks().subdomain();
  std::vector<Eigen::Index> shown;
  for (std::size_t i = 0; i < state.kind.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (has_pressure(state.kind[i]) && !simulation_.is_removed(state, k) && (!part || part->shows(k)))
      shown.push_back(k);
  }
  const auto n = static_cast<Eigen::Index>(shown.size());
  const auto air = simulation_.air_on_faces();
  Eigen::MatrixXd gap(1, air.gap.size() > 0 ? n : 0);
  Eigen::MatrixXd pressure(1, n), velocity = Eigen::MatrixXd::Zero(3, n), kind(1, n), surface(1, n), id(1, n);
  Frame frame{.time = committed_.progress.time,
              .position = Points::Zero(3, n),
              .cells = {},
              .point_data = {},
              .cell_data = {}};
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto i = shown[static_cast<std::size_t>(k)];
    frame.position.col(k).template head<dim>() = state.position.col(i);
    velocity.col(k).template head<dim>() = state.velocity.col(i);
    pressure(0, k) = state.pressure[i];
    if (gap.size() > 0) {  // a dry face has the pressure of its air
      gap(0, k) = air.gap[i];
      if (air.gap[i] > 0) pressure(0, k) = air.pressure[i];
    }
    kind(0, k) = static_cast<double>(state.kind[static_cast<std::size_t>(i)]);
    surface(0, k) = state.surface[static_cast<std::size_t>(i)];
    id(0, k) = static_cast<double>(state.id[static_cast<std::size_t>(i)]);
  }
  frame.point_data = {{"pressure", "Pa", std::move(pressure)},
                      {"velocity", "m/s", std::move(velocity)},
                      {"kind", "1", std::move(kind)},
                      {"surface", "1", std::move(surface)},
                      {"id", "1", std::move(id)}};
  if (gap.size() > 0) frame.point_data.push_back({"gap", "m", std::move(gap)});
  return frame;
}

template <int dim>
void FluidParticipant<dim>::checkpoint(const std::filesystem::path& folder) {
  flush();  // a resume continues from these files
  Archive small;
  save(committed_.measurements, small);
  small.integer["participant.steps"] = {committed_.progress.steps};
  small.real["participant.time"] = Eigen::MatrixXd::Constant(1, 1, committed_.progress.time);
  ArchiveSource archive = source_of(small);
  const std::filesystem::path file = folder / "fluid.h5";
  Communicator* const several = simulation_.ranks().communicator();
  if (several == nullptr) {
    save(committed_.fluid.state, archive);
    write_archive(file, archive);
    return;
  }
  // Each rank writes a share of the whole, in the order of the whole; the first one joins them.
  const State<dim> share = simulation_.share_of(committed_.fluid);
  ArchiveSource entries;
  save_share(share, entries, archive);
  FilePart part;
  on_all_ranks(*several, [&] {
    const std::filesystem::path own = folder / fmt::format("fluid.{:04}.h5", several->rank());
    write_archive(own, entries);
    part = part_of(own, share.position.cols(), folder);
  });
  const std::vector<FilePart> parts = parts_of_all(*several, part);
  on_first_rank(*several, [&] { join_archive(file, archive, parts); });
}

/// Reads a checkpoint, on several ranks what this rank needs of it. It may have been written by any number of
/// ranks.
template <int dim>
State<dim> FluidParticipant<dim>::read_checkpoint(const std::filesystem::path& file, Archive& archive) const {
  const auto check = [&](std::int64_t particles) {
    if (particles != simulation_.particles())
      throw Error(ExitCode::case_file, file.string(),
                  fmt::format("holds {} particles, the case makes {}", particles, simulation_.particles()),
                  "resume with the case the run was started with");
  };
  const Subdomain<dim>* const part = simulation_.ranks().subdomain();
  if (part == nullptr) {
    archive = with_names(read_archive(file));
    State<dim> state = load<dim>(archive);
    check(state.position.cols());
    return state;
  }
  check(shape_in_archive(file, "position")[1]);
  archive = with_names(
      read_archive(file, ArchiveSlice{entry_names<dim>(), simulation_.particles(), part->ranges_of_part()}));
  return load<dim>(archive);
}

template <int dim>
void FluidParticipant<dim>::resume(const std::filesystem::path& folder) {
  flush();
  Archive archive;
  State<dim> state;
  Measurements measurements;
  const auto read = [&] {
    state = read_checkpoint(folder / "fluid.h5", archive);
    measurements = load_measurements(archive, parameters_.probes.size());
  };
  Communicator* const several = simulation_.ranks().communicator();
  several == nullptr ? read() : on_all_ranks(*several, read);
  const auto steps = archive.integer.find("participant.steps");
  progress_.steps =
      steps != archive.integer.end() && !steps->second.empty() ? steps->second.front() : state.step;
  const auto time = archive.real.find("participant.time");  // version 0.1.0 did not write it
  progress_.time = time != archive.real.end() && time->second.size() == 1 ? time->second(0) : state.time;
  progress_.has_first_frame = true;
  several == nullptr ? simulation_.set_state(state) : simulation_.set_share(std::move(state));
  measurements_ = measurements;
  committed_ = {simulation_.snapshot(), std::move(measurements), progress_};
  if (frames_.of_one) frames_.of_one->truncate(committed_.progress.time);
  if (frames_.of_ranks) frames_.of_ranks->truncate(committed_.progress.time);
}

#define STRAKE_INSTANTIATE(dim)                                                                             \
  template void FluidParticipant<dim>::write_frame();                                                       \
  template void FluidParticipant<dim>::write_first_frame();                                                 \
  template Frame FluidParticipant<dim>::frame() const;                                                      \
  template void FluidParticipant<dim>::checkpoint(const std::filesystem::path&);                            \
  template State<dim> FluidParticipant<dim>::read_checkpoint(const std::filesystem::path&, Archive&) const; \
  template void FluidParticipant<dim>::resume(const std::filesystem::path&);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
