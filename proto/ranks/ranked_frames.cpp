#include "proto/ranks/ranked_frames.hpp"

#include "proto/error.hpp"
#include "proto/ranks/agreement.hpp"

#include <numeric>
#include <vector>

namespace strake {

RankedFrames::RankedFrames(const std::filesystem::path& run_folder, const std::string& name, int dimension,
                           Communicator& ranks)
    : ranks_(ranks) {
  on_all_ranks(ranks_, [&] { series_.emplace(run_folder, name, dimension); });
}

void RankedFrames::write(const Frame& own) {
  const int number = ranks_.all(series_->next()).front();
  const std::vector<std::int64_t> points = ranks_.all(std::int64_t{own.position.cols()});
  const std::int64_t before = std::reduce(points.begin(), points.begin() + ranks_.rank(), std::int64_t{0});
  FilePart part;
  try {
    on_all_ranks(ranks_, [&] { part = series_->write_part(own, number, ranks_.rank(), before); });
    const std::vector<FilePart> parts = parts_of_all(ranks_, part);
    on_first_rank(ranks_, [&] { series_->join(own.time, parts); });
  } catch (const Error&) {
    if (ranks_.rank() == 0) series_->forget_parts(number);
    throw;
  }
}

void RankedFrames::truncate(double time) {
  on_first_rank(ranks_, [&] { series_->truncate(time); });
}

}  // namespace strake
