#pragma once

#include "proto/ranks/communicator.hpp"

#include <mpi.h>

#include <optional>

namespace strake {

/// The processes of an MPI run. They sleep while they wait for an announcement.
class MpiCommunicator final : public Communicator {
 public:
  explicit MpiCommunicator(MPI_Comm all);
  int rank() const override { return rank_; }
  int size() const override { return size_; }

  /// Sends bytes of the first rank to all others.
  void announce(std::span<const std::byte>);
  /// Returns what the first rank announces.
  Bytes await_announcement();
  MPI_Comm all_ranks() const { return all_; }

  /// Tells the other ranks that a call has ended here, and returns for each rank whether it failed there. A
  /// rank that has failed waits some seconds for the others. Nothing: they still wait for it in messages, and
  /// the ranks are broken.
  std::optional<std::vector<bool>> end_call(bool failed);
  /// Whether a message would no longer find the other ranks ready for it: MPI must end them.
  bool is_broken() const { return broken_; }

 protected:
  std::vector<Bytes> gather_all(std::span<const std::byte> own) override;
  void pass_to_first(std::span<const std::byte> own,
                     const std::function<void(std::span<const std::byte>)>& visit) override;
  Bytes gather_equal(std::span<const std::byte> own) override;
  void pass(std::span<const Bytes> to, std::span<Bytes> from) override;
  std::vector<std::int64_t> pass_lengths(std::span<const std::int64_t> to) override;

 private:
  void await(MPI_Request) const;
  MPI_Comm all_, ends_ = MPI_COMM_NULL;  // of messages, of ends of calls
  int rank_ = 0, size_ = 1;
  std::uint8_t own_end_ = 0;  // MPI reads and writes it and `all_ends_` while ranks end a call
  std::vector<std::uint8_t> all_ends_;
  bool broken_ = false;
};

}  // namespace strake
