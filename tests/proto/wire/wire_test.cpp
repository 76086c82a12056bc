#include "tests/proto/wire/wire_parts.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace strake::wire {
namespace wire_test {

TEST(Wire, ASetupKeepsEveryBit) {
  strake::Setup setup{
      "runs/x", "surface", square(), {field("displacement", "m", 3, 4), field("velocity", "m/s", 3, 4)}};
  const strake::Setup got = request_round_trip(setup);
  EXPECT_EQ(got.run_folder, setup.run_folder);
  EXPECT_EQ(got.interface, "surface");
  expect_equal(got.partner_mesh, setup.partner_mesh);
  expect_equal(got.partner_initial, setup.partner_initial);
}

TEST(Wire, ASetupWithoutPartnerHasAnEmptyMesh) {
  const strake::Setup got = request_round_trip(strake::Setup{});
  EXPECT_EQ(got.partner_mesh.position.cols(), 0);
  EXPECT_TRUE(got.partner_initial.empty());
}

TEST(Wire, AnAdvanceKeepsItsSamplesInOrder) {
  Advance advance{Before::rewind, {0.1 + 0.2, 1e-5}, 3, {}, true};
  advance.input.samples = {{0.30001, {field("displacement", "m", 3, 4), field("area", "m^2", 1, 4)}},
                           {0.30002, {field("displacement", "m", 3, 4)}}};
  const Advance got = request_round_trip(advance);
  EXPECT_EQ(got.before, Before::rewind);
  EXPECT_EQ(got.window.t, advance.window.t);
  EXPECT_EQ(got.window.dt, advance.window.dt);
  EXPECT_EQ(got.iteration, 3u);
  EXPECT_TRUE(got.write_output);
  ASSERT_EQ(got.input.samples.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(got.input.samples[i].time, advance.input.samples[i].time);
    expect_equal(got.input.samples[i].fields, advance.input.samples[i].fields);
  }
}

TEST(Wire, TheSmallRequestsComeBack) {
  const Checkpoint c = request_round_trip(Checkpoint{"runs/x/checkpoint", true, Before::commit, true});
  EXPECT_EQ(c.folder, "runs/x/checkpoint");
  EXPECT_TRUE(c.resume && c.write_output);
  EXPECT_EQ(c.before, Before::commit);
  const Stop s = request_round_trip(Stop{true, false});
  EXPECT_TRUE(s.commit);
  EXPECT_FALSE(s.write_output);
  EXPECT_EQ(request_round_trip(Refused{"coupler", "no", "yes"}).problem, "no");
}

TEST(Wire, AReadyKeepsMeshAndDescription) {
  Ready ready{square(), {}};
  ready.description.initial = {field("displacement", "m", 3, 4)};
  ready.description.columns = {{"cfl", "1"}, {"energy", "J"}};
  ready.description.lines = {"fem", "512 cells"};
  ready.description.prescribed = true;
  const Ready got = reply_round_trip(ready);
  expect_equal(got.mesh, ready.mesh);
  expect_equal(got.description.initial, ready.description.initial);
  EXPECT_EQ(got.description.dt_limit, inf) << "no limit is a limit that may be sent";
  ASSERT_EQ(got.description.columns.size(), 2u);
  EXPECT_EQ(got.description.columns[1].name, "energy");
  EXPECT_EQ(got.description.columns[1].unit, "J");
  EXPECT_EQ(got.description.lines, ready.description.lines);
  EXPECT_TRUE(got.description.prescribed);
}

TEST(Wire, AReadyThatNamesAColumnTwiceIsRefused) {
  Ready ready{square(), {}};
  ready.description.columns = {{"cfl", "1"}, {"energy", "J"}, {"cfl", "1"}};
  EXPECT_THROW(encode(Reply{1, ready}, "structure"), Error);
}

TEST(Wire, AnAdvancedKeepsFieldsLimitAndMonitors) {
  Advanced a;
  a.output = {field("force", "N", 3, 4)};
  a.dt_limit = 2e-6;
  a.monitor = {{"cfl", 0.1}, {"check.voids", nan}};
  a.retry_smaller_dt = true;
  a.why = "a cell is turned inside out";
  a.fix = "a shorter window";
  const Advanced got = reply_round_trip(a);
  expect_equal(got.output, a.output);
  EXPECT_EQ(got.dt_limit, 2e-6);
  EXPECT_EQ(got.monitor.at("cfl"), 0.1);
  EXPECT_TRUE(std::isnan(got.monitor.at("check.voids")))
      << "a monitor may be undefined; the summary writes null";
  EXPECT_TRUE(got.retry_smaller_dt);
  EXPECT_EQ(got.why, a.why);
  EXPECT_EQ(got.fix, a.fix);
  a.why = "two\nlines";
  EXPECT_THROW(reply_round_trip(a), Error) << "it stands in one line of a log";
}

TEST(Wire, TheSmallRepliesComeBack) {
  const std::string token("\x00\xff\x10", 3);
  const Hello h = reply_round_trip(Hello{protocol, "fluid", token, "mps", "0.1.0", std::string(32, '\x80')});
  EXPECT_EQ(h.token, token);
  EXPECT_EQ(h.case_hash.size(), 32u);
  EXPECT_EQ(h.protocol, 1u);
  EXPECT_EQ(reply_round_trip(Working{0.5, "factorising"}).what, "factorising");
  EXPECT_EQ(reply_round_trip(Fault{"a", "b", "c", ExitCode::case_file}).code, ExitCode::case_file);
  reply_round_trip(Done{});
}

TEST(Wire, AFaultNeverCountsAsSuccess) {
  for (std::uint32_t code : {0u, 1u, 99u}) {
    const Parts parts =
        with_header<pb::Reply>(encode(Reply{1, Fault{"a", "b", "c", ExitCode::our_bug}}, "fluid"),
                               [&](pb::Reply& r) { r.mutable_fault()->set_exit_code(code); });
    EXPECT_EQ(std::get<Fault>(decode_reply(parts, "fluid").what).code, ExitCode::solver_fault);
  }
}

TEST(Wire, ArraysLeaveWithoutACopy) {
  Advanced a;
  a.output = {field("force", "N", 3, 1000)};
  const double* numbers = a.output[0].value.data();
  const Parts parts = encode(Reply{1, std::move(a)}, "fluid");
  EXPECT_EQ(static_cast<const void*>(parts.at(1).bytes.data()), static_cast<const void*>(numbers));
  EXPECT_NE(parts.at(1).owner, nullptr);
}

TEST(Wire, ArraysAreTheRawLittleEndianNumbersColumnByColumn) {
  Advanced a;
  a.output = {{"force", "N", true, Eigen::MatrixXd::Zero(3, 2)}};
  a.output[0].value.edit() << 1, 4, 2, 5, 3, 6;
  const Parts parts = encode(Reply{1, a}, "fluid");
  const double expected[] = {1, 2, 3, 4, 5, 6};
  ASSERT_EQ(parts.at(1).bytes.size(), sizeof expected);
  EXPECT_EQ(std::memcmp(parts[1].bytes.data(), expected, sizeof expected), 0);
}

/// A fluid with the first two points as one mesh and the others as a second.
Ready two_meshes() {
  Ready ready{square(), {}};
  ready.mesh.faces = (Eigen::MatrixXi(2, 2) << 0, 2, 1, 3).finished();
  ready.mesh.meshes = {{"nodes", 0, 0}, {"faces", 2, 1}};
  ready.description.initial = {field("force", "N", 3, 4)};
  ready.description.sent_on = {{"force", "faces"}};
  ready.description.taken_on = {{"displacement", "nodes"}};
  return ready;
}

TEST(Wire, SeveralMeshesOfASolverComeBack) {
  const Ready got = reply_round_trip(two_meshes());
  ASSERT_EQ(got.mesh.meshes.size(), 2u);
  EXPECT_EQ(got.mesh.meshes[1].name, "faces");
  EXPECT_EQ(got.mesh.meshes[1].first_point, 2);
  EXPECT_EQ(got.mesh.meshes[1].first_face, 1);
  EXPECT_EQ(got.description.sent_on, two_meshes().description.sent_on);
  EXPECT_EQ(got.description.taken_on, two_meshes().description.taken_on);
}

TEST(Wire, MeshesThatAreNoPartsOfTheMeshAreRefused) {
  const Parts ready = through_the_air(encode(Reply{1, two_meshes()}, "fluid"));
  const auto changed = [&](const std::function<void(pb::Ready&)>& change) {
    return with_header<pb::Reply>(ready, [&](pb::Reply& r) { change(*r.mutable_ready()); });
  };
  const auto second = [&](const std::function<void(pb::MeshPart&)>& change) {
    return changed([&](pb::Ready& r) { change(*r.mutable_mesh()->mutable_meshes(1)); });
  };
  expect_broken(second([](pb::MeshPart& m) { m.set_first_point(4); }), "no place for the mesh faces");
  expect_broken(second([](pb::MeshPart& m) { m.set_first_point(0); }), "no place for the mesh nodes");
  expect_broken(second([](pb::MeshPart& m) { m.set_first_point(~0ull); }), "no place for the mesh nodes");
  expect_broken(second([](pb::MeshPart& m) { m.set_first_face(3); }), "no place for the mesh nodes");
  expect_broken(second([](pb::MeshPart& m) { m.set_first_face(2); }), "on a point of another mesh");
  expect_broken(second([](pb::MeshPart& m) { m.set_name("nodes"); }), "\"nodes\" twice");
  expect_broken(second([](pb::MeshPart& m) { m.set_name("a\nb"); }), "mesh name that holds the character");
  expect_broken(changed([](pb::Ready& r) { r.mutable_sent_on(0)->set_mesh("edges"); }),
                "has force on the mesh \"edges\", which it lacks");
  expect_broken(changed([](pb::Ready& r) { r.mutable_taken_on(0)->set_mesh(""); }), "which it lacks");
  expect_broken(changed([](pb::Ready& r) { r.clear_sent_on(); }),
                "joins 2 meshes and does not say on which one force is sent");
  expect_broken(changed([](pb::Ready& r) { *r.add_sent_on() = r.sent_on(0); }), "gives two meshes for force");
  expect_broken(changed([](pb::Ready& r) { r.mutable_mesh()->clear_meshes(); }), "which it lacks");
}

// A stranger's words stand in the log and on the terminal.

}  // namespace wire_test
}  // namespace strake::wire
