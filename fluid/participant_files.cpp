#include "fluid/participant.hpp"
#include "fluid/particles/state_archive.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <utility>

// Frames and checkpoints of the fluid.

namespace strake::fluid {

/// Writes what the first rank has of the whole fluid.
template <int dim>
void FluidParticipant<dim>::write_frame() {
  if (!frames_ && !simulation_.ranks().several()) return;
  const Frame whole = frame();
  if (frames_) frames_->write(whole);
}

/// Writes the water at t = 0, once: when the first window begins, not while `check` looks at a case.
template <int dim>
void FluidParticipant<dim>::write_first_frame() {
  if (!std::exchange(progress_.has_first_frame, true)) write_frame();
}

/// Returns the frame of all particles with a pressure: water, first layers of walls and bodies, structure
/// particles. Dummies and particles that have left the tank are not shown. Faces over air show its pressure
/// and its gap.
template <int dim>
Frame FluidParticipant<dim>::frame() const {
  const State<dim>& state = simulation_.whole();
  std::vector<Eigen::Index> shown;
  for (std::size_t i = 0; i < state.kind.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (has_pressure(state.kind[i]) && !simulation_.is_removed(state, k)) shown.push_back(k);
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
  const bool several = simulation_.ranks().several();
  const State<dim> joined = several ? simulation_.whole_of(committed_.fluid) : State<dim>();
  if (!is_first_rank()) return;
  save(several ? joined : committed_.fluid.state, archive);
  write_archive(folder / "fluid.h5", archive);
}

template <int dim>
void FluidParticipant<dim>::resume(const std::filesystem::path& folder) {
  flush();
  const std::filesystem::path file = folder / "fluid.h5";
  const Archive archive = with_names(read_archive(file));
  State<dim> state = load<dim>(archive);
  Measurements measurements = load_measurements(archive, parameters_.probes.size());
  if (state.position.cols() != simulation_.particles())
    throw Error(
        ExitCode::case_file, file.string(),
        fmt::format("holds {} particles, the case makes {}", state.position.cols(), simulation_.particles()),
        "resume with the case the run was started with");
  const auto steps = archive.integer.find("participant.steps");
  progress_.steps =
      steps != archive.integer.end() && !steps->second.empty() ? steps->second.front() : state.step;
  const auto time = archive.real.find("participant.time");  // version 0.1.0 did not write it
  progress_.time = time != archive.real.end() && time->second.size() == 1 ? time->second(0) : state.time;
  progress_.has_first_frame = true;
  simulation_.set_state(state);
  measurements_ = measurements;
  committed_ = {simulation_.snapshot(), std::move(measurements), progress_};
  if (frames_) frames_->truncate(committed_.progress.time);
}

#define STRAKE_INSTANTIATE(dim)                                                  \
  template void FluidParticipant<dim>::write_frame();                            \
  template void FluidParticipant<dim>::write_first_frame();                      \
  template Frame FluidParticipant<dim>::frame() const;                           \
  template void FluidParticipant<dim>::checkpoint(const std::filesystem::path&); \
  template void FluidParticipant<dim>::resume(const std::filesystem::path&);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
