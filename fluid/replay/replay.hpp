#pragma once

#include "coupler/participant/interface_record.hpp"
#include "proto/participant.hpp"

#include <filesystem>

namespace strake::fluid {

/// The participant that returns the recorded force of an earlier run, whatever the motion. Over windows of
/// another length it returns the mean of the record, so that the impulse is kept.
class Replay final : public Participant {
 public:
  /// source: the run folder, for messages. Throws Error(case_file) when the record lies on other points than
  /// the structure's mesh in `setup`.
  Replay(InterfaceRecord, std::filesystem::path source, const Setup& setup);
  const InterfaceMesh& mesh() const override { return record_.mesh; }
  const Description& description() const override { return description_; }
  void start(const Window& window, const Input&) override;
  Advanced finish() override;
  void rewind() override { steps_ = committed_steps_; }
  void commit(bool) override { committed_steps_ = steps_; }
  void checkpoint(const std::filesystem::path& folder) override;
  void resume(const std::filesystem::path& folder) override;

 private:
  InterfaceRecord record_;
  std::filesystem::path source_;
  Description description_;
  Window window_;
  int steps_ = 0, committed_steps_ = 0;
};

}  // namespace strake::fluid
