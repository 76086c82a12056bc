#include "proto/files/vector_participant.hpp"

#include "proto/error.hpp"
#include "proto/files/result_file.hpp"

#include <utility>

namespace strake {

VectorParticipant::VectorParticipant(InterfaceMesh mesh, Description description, Eigen::VectorXd initial,
                                     Step step)
    : mesh_(std::move(mesh)),
      description_(std::move(description)),
      committed_(std::move(initial)),
      trial_(committed_),
      step_(std::move(step)) {}

void VectorParticipant::start(const Window& window, const Input& input) {
  trial_ = committed_;
  advanced_ = step_(window, input, committed_, trial_);
}

Advanced VectorParticipant::finish() {
  return std::move(advanced_);
}

void VectorParticipant::rewind() {
  trial_ = committed_;
}

void VectorParticipant::commit(bool) {
  committed_ = trial_;
}

std::filesystem::path VectorParticipant::file_in(const std::filesystem::path& folder) const {
  return folder / (mesh_.name + ".h5");
}

void VectorParticipant::checkpoint(const std::filesystem::path& folder) {
  write_archive(file_in(folder), {.real = {{"state", committed_}}, .integer = {}});
}

void VectorParticipant::resume(const std::filesystem::path& folder) {
  const Archive archive = read_archive(file_in(folder));
  const auto state = archive.real.find("state");
  if (state == archive.real.end() || state->second.size() != committed_.size())
    throw Error(ExitCode::case_file, file_in(folder).string(), "is no checkpoint of this participant",
                "resume with the case that the checkpoint was made with");
  trial_ = committed_ = state->second.reshaped();
}

}  // namespace strake
