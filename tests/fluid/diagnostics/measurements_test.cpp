#include "fluid/diagnostics/measurements.hpp"

#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake::fluid {
namespace measurements_test {

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

TEST(Measurements, VoidsThatWereNotComputedAreNoNumberFromThenOn) {
  Measurements measurements;
  measurements.add(Voids{.all = 5, .internal_voids = 2});
  measurements.add(Voids{.all = 3, .internal_voids = 3});
  EXPECT_EQ(measurements.of_record(measurements.voids), 5);
  EXPECT_EQ(measurements.of_record(measurements.internal_voids), 3);
  measurements.add(std::nullopt);
  measurements.add(Voids{.all = 9, .internal_voids = 9});
  Archive archive;
  save(measurements, archive);
  const Measurements read = load_measurements(archive, 0);
  EXPECT_TRUE(read.lacks_voids());
  EXPECT_TRUE(std::isnan(read.of_record(read.voids)));
  EXPECT_TRUE(std::isnan(read.of_record(read.internal_voids)));
}

}  // namespace measurements_test
}  // namespace strake::fluid
