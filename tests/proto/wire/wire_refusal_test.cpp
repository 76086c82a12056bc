// What no message may hold, on the side that sends it or on the one that receives it.

#include "tests/proto/wire/wire_parts.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace strake::wire {
namespace wire_refusal_test {

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

}  // namespace wire_refusal_test
}  // namespace strake::wire
