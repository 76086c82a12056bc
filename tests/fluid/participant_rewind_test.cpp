// A participant goes back: to the last commit, to a checkpoint, on another number of threads.

#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "tests/fluid/participant_case.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

namespace strake::fluid {
namespace participant_rewind_test {

void rewind_then_advance_again(const Case& c) {
  FluidParticipant<2> straight(c.parameters, c.common, entering()),
      iterated(c.parameters, c.common, entering());
  for (int k = 0; k < contact_window + 20; ++k) {
    const auto expected = straight.advance(nth(k), at_speed(nth(k)));
    straight.commit(false);
    iterated.advance(nth(k), at_speed(nth(k), speed + 0.3));
    iterated.rewind();
    if (k % 3 == 0) {
      iterated.advance(nth(k), at_speed(nth(k), speed - 0.5));
      iterated.rewind();
    }
    expect_equal_bits(iterated.advance(nth(k), at_speed(nth(k))), expected, k);
    iterated.commit(false);
  }
}

TEST(FluidParticipant, rewind_then_advance_again_is_bit_equal) {
  rewind_then_advance_again(Case());
}

TEST(FluidParticipant, rewind_is_bit_equal_where_the_steps_of_a_window_share_their_places) {
  rewind_then_advance_again(Case(five_steps));
}

TEST(FluidParticipant, the_result_does_not_depend_on_the_number_of_threads) {
  const Case one({"run.threads=1"}), two({"run.threads=2"});
  std::vector<Advanced> with_one;
  {
    FluidParticipant<2> participant(one.parameters, one.common, entering());
    for (int k = 0; k < contact_window + 10; ++k) {
      with_one.push_back(participant.advance(nth(k), at_speed(nth(k))));
      participant.commit(false);
    }
  }
  FluidParticipant<2> participant(two.parameters, two.common, entering());
  for (int k = 0; k < contact_window + 10; ++k) {
    expect_equal_bits(participant.advance(nth(k), at_speed(nth(k))), with_one[static_cast<std::size_t>(k)],
                      k);
    participant.commit(false);
  }
}

void resume_from_checkpoint(
    const Case& c, const std::function<void(const std::filesystem::path&)>& edit = [](const auto&) {}) {
  const TemporaryFolder folder;
  FluidParticipant<2> first(c.parameters, c.common, entering()), second(c.parameters, c.common, entering());
  for (int k = 0; k < contact_window + 5; ++k) {
    first.advance(nth(k), at_speed(nth(k)));
    first.commit(false);
  }
  first.checkpoint(folder.path());
  edit(folder / "fluid.h5");
  second.resume(folder.path());
  for (int k = contact_window + 5; k < contact_window + 15; ++k) {
    const auto expected = first.advance(nth(k), at_speed(nth(k)));
    first.commit(false);
    expect_equal_bits(second.advance(nth(k), at_speed(nth(k))), expected, k);
    second.commit(false);
  }
}

TEST(FluidParticipant, a_checkpoint_continues_bit_equal_where_the_steps_of_a_window_share_their_places) {
  resume_from_checkpoint(Case(five_steps));
}

TEST(FluidParticipant, a_checkpoint_continues_bit_equal) {
  resume_from_checkpoint(Case());
}

/// Puts the values of a checkpoint where version 0.1.0 had them, the first `counts` of its counts.
void as_version_0_1_0(const std::filesystem::path& file, std::size_t counts = 6) {
  Archive archive = read_archive(file);
  Eigen::Vector4d scalars;
  Eigen::Index k = 0;
  for (const char* name : {"time", "contact_time", "inner_fraction_min", "residual_step"}) {
    scalars[k++] = archive.real.at(name).value();
    archive.real.erase(name);
  }
  auto& old = archive.integer["counts"];
  for (const char* name : {"step", "lost", "voids", "penetrations", "behind_walls", "openings"}) {
    if (old.size() < counts) old.push_back(archive.integer.at(name).at(0));
    archive.integer.erase(name);
  }
  archive.real["scalars"] = scalars;
  write_archive(file, archive);
}

TEST(FluidParticipant, a_checkpoint_of_version_0_1_0_continues_bit_equal) {
  resume_from_checkpoint(Case(), [](const std::filesystem::path& file) { as_version_0_1_0(file); });
}

TEST(FluidParticipant, a_checkpoint_of_an_earlier_version_is_refused_by_name) {
  try {
    resume_from_checkpoint(Case(), [](const std::filesystem::path& file) { as_version_0_1_0(file, 5); });
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::case_file);
    EXPECT_NE(e.problem().find("before 0.1.0"), std::string::npos) << e.problem();
    EXPECT_FALSE(e.fix().empty());
  }
}

TEST(FluidParticipant, a_checkpoint_holds_each_value_under_its_own_name) {
  const Case c;
  const TemporaryFolder folder;
  FluidParticipant<2> participant(c.parameters, c.common, entering());
  participant.advance(nth(0), at_speed(nth(0)));
  participant.commit(false);
  participant.checkpoint(folder.path());
  const Archive archive = read_archive(folder / "fluid.h5");
  EXPECT_EQ(archive.real.at("time").value(), window);
  EXPECT_EQ(archive.real.at("contact_time").value(), -1);
  EXPECT_EQ(archive.integer.at("step"), std::vector<std::int64_t>{2});
  EXPECT_EQ(archive.integer.at("openings"), std::vector<std::int64_t>{0});
  EXPECT_FALSE(archive.real.contains("scalars") || archive.integer.contains("counts"));
}

TEST(FluidParticipant, a_checkpoint_of_another_case_is_refused) {
  const Case c;
  const TemporaryFolder folder;
  FluidParticipant<2> first(c.parameters, c.common, entering());
  first.checkpoint(folder.path());
  const Case other({"fluid.water=[[-0.15,-0.1],[0.15,-0.02]]"});
  FluidParticipant<2> third(other.parameters, other.common, entering());
  EXPECT_THROW(third.resume(folder.path()), Error);
  EXPECT_THROW(third.resume(folder / "nothing"), Error);
}

}  // namespace participant_rewind_test
}  // namespace strake::fluid
