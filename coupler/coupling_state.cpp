#include <fmt/format.h>

#include "coupler/scheme.hpp"
#include "proto/error.hpp"

namespace strake {

using Eigen::MatrixXd;

void CouplingState::save(Archive& archive) const {
  archive.integer["coupling.counts"] = {windows, sends_velocity ? 1 : 0,
                                        static_cast<std::int64_t>(motion.size())};
  archive.real["coupling.velocity_scale"] = MatrixXd::Constant(1, 1, velocity_scale);
  if (force.size() > 0) archive.real["coupling.force"] = force;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const std::string name = fmt::format("coupling.motion{}.", k);
    archive.real[name + "time"] = MatrixXd::Constant(1, 1, motion[k].time);
    archive.real[name + "displacement"] = motion[k].displacement;
    if (motion[k].velocity.size() > 0) archive.real[name + "velocity"] = motion[k].velocity;
  }
  accelerator.save(archive);
}

void CouplingState::load(const Archive& archive) {
  *this = {};
  const auto get = [&](const std::string& name, bool required = true) -> MatrixXd {
    const auto found = archive.real.find("coupling." + name);
    if (found != archive.real.end()) return found->second;
    if (!required) return {};
    throw Error(ExitCode::case_file, "checkpoint, coupler.h5", fmt::format("coupling.{} is missing", name),
                "resume from the other checkpoint");
  };
  const auto counts = archive.integer.find("coupling.counts");
  if (counts == archive.integer.end() || counts->second.size() != 3)
    throw Error(ExitCode::case_file, "checkpoint, coupler.h5", "coupling.counts is missing",
                "resume from the other checkpoint");
  windows = static_cast<int>(counts->second[0]);
  sends_velocity = counts->second[1] != 0;
  velocity_scale = get("velocity_scale").value();
  force = get("force", false);
  for (std::int64_t k = 0; k < counts->second[2]; ++k) {
    const std::string name = fmt::format("motion{}.", k);
    motion.push_back({get(name + "time").value(), get(name + "displacement"), get(name + "velocity", false)});
  }
  accelerator.load(archive);
}

}  // namespace strake
