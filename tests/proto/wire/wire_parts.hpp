#pragma once

#include "proto/coupling.pb.h"
#include "proto/wire/wire.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace strake::wire {

inline constexpr double inf = std::numeric_limits<double>::infinity();
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// What a peer would receive: the bytes alone.
inline Parts through_the_air(const Parts& parts) {
  Parts copy;
  for (const Part& part : parts) {
    auto bytes = std::make_shared<std::vector<std::byte>>(part.bytes.begin(), part.bytes.end());
    copy.push_back({*bytes, bytes});
  }
  return copy;
}

/// A copy of the parts with other bytes in one place.
inline Parts with_part(Parts parts, std::size_t index, std::vector<std::byte> bytes) {
  auto kept = std::make_shared<std::vector<std::byte>>(std::move(bytes));
  parts.at(index) = {*kept, kept};
  return parts;
}

inline std::vector<std::byte> bytes_of(const Part& part) {
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

inline InterfaceMesh square() {
  InterfaceMesh mesh;
  mesh.name = "plate";
  mesh.dimension = 2;
  mesh.position = Points::Random(3, 4);
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 1, 2, 3;
  mesh.mass = Eigen::VectorXd::Random(4);
  return mesh;
}
inline Field field(const std::string& quantity, const std::string& unit, Eigen::Index components,
                   Eigen::Index n) {
  return {quantity, unit, quantity == "force", Eigen::MatrixXd::Random(components, n)};
}

inline void expect_equal(const InterfaceMesh& a, const InterfaceMesh& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.dimension, b.dimension);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(a.mass, b.mass);
}
inline void expect_equal(const std::vector<Field>& a, const std::vector<Field>& b) {
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

inline Parts advanced(Eigen::Index n = 4) {
  Advanced a;
  a.output = {field("force", "N", 3, n), field("pressure", "Pa", 1, n)};
  return through_the_air(encode(Reply{3, a}, "fluid"));
}

/// The error that decoding a reply ends with.
inline Error refused(const Parts& parts) {
  try {
    decode_reply(parts, "fluid");
  } catch (const Error& e) {
    EXPECT_EQ(e.where(), "fluid");
    return e;
  }
  ADD_FAILURE() << "accepted";
  return {ExitCode::done, "", ""};
}
inline void expect_broken(const Parts& parts, const std::string& text) {
  const Error e = refused(parts);
  EXPECT_EQ(e.code(), ExitCode::participant_lost);
  EXPECT_NE(e.problem().find(text), std::string::npos) << e.problem();
}

}  // namespace strake::wire
