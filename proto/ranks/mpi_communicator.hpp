#pragma once

#include "proto/ranks/communicator.hpp"

#include <mpi.h>

namespace strake {

/// The processes of an MPI run. They sleep while they wait for an announcement.
class MpiCommunicator final : public Communicator {
 public:
  explicit MpiCommunicator(MPI_Comm all);
  int rank() const override { return rank_; }
  int size() const override { return size_; }
  std::vector<Bytes> gather(std::span<const std::byte> own) override;
  void exchange(std::span<const Bytes> to, std::span<Bytes> from) override;

  /// Sends bytes of the first rank to all others.
  void announce(std::span<const std::byte>);
  /// Returns what the first rank announces.
  Bytes await_announcement();

 private:
  void await(MPI_Request) const;
  MPI_Comm all_;
  int rank_ = 0, size_ = 1;
};

}  // namespace strake
