// Which instants a report shows, and what of the water.

#include "coupler/report/sections.hpp"
#include "proto/files/frame_file.hpp"
#include "proto/files/result_file.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <string>

namespace strake::report {
namespace pictures_test {

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

/// A run in `folder` with frames of 40 particles and of a body in one place, at these times [s].
Recorded run_in(const TemporaryFolder& folder, std::initializer_list<double> times) {
  put(folder / "case.toml", "[fluid]\nspacing = 0.1\n");
  Frame water, body;
  water.position = Points::Zero(3, 40);
  for (int i = 0; i < 40; ++i) water.position.col(i) << 0.1 * (i % 8), 0.1 * std::floor(i / 8), 0;
  water.point_data = {{"pressure", "Pa", Eigen::MatrixXd::Ones(1, 40)}};
  body.position = Points::Constant(3, 3, 0.0);
  body.cells.resize(3, 1);
  body.cells << 0, 1, 2;
  FrameSeries of_water(folder.path(), "fluid", 2), of_body(folder.path(), "structure", 2);
  for (const double time : times) {
    water.time = body.time = time;
    of_water.write(water);
    of_body.write(body);
  }
  Recorded run;
  run.folder = folder.path();
  run.name = "one place";
  return run;
}

// A frame that is drawn around its body must not take the size of that body for a scale: this one has none.
TEST(Pictures, ABodyInOnePlaceIsDrawnWithAllOfTheWater) {
  const TemporaryFolder folder;
  EXPECT_EQ(count(pictures({run_in(folder, {0})}, {0}), "<figure>"), 1U);
}

// Of a body that is its own mirror image the force sideways is noise, which has a first peak too.
TEST(Pictures, TheFirstPeakIsThatOfTheLargestForce) {
  const TemporaryFolder folder;
  Recorded run = run_in(folder, {0, 1, 2, 3});
  run.end_time = 3;
  run.probes = {{"force.x", "N/m", {{"first_peak", 3.0}, {"time_of_first_peak", 2.0}}},
                {"force.y", "N/m", {{"first_peak", -7000.0}, {"time_of_first_peak", 1.0}}},
                {"moment.z", "N", {{"first_peak", 9000.0}, {"time_of_first_peak", 2.0}}}};
  EXPECT_NE(pictures({run}, {}).find("first peak, t = 1 s"), std::string::npos) << "of force.y";
  run.probes.insert(run.probes.begin(), {"p", "Pa", {{"first_peak", 5.0}, {"time_of_first_peak", 2.0}}});
  EXPECT_NE(pictures({run}, {}).find("first peak, t = 2 s"), std::string::npos)
      << "of the sensor, which is first";
}

}  // namespace pictures_test
}  // namespace strake::report
