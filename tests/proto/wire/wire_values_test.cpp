// Where the numbers of a field lie after a message: in it, or in a copy.

#include "proto/wire/wire.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>
#include <vector>

namespace strake::wire {
namespace wire_values_test {

Advanced with_force(Eigen::Index n) {
  Advanced answer;
  answer.output = {{"force", "N", true, Eigen::MatrixXd::Random(3, n)}};
  return answer;
}

using Bytes = std::vector<std::byte>;

/// The message as a peer receives it, its array `askew` bytes into what keeps it.
Parts received(const Parts& sent, std::size_t askew = 0) {
  auto kept = std::make_shared<Bytes>(sent.at(1).bytes.size() + askew);
  std::memcpy(kept->data() + askew, sent[1].bytes.data(), sent[1].bytes.size());
  return {sent[0], {std::span(*kept).subspan(askew), kept}};
}

Values force_of(const Parts& parts) {
  return std::get<Advanced>(decode_reply(parts, "fluid").what).output.at(0).value;
}

bool lies_in(const Values& values, const Part& part) {
  return static_cast<const void*>(values.data()) == static_cast<const void*>(part.bytes.data());
}

TEST(WireValues, ManyNumbersStayInTheMessageThatBroughtThem) {
  for (const Eigen::Index n : {10, 10000}) {
    const Advanced answer = with_force(n);
    Parts parts = received(encode(Reply{1, answer}, "fluid"));
    const Values force = force_of(parts);
    EXPECT_EQ(lies_in(force, parts[1]), n == 10000);
    parts.clear();  // the numbers live on
    EXPECT_EQ(force, answer.output[0].value);
    EXPECT_TRUE(force.known_finite());
  }
}

TEST(WireValues, NumbersThatNobodyKeepsOrThatStandAskewAreCopied) {
  const Advanced answer = with_force(10000);
  const Parts sent = encode(Reply{1, answer}, "fluid");
  const Parts borrowed = {sent[0], {sent[1].bytes, nullptr}};
  for (const Parts& parts : {borrowed, received(sent, 4)}) {
    const Values force = force_of(parts);
    EXPECT_FALSE(lies_in(force, parts[1]));
    EXPECT_EQ(force, answer.output[0].value);
  }
}

TEST(WireValues, OneOfManyThatIsNotFiniteIsNamed) {
  Parts parts = received(encode(Reply{1, with_force(10000)}, "fluid"));
  const double bad = std::numeric_limits<double>::infinity();
  const auto kept = std::make_shared<Bytes>(parts[1].bytes.begin(), parts[1].bytes.end());
  std::memcpy(kept->data() + (3 * 7654 + 1) * sizeof bad, &bad, sizeof bad);
  parts[1] = {*kept, kept};
  try {
    force_of(parts);
    FAIL() << "taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::solver_fault);
    EXPECT_EQ(e.where(), "fluid");
    EXPECT_EQ(e.problem(), "force is not finite: inf N at point 7654 of 10000, component 1");
  }
}

TEST(WireValues, WhatCameGoesOnWithoutACopy) {
  const Parts parts = received(encode(Reply{1, with_force(10000)}, "fluid"));
  Advance next;
  next.window = {0, 1e-3};
  next.input.samples = {{1e-3, {{"force", "N", true, force_of(parts)}}}};
  const Parts on = encode(Request{1, std::move(next)});
  EXPECT_EQ(on.at(1).bytes.data(), parts[1].bytes.data());
}

}  // namespace wire_values_test
}  // namespace strake::wire
