#include "proto/ranks/ranked_frames.hpp"

#include "proto/error.hpp"
#include "proto/files/blocked_signals.hpp"
#include "proto/ranks/agreement.hpp"

#include <chrono>
#include <numeric>
#include <utility>
#include <vector>

namespace strake {

RankedFrames::RankedFrames(const std::filesystem::path& run_folder, const std::string& name, int dimension,
                           Communicator& ranks)
    : ranks_(ranks) {
  on_all_ranks(ranks_, [&] { series_.emplace(run_folder, name, dimension); });
}

void RankedFrames::write(Frame own) {
  flush();
  const int number = ranks_.all(series_->next()).front(), rank = ranks_.rank();
  const std::vector<std::int64_t> points = ranks_.all(std::int64_t{own.position.cols()});
  const std::int64_t before = std::reduce(points.begin(), points.begin() + rank, std::int64_t{0});
  const double time = own.time;
  try {
    on_all_ranks(ranks_, [&] {  // the system may have no more threads
      const BlockedSignals blocked;
      pending_ = Pending{
          number, time,
          std::async(std::launch::async, [&series = *series_, frame = std::move(own), number, rank, before] {
            return series.write_part(frame, number, rank, before);
          })};
    });
  } catch (const Error&) {
    pending_.reset();  // waits for the own thread
    throw;
  }
}

void RankedFrames::look() {
  if (!pending_) return;  // on all ranks
  const bool waits = pending_->part.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  if (!ranks_.any(waits)) flush();
}

void RankedFrames::flush() {
  if (!pending_) return;
  Pending pending = std::move(*pending_);
  pending_.reset();
  FilePart part;
  try {
    on_all_ranks(ranks_, [&] { part = pending.part.get(); });
    const std::vector<FilePart> parts = parts_of_all(ranks_, part);
    on_first_rank(ranks_, [&] { series_->join(pending.time, parts); });
  } catch (const Error&) {
    if (ranks_.rank() == 0) series_->forget_parts(pending.number);
    throw;
  }
}

void RankedFrames::truncate(double time) {
  flush();
  on_first_rank(ranks_, [&] { series_->truncate(time); });
}

}  // namespace strake
