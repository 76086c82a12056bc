#include "proto/ranks/mpi_communicator.hpp"

#include <chrono>
#include <limits>
#include <numeric>
#include <thread>

namespace strake {

namespace {

/// Longest message [bytes]. MPI counts in int.
constexpr std::size_t longest = std::numeric_limits<int>::max();
/// Pause between two looks for an announcement, which grows up to the second [µs].
constexpr int first_pause = 20, longest_pause = 1000;

int count_of(std::size_t bytes) {
  if (bytes > longest)
    throw std::length_error("a message between ranks is longer than 2 GiB: use more ranks");
  return static_cast<int>(bytes);
}

}  // namespace

// An error of MPI ends all ranks, which is MPI's default.
MpiCommunicator::MpiCommunicator(MPI_Comm all) : all_(all) {
  MPI_Comm_rank(all, &rank_);
  MPI_Comm_size(all, &size_);
}

std::vector<Bytes> MpiCommunicator::gather(std::span<const std::byte> own) {
  const auto ranks = static_cast<std::size_t>(size_);
  std::vector<int> count(ranks), start(ranks, 0);
  const int mine = count_of(own.size());
  MPI_Allgather(&mine, 1, MPI_INT, count.data(), 1, MPI_INT, all_);
  std::size_t total = 0;
  for (std::size_t r = 0; r < ranks; ++r) {
    start[r] = count_of(total);
    total += static_cast<std::size_t>(count[r]);
  }
  Bytes bytes(static_cast<std::size_t>(count_of(total)));
  MPI_Allgatherv(own.data(), mine, MPI_BYTE, bytes.data(), count.data(), start.data(), MPI_BYTE, all_);
  std::vector<Bytes> all(ranks);
  for (std::size_t r = 0; r < ranks; ++r)
    all[r].assign(bytes.begin() + start[r], bytes.begin() + start[r] + count[r]);
  return all;
}

void MpiCommunicator::exchange(std::span<const Bytes> to, std::span<Bytes> from) {
  std::vector<MPI_Request> requests;
  const auto others = [&](std::size_t r) { return static_cast<int>(r) != rank_; };
  for (std::size_t r = 0; r < from.size(); ++r)
    if (others(r) && !from[r].empty())
      MPI_Irecv(from[r].data(), count_of(from[r].size()), MPI_BYTE, static_cast<int>(r), 0, all_,
                &requests.emplace_back());
  for (std::size_t r = 0; r < to.size(); ++r)
    if (others(r) && !to[r].empty())
      MPI_Isend(to[r].data(), count_of(to[r].size()), MPI_BYTE, static_cast<int>(r), 0, all_,
                &requests.emplace_back());
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

/// MPI waits with a processor at work. A rank may wait for a structure, which takes longer than that is
/// worth.
void MpiCommunicator::await(MPI_Request request) const {
  int there = 0, pause = first_pause;
  MPI_Test(&request, &there, MPI_STATUS_IGNORE);
  while (there == 0) {
    std::this_thread::sleep_for(std::chrono::microseconds(pause));
    pause = std::min(2 * pause, longest_pause);
    MPI_Test(&request, &there, MPI_STATUS_IGNORE);
  }
}

void MpiCommunicator::announce(std::span<const std::byte> bytes) {
  int count = count_of(bytes.size());
  MPI_Request request;
  MPI_Ibcast(&count, 1, MPI_INT, 0, all_, &request);
  await(request);
  MPI_Bcast(const_cast<std::byte*>(bytes.data()), count, MPI_BYTE, 0, all_);  // NOLINT: the root only reads
}

Bytes MpiCommunicator::await_announcement() {
  int count = 0;
  MPI_Request request;
  MPI_Ibcast(&count, 1, MPI_INT, 0, all_, &request);
  await(request);
  Bytes bytes(static_cast<std::size_t>(count));
  MPI_Bcast(bytes.data(), count, MPI_BYTE, 0, all_);
  return bytes;
}

}  // namespace strake
