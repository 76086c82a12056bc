#pragma once

#include "coupler/watch/web/http_api.hpp"
#include "proto/files/json_file.hpp"
#include "proto/files/result_file.hpp"
#include "tests/coupler/watch/watch_files.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace strake::watch {

/// Two particles of water, one of the wall, one of the structure's.
inline Frame water(double time) {
  Frame frame;
  frame.time = time;
  frame.position = Points::Zero(3, 4);
  frame.position.row(0) << 0, 1, 2, 3;
  Eigen::MatrixXd pressure(1, 4), velocity = Eigen::MatrixXd::Zero(3, 4), kind(1, 4), id(1, 4);
  pressure << 100, 200, 5000, 6000;
  velocity.row(0) << 3, 0, 0, 0;
  velocity.row(1) << 4, 0, 0, 0;
  kind << 0, 0, 1, 3;
  id << 7, 5, 9, 11;
  frame.point_data = {
      {"pressure", "Pa", pressure}, {"velocity", "m/s", velocity}, {"kind", "1", kind}, {"id", "1", id}};
  return frame;
}

/// As the page reads a message.
struct Read {
  explicit Read(std::string text) : bytes(std::move(text)) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data(), sizeof length);
    EXPECT_EQ((length + sizeof length) % 8, 0U);
    head = Json::parse(bytes.substr(sizeof length, length));
  }
  template <typename T>
  std::vector<T> array(const std::string& name) const {
    if (!head["arrays"].contains(name)) return {};
    const Json& place = head["arrays"][name];
    EXPECT_EQ(place["at"].get<std::size_t>() % 8, 0U);
    std::vector<T> values(place["count"].get<std::size_t>());
    EXPECT_LE(place["at"].get<std::size_t>() + values.size() * sizeof(T), bytes.size());
    if (!values.empty())
      std::memcpy(values.data(), bytes.data() + place["at"].get<std::size_t>(), values.size() * sizeof(T));
    return values;
  }
  std::string bytes;
  Json head;
};

class PageOfARun : public testing::Test {
 protected:
  PageOfARun() {
    files.windows(8);
    FrameSeries(files.path(), "fluid", 2).write(water(0.5));
    put(files.path() / "coupler.log", "one\ntwo\nhalf a li");
  }
  Json json(const std::string& path, const HttpApi::Query& query = {}) {
    const HttpApi::Answer answer = api.answer(path, query);
    EXPECT_EQ(answer.status, 200) << answer.body;
    return Json::parse(answer.body);
  }
  int status(const std::string& path, const HttpApi::Query& query = {}) {
    return api.answer(path, query).status;
  }

  RunFiles files;
  HttpApi api{files.path()};
};

}  // namespace strake::watch
