#include "fluid/diagnostics/measurements.hpp"

#include "proto/error.hpp"

#include <gtest/gtest.h>

namespace strake::fluid {
namespace {

TEST(Measurements, AreReadBackFromAnArchive) {
  Measurements written;
  written.probes.resize(2);
  written.probes[1].add(0, 0.1, -7);
  written.contact_time = 0.25;
  written.voids = 3;
  written.guard.alarm(0, 1) = 0.125;
  written.internal_voids = 2;
  Archive archive;
  save(written, archive);
  const Measurements read = load_measurements(archive, 2);
  EXPECT_EQ(read.contact_time, 0.25);
  EXPECT_EQ(read.voids, 3);
  EXPECT_TRUE(read.guard.raised(Alarm::pressure)) << "a resumed run keeps its alarms";
  EXPECT_EQ(read.internal_voids, 2);
  EXPECT_EQ(read.probes.at(0).last(), 0);
  EXPECT_EQ(read.probes.at(1).last(), -7);
  EXPECT_THROW(load_measurements(archive, 3), Error);
  archive.integer.erase("openings");
  EXPECT_THROW(load_measurements(archive, 2), Error);
}

}  // namespace
}  // namespace strake::fluid
