#include "proto/ranks/mpi_communicator.hpp"

#include <chrono>
#include <limits>
#include <thread>

namespace strake {

namespace {

/// Longest message [bytes]. MPI counts in int.
constexpr std::size_t longest = std::numeric_limits<int>::max();
/// Pause between two looks for an announcement, which grows up to the second [µs].
constexpr int first_pause = 20, longest_pause = 1000;
/// How long a rank that has failed waits for the others. On all ranks the same error comes within moments.
constexpr std::chrono::seconds patience{2};

int count_of(std::size_t bytes) {
  if (bytes > longest)
    throw std::length_error("a message between ranks is longer than 2 GiB: use more ranks");
  return static_cast<int>(bytes);
}

}  // namespace

// An error of MPI ends all ranks: MPI's default, or the handler of `all`. The end of MPI frees the
// communicator of ends.
MpiCommunicator::MpiCommunicator(MPI_Comm all) : all_(all) {
  MPI_Comm_rank(all, &rank_);
  MPI_Comm_size(all, &size_);
  MPI_Comm_dup(all, &ends_);
  all_ends_.resize(static_cast<std::size_t>(size_));
}

namespace {

/// Places of messages of these lengths, one behind the other; the last is their sum.
std::vector<int> starts_of(const std::vector<int>& count) {
  std::vector<int> start;
  std::size_t total = 0;
  for (const int one : count) {
    start.push_back(count_of(total));
    total += static_cast<std::size_t>(one);
  }
  start.push_back(count_of(total));
  return start;
}

std::vector<Bytes> parts_of(const Bytes& bytes, const std::vector<int>& start) {
  std::vector<Bytes> all(start.size() - 1);
  for (std::size_t r = 0; r < all.size(); ++r)
    all[r].assign(bytes.begin() + start[r], bytes.begin() + start[r + 1]);
  return all;
}

}  // namespace

std::vector<Bytes> MpiCommunicator::gather_all(std::span<const std::byte> own) {
  std::vector<int> count(static_cast<std::size_t>(size_));
  const int mine = count_of(own.size());
  MPI_Allgather(&mine, 1, MPI_INT, count.data(), 1, MPI_INT, all_);
  const std::vector<int> start = starts_of(count);
  Bytes bytes(static_cast<std::size_t>(start.back()));
  MPI_Allgatherv(own.data(), mine, MPI_BYTE, bytes.data(), count.data(), start.data(), MPI_BYTE, all_);
  return parts_of(bytes, start);
}

// Together the ranks may send more than 2 GiB.
void MpiCommunicator::pass_to_first(std::span<const std::byte> own,
                                    const std::function<void(std::span<const std::byte>)>& visit) {
  std::vector<std::int64_t> count(static_cast<std::size_t>(size_));
  const auto mine = static_cast<std::int64_t>(own.size());
  MPI_Gather(&mine, 1, MPI_INT64_T, count.data(), 1, MPI_INT64_T, 0, all_);
  if (rank_ > 0) {
    if (!own.empty()) MPI_Send(own.data(), count_of(own.size()), MPI_BYTE, 0, 1, all_);
    return;
  }
  visit(own);
  Bytes bytes;
  for (std::size_t r = 1; r < count.size(); ++r) {
    bytes.resize(static_cast<std::size_t>(count[r]));
    if (!bytes.empty())
      MPI_Recv(bytes.data(), count_of(bytes.size()), MPI_BYTE, static_cast<int>(r), 1, all_,
               MPI_STATUS_IGNORE);
    visit(bytes);
  }
}

Bytes MpiCommunicator::gather_equal(std::span<const std::byte> own) {
  Bytes bytes(own.size() * static_cast<std::size_t>(size_));
  const int each = count_of(own.size());
  MPI_Allgather(own.data(), each, MPI_BYTE, bytes.data(), each, MPI_BYTE, all_);
  return bytes;
}

std::vector<std::int64_t> MpiCommunicator::pass_lengths(std::span<const std::int64_t> to) {
  std::vector<std::int64_t> from(to.size());
  MPI_Alltoall(to.data(), 1, MPI_INT64_T, from.data(), 1, MPI_INT64_T, all_);
  return from;
}

void MpiCommunicator::pass(std::span<const Bytes> to, std::span<Bytes> from) {
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

std::optional<std::vector<bool>> MpiCommunicator::end_call(bool failed) {
  own_end_ = failed ? 1 : 0;
  MPI_Request request;
  MPI_Iallgather(&own_end_, 1, MPI_UINT8_T, all_ends_.data(), 1, MPI_UINT8_T, ends_, &request);
  if (failed) {
    const auto end = std::chrono::steady_clock::now() + patience;
    int there = 0;
    for (MPI_Test(&request, &there, MPI_STATUS_IGNORE); there == 0;) {
      if (std::chrono::steady_clock::now() > end) {
        broken_ = true;
        return {};
      }
      std::this_thread::sleep_for(std::chrono::microseconds(longest_pause));
      MPI_Test(&request, &there, MPI_STATUS_IGNORE);
    }
  } else {
    MPI_Wait(&request, MPI_STATUS_IGNORE);
  }
  return std::vector<bool>(all_ends_.begin(), all_ends_.end());
}

}  // namespace strake
