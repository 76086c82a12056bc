#pragma once

#include "proto/participant.hpp"
#include "proto/ranks/mpi_communicator.hpp"

#include <functional>
#include <memory>

namespace strake {

/// Builds the participant of one rank.
using RankFactory = std::function<std::unique_ptr<Participant>(const Setup&)>;

/// A participant of several ranks as one. It answers the coupler on the first rank, and announces to
/// the others what they have to do (`work_for_first_rank`). All ranks have the run's folder.
class RankedParticipant final : public Participant {
 public:
  RankedParticipant(MpiCommunicator&, const Setup&, const RankFactory&);
  RankedParticipant(const RankedParticipant&) = delete;
  RankedParticipant& operator=(const RankedParticipant&) = delete;

  const InterfaceMesh& mesh() const override { return own_->mesh(); }
  const Description& description() const override { return own_->description(); }
  void start(const Window&, const Input&) override;
  Advanced finish() override;
  void rewind() override;
  void commit(bool write_output) override;
  void checkpoint(const std::filesystem::path& folder) override;
  void resume(const std::filesystem::path& folder) override;
  void flush() override;

 private:
  MpiCommunicator& ranks_;
  std::unique_ptr<Participant> own_;
};

/// What a rank other than the first does: all that the first one announces, until it announces the end.
void work_for_first_rank(MpiCommunicator&, const RankFactory&);
/// Lets the other ranks end. The first rank calls it last.
void announce_end(MpiCommunicator&);

/// Makes a call on all ranks, and waits until it has ended on each of them. An exception on one rank becomes
/// an Error on all, which names the rank and the cause. What all ranks throw stays as it is: they have agreed
/// on it, and the first one tells the coupler.
///
/// A rank that fails alone leaves the others in messages that it never answers. It waits for them some
/// seconds, then throws, and `is_broken` of its ranks says that MPI must end them.
void call_together(MpiCommunicator&, const std::function<void()>& call);

}  // namespace strake
