#include "proto/wire/wire.hpp"

#include "proto/coupling.pb.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

namespace strake::wire {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// What a peer would receive: the bytes alone.
Parts through_the_air(const Parts& parts) {
  Parts copy;
  for (const Part& part : parts) {
    auto bytes = std::make_shared<std::vector<std::byte>>(part.bytes.begin(), part.bytes.end());
    copy.push_back({*bytes, bytes});
  }
  return copy;
}

/// A copy of the parts with other bytes in one place.
Parts with_part(Parts parts, std::size_t index, std::vector<std::byte> bytes) {
  auto kept = std::make_shared<std::vector<std::byte>>(std::move(bytes));
  parts.at(index) = {*kept, kept};
  return parts;
}

std::vector<std::byte> bytes_of(const Part& part) {
  return {part.bytes.begin(), part.bytes.end()};
}

template <class Header>
Parts with_header(const Parts& parts, const std::function<void(Header&)>& change) {
  Header header;
  EXPECT_TRUE(header.ParseFromArray(parts[0].bytes.data(), static_cast<int>(parts[0].bytes.size())));
  change(header);
  const std::string text = header.SerializeAsString();
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return with_part(parts, 0, {begin, begin + text.size()});
}

InterfaceMesh square() {
  InterfaceMesh mesh;
  mesh.name = "plate";
  mesh.dimension = 2;
  mesh.position = Points::Random(3, 4);
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 1, 2, 3;
  mesh.mass = Eigen::VectorXd::Random(4);
  return mesh;
}
Field field(const std::string& quantity, const std::string& unit, Eigen::Index components, Eigen::Index n) {
  return {quantity, unit, quantity == "force", Eigen::MatrixXd::Random(components, n)};
}

void expect_equal(const InterfaceMesh& a, const InterfaceMesh& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.dimension, b.dimension);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(a.mass, b.mass);
}
void expect_equal(const std::vector<Field>& a, const std::vector<Field>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].quantity, b[i].quantity);
    EXPECT_EQ(a[i].unit, b[i].unit);
    EXPECT_EQ(a[i].conservative, b[i].conservative);
    EXPECT_EQ(a[i].value, b[i].value);
  }
}

template <class T>
T request_round_trip(T what) {
  const Request got = decode_request(through_the_air(encode(Request{7, std::move(what)})));
  EXPECT_EQ(got.sequence, 7u);
  return std::get<T>(got.what);
}
template <class T>
T reply_round_trip(T what) {
  const Reply got = decode_reply(through_the_air(encode(Reply{9, std::move(what)}, "fluid")), "fluid");
  EXPECT_EQ(got.sequence, 9u);
  return std::get<T>(got.what);
}

Parts advanced(Eigen::Index n = 4) {
  Advanced a;
  a.output = {field("force", "N", 3, n), field("pressure", "Pa", 1, n)};
  return through_the_air(encode(Reply{3, a}, "fluid"));
}

/// The error that decoding a reply ends with.
Error refused(const Parts& parts) {
  try {
    decode_reply(parts, "fluid");
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), "fluid");
    return e;
  }
  ADD_FAILURE() << "accepted";
  return {ExitCode::done, "", ""};
}
void expect_broken(const Parts& parts, const std::string& text) {
  const Error e = refused(parts);
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find(text), std::string::npos) << e.problem();
}

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
  const Ready got = reply_round_trip(ready);
  expect_equal(got.mesh, ready.mesh);
  expect_equal(got.description.initial, ready.description.initial);
  EXPECT_EQ(got.description.dt_limit, inf) << "no limit is a limit that may be sent";
  ASSERT_EQ(got.description.columns.size(), 2u);
  EXPECT_EQ(got.description.columns[1].name, "energy");
  EXPECT_EQ(got.description.columns[1].unit, "J");
  EXPECT_EQ(got.description.lines, ready.description.lines);
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

TEST(Wire, ValuesThatAreNotFiniteAreRefusedOnBothSides) {
  for (double bad : {nan, inf, -inf}) {
    Advanced a;
    a.output = {field("force", "N", 3, 4)};
    a.output[0].value.edit()(2, 1) = bad;
    try {
      encode(Reply{1, a}, "fluid");
      FAIL() << "sent";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::solver_fault);
      EXPECT_NE(e.problem().find("at point 1 of 4, component 2"), std::string::npos) << e.problem();
    }
    std::vector<std::byte> bytes = bytes_of(advanced()[1]);
    std::memcpy(bytes.data() + 5 * sizeof(double), &bad, sizeof bad);
    const Error e = refused(with_part(advanced(), 1, bytes));
    EXPECT_EQ(e.code(), ExitCode::solver_fault);
    EXPECT_NE(e.problem().find("force is not finite"), std::string::npos) << e.problem();
    EXPECT_NE(e.problem().find("at point 1 of 4, component 2"), std::string::npos) << e.problem();
  }
}

TEST(Wire, AValueThatIsNotFiniteIsFoundWhereverItStandsInALongField) {
  constexpr Eigen::Index n = 1500;  // longer than what is copied at once
  for (const double bad : {nan, inf, -inf})
    for (const Eigen::Index at : {Eigen::Index{0}, Eigen::Index{682}, Eigen::Index{683}, n - 1}) {
      std::vector<std::byte> bytes = bytes_of(advanced(n)[1]);
      std::memcpy(bytes.data() + (3 * static_cast<std::size_t>(at) + 2) * sizeof(double), &bad, sizeof bad);
      const Error e = refused(with_part(advanced(n), 1, bytes));
      EXPECT_EQ(e.code(), ExitCode::solver_fault);
      EXPECT_NE(e.problem().find(fmt::format("at point {} of 1500, component 2", at)), std::string::npos)
          << e.problem();
    }
}

TEST(Wire, ATimeThatIsNotFiniteIsRefused) {
  EXPECT_THROW(encode(Request{1, Advance{Before::nothing, {nan, 1}, 1, {}, false}}), Error);
  EXPECT_THROW(encode(Request{1, Advance{Before::nothing, {0, inf}, 1, {}, false}}), Error);
  EXPECT_THROW(encode(Request{1, Advance{Before::nothing, {0, 1}, 1, {{{nan, {}}}}, false}}), Error);
}

TEST(Wire, AStepLimitThatIsNoLimitIsRefused) {
  for (double bad : {nan, 0.0, -1.0}) {
    const Error e = refused(
        with_header<pb::Reply>(advanced(), [&](pb::Reply& r) { r.mutable_advanced()->set_dt_limit(bad); }));
    EXPECT_EQ(e.code(), ExitCode::solver_fault);
  }
}

TEST(Wire, APartOfTheWrongSizeIsRefused) {
  for (int change : {-8, -1, 1, 8}) {
    std::vector<std::byte> bytes = bytes_of(advanced()[1]);
    bytes.resize(static_cast<std::size_t>(static_cast<int>(bytes.size()) + change));
    expect_broken(with_part(advanced(), 1, bytes), "bytes for force, expected 3 x 4 numbers of 8 bytes");
  }
  expect_broken(with_part(advanced(), 1, {}), "has 0 bytes for force");
}

TEST(Wire, MissingAndUnannouncedPartsAreRefused) {
  Parts parts = advanced();
  parts.pop_back();
  expect_broken(parts, "the one for pressure is missing");
  parts = advanced();
  parts.push_back(parts.back());
  expect_broken(parts, "has 4 parts, expected 3");
  expect_broken({}, "has no parts");
}

TEST(Wire, AnnouncedCountsAreNeverBelieved) {
  // 2^61 + 4 points of 3 components: times 24 bytes it wraps round to the 96 bytes that came.
  for (std::uint64_t n :
       {std::uint64_t{5}, std::uint64_t{1} << 40, (std::uint64_t{1} << 61) + 4, ~std::uint64_t{0}})
    expect_broken(
        with_header<pb::Reply>(
            advanced(), [&](pb::Reply& r) { r.mutable_advanced()->mutable_fields(0)->set_n_points(n); }),
        "has 96 bytes for force");
  expect_broken(with_header<pb::Reply>(advanced(),
                                       [](pb::Reply& r) {
                                         r.mutable_advanced()->mutable_fields(0)->set_components(4294967295u);
                                       }),
                "has 96 bytes for force");
  expect_broken(
      with_header<pb::Reply>(
          advanced(), [](pb::Reply& r) { r.mutable_advanced()->mutable_fields(0)->set_components(0); }),
      "no components for force");
}

TEST(Wire, AFieldWithoutQuantityOrUnitIsRefused) {
  expect_broken(
      with_header<pb::Reply>(advanced(),
                             [](pb::Reply& r) { r.mutable_advanced()->mutable_fields(0)->clear_quantity(); }),
      "without a quantity");
  expect_broken(with_header<pb::Reply>(
                    advanced(), [](pb::Reply& r) { r.mutable_advanced()->mutable_fields(1)->clear_unit(); }),
                "no unit for pressure");
}

TEST(Wire, AMeshThatDoesNotHangTogetherIsRefused) {
  const Parts ready = through_the_air(encode(Reply{1, Ready{square(), {}}}, "fluid"));
  const auto changed = [&](const std::function<void(pb::Mesh&)>& change) {
    return with_header<pb::Reply>(ready, [&](pb::Reply& r) { change(*r.mutable_ready()->mutable_mesh()); });
  };
  expect_broken(changed([](pb::Mesh& m) { m.set_dimension(1); }), "dimension 1, expected 2 or 3");
  expect_broken(changed([](pb::Mesh& m) { m.set_n_points(5); }), "bytes for mesh position");
  expect_broken(changed([](pb::Mesh& m) { m.set_n_faces(2); }), "bytes for mesh faces");
  expect_broken(changed([](pb::Mesh& m) { m.set_has_mass(false); }), "has 4 parts, expected 3");
  std::vector<std::byte> faces = bytes_of(ready[2]);
  const int beyond = 4;
  std::memcpy(faces.data(), &beyond, sizeof beyond);
  expect_broken(with_part(ready, 2, faces), "a face with point 4, expected 0 to 3");
  InterfaceMesh mesh = square();
  mesh.mass.conservativeResize(2);
  EXPECT_THROW(encode(Reply{1, Ready{mesh, {}}}, "fluid"), Error);
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
TEST(Wire, ANameIsShortAndPrintable) {
  for (const std::string& name : {std::string(201, 'x'), std::string("fluid\x1b[2J"), std::string("a\nb")}) {
    const wire::Parts hello = wire::encode(wire::Reply{0, wire::Hello{1, name, "", "toy", "1", ""}}, "fluid");
    EXPECT_THROW(wire::decode_reply(hello, "a stranger"), Error) << name;
    Advanced advanced;
    advanced.monitor[name] = 1;
    const wire::Parts answer = wire::encode(wire::Reply{1, advanced}, "fluid");
    EXPECT_THROW(wire::decode_reply(answer, "fluid"), Error) << name;
    advanced.monitor.clear();
    advanced.output = {{name, "m", false, Points::Zero(3, 1)}};
    EXPECT_THROW(wire::encode(wire::Reply{1, advanced}, "fluid"), Error) << name;
  }
  const wire::Parts longest =
      wire::encode(wire::Reply{0, wire::Hello{1, std::string(200, 'x'), "", "", "", ""}}, "fluid");
  EXPECT_NO_THROW(wire::decode_reply(longest, "fluid"));
}

TEST(Wire, AHeaderThatIsNoMessageIsRefused) {
  expect_broken(with_part(advanced(), 0, std::vector<std::byte>(20, std::byte{0xff})), "cannot be read");
  expect_broken(with_part(advanced(), 0, {}), "says nothing that this side knows");
  const Error e = [] {
    try {
      decode_request({Part{}});
    } catch (const Error& error) {
      return error;
    }
    return Error(ExitCode::done, "", "");
  }();
  EXPECT_EQ(e.where(), "coupler");
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
}

TEST(Wire, EveryTruncatedHeaderIsRefusedOrReadWithoutHarm) {
  const Parts whole = advanced();
  for (std::size_t n = 0; n < whole[0].bytes.size(); ++n) {
    std::vector<std::byte> bytes = bytes_of(whole[0]);
    bytes.resize(n);
    EXPECT_THROW(decode_reply(with_part(whole, 0, bytes), "fluid"), Error) << n << " bytes of the header";
  }
}

}  // namespace
}  // namespace strake::wire
