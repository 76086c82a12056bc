#pragma once

#include "proto/participant.hpp"

#include <functional>

namespace strake {

/// A participant whose whole state is one vector; only its step is given by the caller. Rewind discards the
/// trial vector, commit keeps it, and a checkpoint is the vector in a file.
class VectorParticipant final : public Participant {
 public:
  /// From the committed state at the begin of the window to the trial state at its end. Called again with the
  /// same committed state after each rewind; keeps nothing of its own in between.
  using Step = std::function<Advanced(const Window&, const Input&, const Eigen::VectorXd& committed,
                                      Eigen::VectorXd& trial)>;
  VectorParticipant(InterfaceMesh, Description, Eigen::VectorXd initial, Step);

  const InterfaceMesh& mesh() const override { return mesh_; }
  const Description& description() const override { return description_; }
  void start(const Window&, const Input&) override;
  Advanced finish() override;
  void rewind() override;
  void commit(bool write_output) override;
  void checkpoint(const std::filesystem::path& folder) override;  // folder/<mesh name>.h5
  void resume(const std::filesystem::path& folder) override;

 private:
  std::filesystem::path file_in(const std::filesystem::path& folder) const;
  InterfaceMesh mesh_;
  Description description_;
  Eigen::VectorXd committed_, trial_;
  Step step_;
  Advanced advanced_;
};

}  // namespace strake
