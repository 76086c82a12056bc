#include "proto/files/vector_participant.hpp"

#include "proto/error.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace vector_participant_test {

/// Adds dt to its state, and says what it came to.
VectorParticipant counter(Eigen::Index size = 2) {
  InterfaceMesh mesh;
  mesh.name = "counter";
  return VectorParticipant(
      mesh, {}, Eigen::VectorXd::Zero(size),
      [](const Window& window, const Input&, const Eigen::VectorXd& committed, Eigen::VectorXd& trial) {
        trial = committed.array() + window.dt;
        Advanced advanced;
        advanced.monitor["sum"] = trial.sum();
        return advanced;
      });
}
double sum_after(VectorParticipant& participant, double dt) {
  return participant.advance({0, dt}, {}).monitor.at("sum");
}

TEST(VectorParticipant, StartsEveryIterationFromTheLastCommit) {
  VectorParticipant p = counter();
  EXPECT_EQ(sum_after(p, 1), 2);
  p.rewind();
  EXPECT_EQ(sum_after(p, 3), 6);
  p.commit(false);
  EXPECT_EQ(sum_after(p, 1), 8);
}

TEST(VectorParticipant, WritesTheCommittedStateAndTakesItUpAgain) {
  const TemporaryFolder folder;
  VectorParticipant p = counter();
  sum_after(p, 0.1);
  p.commit(false);
  p.checkpoint(folder.path());
  VectorParticipant q = counter();
  q.resume(folder.path());
  EXPECT_EQ(sum_after(q, 0.7), sum_after(p, 0.7));
}

TEST(VectorParticipant, RefusesACheckpointOfAnotherSize) {
  const TemporaryFolder folder;
  counter(2).checkpoint(folder.path());
  VectorParticipant other = counter(3);
  EXPECT_THROW(other.resume(folder.path()), Error);
}

}  // namespace vector_participant_test
}  // namespace strake
