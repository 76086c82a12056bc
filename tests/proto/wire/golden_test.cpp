// The golden messages of tests/proto/golden, read and written again. golden.py compares the same files with
// Python.
#include "proto/wire/wire.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

namespace strake::wire {
namespace golden_test {

constexpr double inf = std::numeric_limits<double>::infinity();
const std::filesystem::path folder = std::filesystem::path(STRAKE_SOURCE_DIR) / "tests" / "proto" / "golden";

Parts read_parts(const std::string& name) {
  std::vector<std::shared_ptr<std::vector<std::byte>>> frames;
  std::ifstream file(folder / (name + ".hex"));
  EXPECT_TRUE(file) << name;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    if (line.starts_with("frame ")) {
      frames.push_back(std::make_shared<std::vector<std::byte>>());
      continue;
    }
    std::istringstream bytes(line.substr(0, line.find('|')));
    for (unsigned value = 0; bytes >> std::hex >> value;) frames.back()->push_back(std::byte(value));
  }
  Parts parts;
  for (const auto& frame : frames) parts.push_back({*frame, frame});
  return parts;
}

std::string hex(const Part& part) {
  std::string text;
  for (const std::byte byte : part.bytes) {
    const char* digits = "0123456789abcdef";
    text += {digits[static_cast<unsigned>(byte) >> 4], digits[static_cast<unsigned>(byte) & 15], ' '};
  }
  return text;
}
void expect_same_bytes(const Parts& written, const Parts& file) {
  ASSERT_EQ(written.size(), file.size());
  for (std::size_t i = 0; i < file.size(); ++i) EXPECT_EQ(hex(written[i]), hex(file[i])) << "frame " << i;
}

/// Reads the file, writes what was read, and gives it back.
template <class T>
T request(const std::string& name, std::uint64_t sequence) {
  const Parts file = read_parts(name);
  const Request got = decode_request(file);
  EXPECT_EQ(got.sequence, sequence);
  expect_same_bytes(encode(got), file);
  return std::get<T>(got.what);
}
template <class T>
T reply(const std::string& name, std::uint64_t sequence, Times times = {}) {
  const Parts file = read_parts(name);
  const Reply got = decode_reply(file, "structure");
  EXPECT_EQ(got.sequence, sequence);
  EXPECT_EQ(got.times.received, times.received);
  EXPECT_EQ(got.times.answered, times.answered);
  expect_same_bytes(encode(got, "structure"), file);
  return std::get<T>(got.what);
}

void expect_field(const Field& field, const std::string& quantity, const std::string& unit, bool conservative,
                  const Eigen::MatrixXd& value) {
  EXPECT_EQ(field.quantity, quantity);
  EXPECT_EQ(field.unit, unit);
  EXPECT_EQ(field.conservative, conservative);
  EXPECT_EQ(field.value, value);
}
Eigen::MatrixXd everywhere(double y) {
  return Eigen::Vector3d(0, y, 0).replicate(1, 4);
}
Points outline() {
  Points points(3, 4);
  points << 0, 1, 1, 0, 0, 0, 0.5, 0.5, 0, 0, 0, 0;
  return points;
}

TEST(GoldenMessages, SetUp) {
  const Hello hello = reply<Hello>("01-hello", 0);
  EXPECT_EQ(hello.protocol, protocol);
  EXPECT_EQ(hello.name, "structure");
  EXPECT_EQ(hello.solver, "spring");
  EXPECT_EQ(hello.version, "1.2");
  ASSERT_EQ(hello.token.size(), 16u);
  ASSERT_EQ(hello.case_hash.size(), 32u);
  EXPECT_EQ(hello.token[15], 15);
  EXPECT_EQ(hello.case_hash[0], 32);

  const strake::Setup first = request<strake::Setup>("02-setup-structure", 1);
  EXPECT_EQ(first.run_folder, "/home/me/runs/x");
  EXPECT_EQ(first.interface, "surface");
  EXPECT_EQ(first.partner_mesh.position.cols(), 0);

  const Ready structure = reply<Ready>("03-ready-structure", 1);
  EXPECT_EQ(structure.mesh.name, "spring");
  EXPECT_EQ(structure.mesh.dimension, 2);
  EXPECT_EQ(structure.mesh.position, outline());
  EXPECT_EQ(structure.mesh.faces, (Eigen::MatrixXi(2, 4) << 0, 1, 2, 3, 1, 2, 3, 0).finished());
  EXPECT_EQ(structure.mesh.mass, Eigen::Vector4d(1, 2, 3, 4));
  EXPECT_EQ(structure.description.dt_limit, inf);
  EXPECT_EQ(structure.description.columns.at(0).name, "floor.y");
  EXPECT_EQ(structure.description.lines.at(0), "spring   m 200 kg/m");
  ASSERT_EQ(structure.description.initial.size(), 2u);
  expect_field(structure.description.initial[0], "displacement", "m", false, everywhere(0));
  expect_field(structure.description.initial[1], "velocity", "m/s", false, everywhere(-6.26));

  const strake::Setup second = request<strake::Setup>("04-setup-fluid", 1);
  EXPECT_EQ(second.partner_mesh.position, outline());
  EXPECT_EQ(second.partner_mesh.mass.size(), 0);
  ASSERT_EQ(second.partner_initial.size(), 1u);

  const Ready fluid = reply<Ready>("05-ready-fluid", 1);
  EXPECT_EQ(fluid.mesh.position.row(0), Eigen::RowVector2d(0.25, 0.75));
  EXPECT_EQ(fluid.mesh.faces.cols(), 0);
  EXPECT_EQ(fluid.description.dt_limit, 1e-4);
}

TEST(GoldenMessages, Windows) {
  const Advance first = request<Advance>("06-advance", 2);
  EXPECT_EQ(first.before, Before::nothing);
  EXPECT_EQ(first.window.t, 0);
  EXPECT_EQ(first.window.dt, 1e-5);
  EXPECT_EQ(first.iteration, 1u);
  ASSERT_EQ(first.input.samples.size(), 1u);
  EXPECT_EQ(first.input.samples[0].time, 1e-5);
  expect_field(first.input.samples[0].fields.at(0), "force", "N", true, everywhere(12.5));

  const Advanced advanced = reply<Advanced>("07-advanced", 2, {5'000'000'000, 5'000'125'000});
  expect_field(advanced.output.at(0), "displacement", "m", false, everywhere(-1e-6));
  EXPECT_EQ(advanced.monitor.at("floor.y"), -1e-6);
  EXPECT_FALSE(advanced.retry_smaller_dt);

  const Advance again = request<Advance>("08-advance-rewind", 3);
  EXPECT_EQ(again.before, Before::rewind);
  EXPECT_EQ(again.iteration, 2u);

  const Advance next = request<Advance>("09-advance-history", 4);
  EXPECT_EQ(next.before, Before::commit);
  EXPECT_TRUE(next.write_output);
  ASSERT_EQ(next.input.samples.size(), 2u);
  EXPECT_EQ(next.input.samples[0].time, 1.5e-5);
  expect_field(next.input.samples[1].fields.at(0), "displacement", "m", false, everywhere(-2e-6));

  const Advanced retry = reply<Advanced>("10-advanced-retry", 4);
  EXPECT_TRUE(retry.retry_smaller_dt);
  EXPECT_EQ(retry.dt_limit, 5e-6);

  const Advanced scalar = reply<Advanced>("11-scalar-fields", 5);
  expect_field(scalar.output.at(0), "pressure", "Pa", false, Eigen::RowVector2d(101325, -2.5));
}

TEST(GoldenMessages, EverythingElse) {
  EXPECT_EQ(reply<Working>("12-working", 5).fraction, 0.5);
  const Checkpoint write = request<Checkpoint>("13-checkpoint", 6);
  EXPECT_EQ(write.folder, "/home/me/runs/x/checkpoint/000002");
  EXPECT_EQ(write.before, Before::commit);
  EXPECT_FALSE(write.resume);
  EXPECT_TRUE(request<Checkpoint>("14-checkpoint-resume", 2).resume);
  const Stop stop = request<Stop>("15-stop", 7);
  EXPECT_TRUE(stop.commit && stop.write_output);
  reply<Done>("16-done", 7);
  const Fault fault = reply<Fault>("17-fault", 5);
  EXPECT_EQ(fault.code, ExitCode::solver_fault);
  EXPECT_EQ(fault.problem, "did not converge\n500 iterations");
  EXPECT_EQ(request<Refused>("18-refused", 0).where, "coupler");
}

TEST(GoldenMessages, HistoriesOfOtherFields) {
  const Ready structure = reply<Ready>("19-ready-history", 1);
  EXPECT_TRUE(structure.description.history);
  const Eigen::RowVector2d area(1e-4, 1e-4);
  expect_field(structure.description.initial.at(0), "area", "m^2", false, area);
  const strake::Setup setup = request<strake::Setup>("20-setup-history", 1);
  EXPECT_TRUE(setup.history);
  expect_field(setup.partner_initial.at(0), "area", "m^2", false, area);
  const Advanced advanced = reply<Advanced>("21-advanced-history", 2);
  expect_field(advanced.output.at(0), "pressure", "Pa", false, Eigen::RowVector2d(11, 21));
  ASSERT_EQ(advanced.history.size(), 2u);
  EXPECT_EQ(advanced.history[0].time, 5e-6);
  EXPECT_EQ(advanced.history[1].time, 1e-5);
  expect_field(advanced.history[0].fields.at(0), "pressure", "Pa", false, Eigen::RowVector2d(10, 20));
  expect_field(advanced.history[1].fields.at(0), "pressure", "Pa", false, Eigen::RowVector2d(12, 22));
}

TEST(GoldenMessages, WhatASideAsksFor) {
  const Description structure = reply<Ready>("22-ready-cannot-resume", 1).description;
  EXPECT_TRUE(structure.cannot_resume && structure.partner_initial);
  EXPECT_FALSE(structure.history);
  const Description other = reply<Ready>("19-ready-history", 1).description;
  EXPECT_FALSE(other.cannot_resume || other.partner_initial);
  const Input input = request<Advance>("23-advance-wants-history", 2).input;
  EXPECT_TRUE(input.wants_history);
  ASSERT_EQ(input.samples.size(), 2u);
  EXPECT_EQ(input.samples[0].time, 0);
  expect_field(input.samples[0].fields.at(0), "pressure", "Pa", false, Eigen::RowVector2d(9, 19));
  EXPECT_FALSE(request<Advance>("06-advance", 2).input.wants_history);
}

TEST(GoldenMessages, SeveralMeshes) {
  const Ready fluid = reply<Ready>("24-ready-meshes", 1);
  ASSERT_EQ(fluid.mesh.meshes.size(), 2u);
  EXPECT_EQ(fluid.mesh.meshes[0].name, "nodes");
  EXPECT_EQ(fluid.mesh.meshes[1].first_point, 1);
  EXPECT_EQ(fluid.description.sent_on.at("force"), "faces");
  EXPECT_EQ(fluid.description.taken_on.at("displacement"), "nodes");
  EXPECT_TRUE(reply<Ready>("05-ready-fluid", 1).mesh.meshes.empty());
}

TEST(GoldenMessages, AreTwentyFourFiles) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().stem());
  EXPECT_EQ(names.size(), 24u) << "a new one wants a line in the tests above";
}

}  // namespace golden_test
}  // namespace strake::wire
