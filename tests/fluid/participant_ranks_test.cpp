#include "fluid/case/read_parameters.hpp"
#include "fluid/participant.hpp"
#include "proto/case/case_file.hpp"
#include "proto/error.hpp"
#include "proto/files/frame_file.hpp"
#include "proto/files/result_file.hpp"
#include "tests/fluid/ranks/thread_communicator.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>

// Files of water on several ranks that are threads. The first rank solves the pressure, so that the state is
// that of one rank to the last bit.

namespace strake::fluid {
namespace participant_ranks_test {

constexpr double window = 4e-3;  // [s]

struct Case {
  CommonKeys common;
  Parameters parameters;
  explicit Case(double width = 0.8) {
    const std::string side = std::to_string(0.5 * width);
    std::string text = "end_time = 0.064\n[fluid]\nspacing = 0.01\ntank = [[-" + side + ", -0.2], [" + side +
                       ", 0.2]]\nwater = [[-" + side +
                       ", -0.2], [-0.1, 0.0]]\n[fluid.scheme]\ntime_step = 5e-4\n"
                       "[coupling.surface]\nwindow = 4e-3\n[output]\nevery = 0.012\n";
    for (const char* quantity : {"front", "level", "height"})
      text += std::string("[[output.probe]]\nname = \"") + quantity +
              "\"\nof = \"fluid\"\nat = [-0.11, -0.2]\nquantity = \"" + quantity + "\"\n";
    CaseFile file = CaseFile::parse(text, "case.toml", {"run.threads=1"});
    common = read_common(file);
    parameters = read(file, common);
  }
};

/// Calls `use` on each of so many ranks with its participant; one rank is no rank.
void on_ranks(int count, const Case& c, const std::filesystem::path& folder,
              const std::function<void(FluidParticipant<2>&, int rank)>& use) {
  strake::Setup setup;
  setup.run_folder = folder;
  if (count == 1) {
    FluidParticipant<2> participant(c.parameters, c.common, setup);
    use(participant, 0);
    participant.flush();
    return;
  }
  ThreadRanks(count).run([&](Communicator& communicator) {
    FluidParticipant<2> participant(c.parameters, c.common, setup, Ranks{&communicator, cut_in_halves, {}});
    use(participant, communicator.rank());
    participant.flush();
  });
}

void advance(FluidParticipant<2>& participant, int from, int to) {
  for (int k = from; k < to; ++k) {
    participant.advance({k * window, window}, {});
    participant.commit(k % 4 == 3);
  }
}

constexpr int half = 9, end = 16;  // windows

/// Computes the first half and writes a checkpoint; then resumes it on so many ranks, and writes another.
Archive resumed(int begun, int on, const TemporaryFolder& folder) {
  const Case c;
  const auto run = folder / std::to_string(begun), first = run / "first", last = run / std::to_string(on);
  for (const auto& place : {first, last}) std::filesystem::create_directories(place);
  on_ranks(begun, c, run, [&](auto& participant, int) {
    advance(participant, 0, half);
    participant.checkpoint(first);
  });
  on_ranks(on, c, run, [&](auto& participant, int) {
    participant.resume(first);
    advance(participant, half, end);
    participant.checkpoint(last);
  });
  return read_archive(last / "fluid.h5");
}

void expect_same(Archive archive, Archive expected, const std::string& what) {
  for (Archive* one : {&archive, &expected}) {
    one->real.erase("rank_boxes");
    one->integer.erase("rank_buckets");
    one->integer.erase("participant.steps");
  }
  EXPECT_GT(archive.real.at("velocity").norm(), 0);
  EXPECT_EQ(archive.real.size(), expected.real.size());
  const auto& impulse = expected.real.at("impulse_on_walls");  // ranks add it up one by one
  EXPECT_LE((archive.real.at("impulse_on_walls") - impulse).norm(), 1e-12 * impulse.norm()) << what;
  archive.real.at("impulse_on_walls") = impulse;
  for (const auto& [name, value] : expected.real)
    EXPECT_TRUE(archive.real.at(name) == value) << what << ": " << name;
  EXPECT_EQ(archive.integer, expected.integer) << what;
}

TEST(FluidOnRanks, a_run_resumed_on_any_number_of_ranks_has_the_bits_of_one) {
  const TemporaryFolder folder;
  const Archive expected = resumed(1, 1, folder);
  for (const auto& [begun, on] : {std::pair{1, 2}, {2, 1}, {2, 2}, {2, 3}, {4, 2}}) {
    const TemporaryFolder own;
    expect_same(resumed(begun, on, own), expected, std::to_string(begun) + " to " + std::to_string(on));
  }
}

TEST(FluidOnRanks, the_checkpoint_of_ranks_reads_as_that_of_one) {
  const Case c;
  const TemporaryFolder one, three;
  for (const auto& [count, folder] : {std::pair{1, &one}, {3, &three}})
    on_ranks(count, c, folder->path(), [&, place = folder->path()](auto& participant, int) {
      advance(participant, 0, half);
      participant.checkpoint(place);
    });
  const Archive joined = read_archive(three / "fluid.h5");
  expect_same(joined, read_archive(one / "fluid.h5"), "three ranks");
  EXPECT_EQ(std::ssize(joined.integer.at("rank_buckets")), joined.real.at("position").cols());
  EXPECT_LT(std::filesystem::file_size(three / "fluid.0001.h5"),
            0.4 * static_cast<double>(std::filesystem::file_size(one / "fluid.h5")));
}

TEST(FluidOnRanks, volume_voids_and_gauges_are_those_of_one_rank) {
  const Case c;
  const TemporaryFolder folder;
  const auto measured = [&](int count) {
    std::vector<std::map<std::string, double>> windows;
    on_ranks(count, c, folder.path(), [&](auto& participant, int rank) {
      for (int k = 0; k < end; ++k) {
        auto monitor = participant.advance({k * window, window}, {}).monitor;
        participant.commit(false);
        std::erase_if(monitor, [](const auto& item) {
          const std::string& name = item.first;
          return name != "water.volume" && name != "check.volume_drift" && name != "front" &&
                 name != "level" && name != "height" && !name.ends_with("voids") &&
                 !name.ends_with("openings");
        });
        if (rank == 0) windows.push_back(monitor);
      }
    });
    return windows;
  };
  const auto one = measured(1);
  EXPECT_GT(one.back().at("front"), -0.1);
  EXPECT_GT(one.back().at("height"), 0);
  EXPECT_TRUE(one.back().contains("water.volume"));
  for (const int count : {2, 3}) EXPECT_EQ(measured(count), one) << count;
}

std::vector<std::size_t> by_id(const Frame& frame) {
  const Eigen::MatrixXd& id = find(frame.point_data, "id")->value;
  std::vector<std::size_t> order(static_cast<std::size_t>(id.cols()));
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return id(0, static_cast<Eigen::Index>(k)); });
  return order;
}

TEST(FluidOnRanks, frames_hold_the_particles_of_one_rank) {
  const Case c;
  const TemporaryFolder one, three;
  for (const auto& [count, folder] : {std::pair{1, &one}, {3, &three}})
    on_ranks(count, c, folder->path(), [&](auto& participant, int) { advance(participant, 0, half); });
  const auto frames = list_frames(three.path(), "fluid"), expected = list_frames(one.path(), "fluid");
  ASSERT_EQ(frames.size(), 3U);
  ASSERT_EQ(expected.size(), 3U);
  EXPECT_EQ(content(three / "fluid.xdmf"), content(one / "fluid.xdmf"));
  for (std::size_t k = 0; k < 3; ++k) {
    const Frame frame = read_frame(frames[k].path), whole = read_frame(expected[k].path);
    const auto order = by_id(frame), whole_order = by_id(whole);
    ASSERT_EQ(order.size(), whole_order.size());
    EXPECT_TRUE(frame.position(Eigen::all, order) == whole.position(Eigen::all, whole_order));
    for (std::size_t a = 0; a < whole.point_data.size(); ++a)
      EXPECT_TRUE(frame.point_data[a].value(Eigen::all, order) ==
                  whole.point_data[a].value(Eigen::all, whole_order))
          << whole.point_data[a].name;
  }
}

TEST(FluidOnRanks, a_checkpoint_that_cannot_be_read_or_written_is_an_error_on_all_ranks) {
  const Case c;
  const TemporaryFolder folder;
  on_ranks(2, c, folder.path(), [&](auto& participant, int) {
    advance(participant, 0, 1);
    participant.checkpoint(folder.path());
  });
  std::atomic<int> told = 0;
  const auto refused = [&](const Case& with, const std::string& words, bool writes, ExitCode code) {
    told = 0;
    on_ranks(2, with, folder.path(), [&](auto& participant, int) {
      try {
        writes ? participant.checkpoint(folder / "none") : participant.resume(folder.path());
      } catch (const Error& error) {
        EXPECT_NE(to_text(error).find(words), std::string::npos) << to_text(error);
        EXPECT_EQ(error.code(), code);
        ++told;
      }
    });
    EXPECT_EQ(told, 2) << words;
  };
  refused(c, "fluid.0000.h5: cannot be written", true, ExitCode::cannot_write);
  refused(Case(0.9), "particles, the case makes", false, ExitCode::case_file);
  std::filesystem::remove(folder / "fluid.0001.h5");
  refused(c, "fluid.0001.h5 is missing", false, ExitCode::case_file);
}

}  // namespace participant_ranks_test
}  // namespace strake::fluid
