#include "coupler/participant/interface_record.hpp"

#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace strake {
namespace interface_record_test {

InterfaceMesh strip() {
  InterfaceMesh mesh = {"structure", 2, Points::Zero(3, 3), Eigen::MatrixXi(2, 2), {}};
  mesh.position.row(0) << 0, 1, 2;
  mesh.faces << 0, 1, 1, 2;
  return mesh;
}

// Constant acceleration, another on each point: u = v0 t + a t²/2.
Points displacement(double t) {
  Points u = Points::Zero(3, 3);
  u.row(1) << -6 * t, -6 * t + 5 * t * t, 50 * t * t;
  return u;
}
Points velocity(double t) {
  Points v = Points::Zero(3, 3);
  v.row(1) << -6, -6 + 10 * t, 100 * t;
  return v;
}
Points force(int window) {
  return Points::Constant(3, 3, window + 1.0);
}

const std::vector<Field> initial = {{"displacement", "m", false, displacement(0)},
                                    {"velocity", "m/s", false, velocity(0)}};

/// n windows of 0.01 s and 0.02 s in turn.
std::vector<Window> windows(int n) {
  std::vector<Window> all;
  double t = 0;
  for (int w = 0; w < n; ++w) {
    all.push_back({t, w % 2 == 0 ? 0.01 : 0.02});
    t = all.back().t + all.back().dt;
  }
  return all;
}

void record(InterfaceRecorder& recorder, int from, int to, bool with_velocity = true) {
  const auto all = windows(to);
  for (int w = from; w < to; ++w) {
    const Window& window = all[static_cast<std::size_t>(w)];
    const double end = window.t + window.dt;
    recorder.append(window, displacement(end), with_velocity ? velocity(end) : Points(), force(w));
  }
}

// A replay that runs out of record after an hour has lost the hour.
TEST(InterfaceRecord, OneThatEndsBeforeTheRunIsRefusedAtTheStart) {
  InterfaceRecord record;
  record.windows = windows(2);
  EXPECT_NO_THROW(require_end(record, 0.03, "runs/a"));
  try {
    require_end(record, 0.05, "runs/a");
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::case_file);
    EXPECT_NE(to_text(error).find("the record ends at 0.03 s, before end_time = 0.05 s"), std::string::npos);
    EXPECT_EQ(error.fix(), "end_time = 0.03");
  }
}

TEST(InterfaceRecord, IsReadBackAsItWasWritten) {
  TemporaryFolder folder;
  InterfaceRecorder recorder(folder.path(), strip(), initial, 4);
  record(recorder, 0, 10);
  recorder.flush();
  EXPECT_TRUE(std::filesystem::exists(folder / "interface/000003.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder / "interface/000004.h5"));
  const InterfaceRecord read = read_interface_record(folder.path());
  ASSERT_EQ(read.windows.size(), 10u);
  EXPECT_EQ(read.mesh.position, strip().position);
  EXPECT_EQ(read.mesh.faces, strip().faces);
  EXPECT_EQ(read.mesh.dimension, 2);
  EXPECT_EQ(read.initial_velocity, velocity(0));
  for (int w = 0; w < 10; ++w) {
    const auto k = static_cast<std::size_t>(w);
    const double end = windows(10)[k].t + windows(10)[k].dt;
    EXPECT_EQ(read.windows[k].t, windows(10)[k].t);
    EXPECT_EQ(read.displacement[k], displacement(end));
    EXPECT_EQ(read.velocity[k], velocity(end));
    EXPECT_EQ(read.force[k], force(w));
    EXPECT_EQ(read.displacement_at(end), displacement(end));
    EXPECT_EQ(read.mean_force(read.windows[k].t, read.windows[k].dt), force(w));
  }
}

TEST(InterfaceRecord, IsWholeAfterEachFlushAndGoesOn) {
  TemporaryFolder folder;
  InterfaceRecorder recorder(folder.path(), strip(), initial, 4);
  record(recorder, 0, 5);
  recorder.flush();
  EXPECT_EQ(read_interface_record(folder.path()).windows.size(), 5u);
  record(recorder, 5, 7);
  recorder.flush();
  EXPECT_EQ(read_interface_record(folder.path()).windows.size(), 7u);
}

TEST(InterfaceRecord, DropsWhatLiesAfterACheckpointAndGoesOnFromThere) {
  for (const int kept : {3, 4, 6, 8}) {
    TemporaryFolder folder, other;
    InterfaceRecorder whole(other.path(), strip(), initial, 4), broken(folder.path(), strip(), initial, 4);
    record(whole, 0, 13);
    whole.flush();
    record(broken, 0, 11);
    broken.flush();
    InterfaceRecorder resumed(folder.path(), strip(), initial, 4);
    const Window last = windows(kept).back();
    resumed.resume(last.t + last.dt);
    EXPECT_EQ(read_interface_record(folder.path()).windows.size(), static_cast<std::size_t>(kept));
    record(resumed, kept, 13);
    resumed.flush();
    for (const char* file :
         {"interface/000001.h5", "interface/000002.h5", "interface/000003.h5", "interface/000004.h5"})
      EXPECT_EQ(content(folder / file), content(other / file)) << file << " after " << kept;
  }
}

TEST(InterfaceRecord, FollowsConstantAccelerationBetweenWindowEnds) {
  for (const bool with_velocity : {true, false}) {
    TemporaryFolder folder;
    InterfaceRecorder recorder(folder.path(), strip(), initial, 100);
    record(recorder, 0, 10, with_velocity);
    recorder.flush();
    const InterfaceRecord read = read_interface_record(folder.path());
    for (const double t : {0.0, 0.003, 0.01, 0.017, 0.1, 0.149}) {
      EXPECT_LE((read.displacement_at(t) - displacement(t)).cwiseAbs().maxCoeff(), 1e-14);
      EXPECT_LE((read.velocity_at(t) - velocity(t)).cwiseAbs().maxCoeff(),
                1e-11);  // divided by windows of 0.01 s
    }
    EXPECT_EQ(read.displacement_at(9), displacement(0.15)) << "held after the end";
  }
}

TEST(InterfaceRecord, KeepsTheImpulseOverWindowsOfAnotherLength) {
  TemporaryFolder folder;
  InterfaceRecorder recorder(folder.path(), strip(), initial, 100);
  record(recorder, 0, 10);
  recorder.flush();
  const InterfaceRecord read = read_interface_record(folder.path());
  double recorded = 0, replayed = 0;
  for (std::size_t w = 0; w < 10; ++w) recorded += read.force[w](1, 0) * read.windows[w].dt;
  constexpr int n = 37;
  for (int k = 0; k < n; ++k) {
    const double dt = read.end() / n;
    replayed += read.mean_force(k * dt, dt)(1, 0) * dt;
  }
  EXPECT_NEAR(replayed, recorded, 1e-13 * recorded);
  EXPECT_EQ(read.mean_force(1, 0.1), Points::Zero(3, 3));
}

Field scalar(const std::string& quantity, const std::string& unit, double value) {
  return {quantity, unit, false, Eigen::MatrixXd::Constant(1, 3, value)};
}

TEST(InterfaceRecord, HoldsEveryOtherFieldByItsNameAndUnit) {
  TemporaryFolder folder;
  const auto write = [&](InterfaceRecorder& recorder, int from, int to) {
    for (int w = from; w < to; ++w) {
      const Window window = windows(to)[static_cast<std::size_t>(w)];
      recorder.append(window, displacement(window.t + window.dt), Points(), force(w),
                      {scalar("temperature", "K", w)}, {scalar("temperature", "K", 2 * w)},
                      {{"force", "N", true, Eigen::MatrixXd::Constant(3, 3, -w)}});
    }
  };
  InterfaceRecorder recorder(folder.path(), strip(), initial, 4);
  write(recorder, 0, 7);
  recorder.flush();
  InterfaceRecorder resumed(folder.path(), strip(), initial, 4);
  const Window last = windows(5).back();
  resumed.resume(last.t + last.dt);
  write(resumed, 5, 6);
  resumed.flush();
  const InterfaceRecord read = read_interface_record(folder.path());
  EXPECT_EQ(read.displacement.size(), 6u);
  ASSERT_EQ(read.other.size(), 3u);
  const auto& of_attachments = read.other.at("attachments.force").value;
  ASSERT_EQ(of_attachments.size(), 6u) << "those before the resume and after it";
  EXPECT_EQ(of_attachments[4], Eigen::MatrixXd::Constant(3, 3, -4));
  const auto& [unit, values] = read.other.at("fluid.temperature");
  EXPECT_EQ(unit, "K");
  ASSERT_EQ(values.size(), 6u);
  EXPECT_EQ(values[5], Eigen::MatrixXd::Constant(1, 3, 10));
  EXPECT_EQ(read.other.at("structure.temperature").value[3], Eigen::MatrixXd::Constant(1, 3, 3));
  EXPECT_EQ(read_archive_units(folder / "interface/000001.h5").at("force"), "N");
}

TEST(InterfaceRecord, OfOneBodyHasItsPartOfEveryField) {
  InterfaceRecord whole;
  whole.mesh.position = Points::Random(3, 5);
  whole.mesh.faces = Eigen::MatrixXi(2, 3);
  whole.mesh.faces << 0, 2, 3, 1, 3, 4;
  whole.mesh.parts = {{"left", 0, 0}, {"right", 2, 1}};
  whole.windows = {{0, 0.1}};
  whole.displacement = whole.velocity = whole.force = {Points::Random(3, 5)};
  whole.other["attachments.force"] = {"N", {Eigen::MatrixXd::Random(3, 5)}};
  whole.other["structure.temperature"] = {"K", {Eigen::MatrixXd::Random(1, 5)}};
  const InterfaceRecord right = whole.of_body("right", "runs/two");
  ASSERT_EQ(right.other.size(), 2u);
  EXPECT_EQ(right.other.at("attachments.force").unit, "N");
  EXPECT_EQ(right.other.at("attachments.force").value.at(0),
            whole.other.at("attachments.force").value[0].rightCols(3));
  EXPECT_EQ(right.other.at("structure.temperature").value.at(0),
            whole.other.at("structure.temperature").value[0].rightCols(3));
}

TEST(InterfaceRecord, OfFieldsWithoutMotionIsWrittenAndGoesOnButIsNotPlayed) {
  TemporaryFolder folder;
  const auto write = [](InterfaceRecorder& recorder, int from, int to) {
    for (int w = from; w < to; ++w)
      recorder.append(windows(to)[static_cast<std::size_t>(w)], {}, {}, {}, {scalar("area", "m^2", w)},
                      {scalar("pressure", "Pa", 100 * w)});
  };
  InterfaceRecorder recorder(folder.path(), strip(), {scalar("area", "m^2", 0)}, 4);
  write(recorder, 0, 7);
  recorder.flush();
  const std::string whole = content(folder / "interface/000002.h5");
  InterfaceRecorder resumed(folder.path(), strip(), {scalar("area", "m^2", 0)}, 4);
  const Window last = windows(5).back();
  resumed.resume(last.t + last.dt);
  write(resumed, 5, 7);
  resumed.flush();
  EXPECT_EQ(content(folder / "interface/000002.h5"), whole);
  const Archive second = read_archive(folder / "interface/000002.h5");
  EXPECT_EQ(second.real.at("fluid.pressure"),
            Eigen::RowVector3d(400, 500, 600).replicate(3, 1));  // a column per window, a row per point
  EXPECT_FALSE(second.real.contains("initial_displacement"));
  EXPECT_EQ(read_archive_units(folder / "interface/000002.h5").at("structure.area"), "m^2");
  try {
    read_interface_record(folder.path());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.problem(),
              "holds no motion and force, which is what can be played, but fluid.pressure, structure.area");
  }
}

TEST(InterfaceRecord, OfAnEarlierVersionWithoutUnitsIsRead) {
  TemporaryFolder folder;
  InterfaceRecorder recorder(folder.path(), strip(), initial, 100);
  record(recorder, 0, 3);
  recorder.flush();
  const auto file = folder / "interface/000001.h5";
  write_archive(file, read_archive(file));
  ASSERT_TRUE(read_archive_units(file).empty());
  EXPECT_EQ(read_interface_record(folder.path()).force[2], force(2));
}

// A size that a damaged file claims must not become memory, nor a part of the mesh that is not there be read.
TEST(InterfaceRecord, RefusesWhatItsFileDoesNotHold) {
  TemporaryFolder folder;
  const auto says = [&](const std::string& problem, const std::function<void(Archive&)>& damage) {
    InterfaceRecorder recorder(folder.path(), strip(), initial, 100);
    record(recorder, 0, 3);
    recorder.flush();
    const std::filesystem::path file = folder / "interface/000001.h5";
    Archive archive = read_archive(file);
    damage(archive);
    write_archive(file, archive);
    const std::string text =
        text_of_error([&] { read_interface_record(folder.path()); }, ExitCode::case_file);
    EXPECT_NE(text.find(problem), std::string::npos) << text;
  };
  const std::int64_t large = 1'000'000'000'000'000'000;
  for (const std::vector<std::int64_t>& shape : std::vector<std::vector<std::int64_t>>{
           {2, 2, large}, {2, 4, large * 4}, {2, 0, large}, {2, 2, -1}, {2, 2, 1}, {large, 2, 2}})
    says("mesh has no such faces", [&](Archive& archive) { archive.integer["mesh"] = shape; });
  says("a face names point 3", [](Archive& archive) { archive.integer["faces"][1] = 3; });
  for (const std::vector<std::int64_t>& begin :
       std::vector<std::vector<std::int64_t>>{{4, 0}, {0, 3}, {-1, 0}, {0, -1}})
    says("body bow has no such points or faces",
         [&](Archive& archive) { archive.integer["body.bow"] = begin; });
  for (const char* name : {"time", "dt", "displacement", "velocity", "force", "position"})
    says(std::string(name) + " holds what is no finite number",
         [&](Archive& archive) { archive.real[name](0, 0) = std::numeric_limits<double>::quiet_NaN(); });
}

TEST(InterfaceRecord, RefusesAFolderWithoutOne) {
  TemporaryFolder folder;
  EXPECT_THROW(read_interface_record(folder.path()), Error);
  std::filesystem::create_directories(folder / "interface");
  put(folder / "interface/000001.h5", "no HDF5 file");
  EXPECT_THROW(read_interface_record(folder.path()), Error);
}

}  // namespace interface_record_test
}  // namespace strake
