#include "coupler/transport/endpoint.hpp"

#include <gtest/gtest.h>

#include <string>

namespace strake {
namespace endpoint_test {

TEST(Endpoint, AnAddressThatCanBeBoundHasNoProblem) {
  for (const char* good :
       {"ipc:///tmp/a", "ipc://a", "ipc://@name", "tcp://127.0.0.1:5555", "tcp://127.0.0.1:*", "tcp://*:5555",
        "tcp://[::1]:1", "tcp://[fe80::1%eth0]:65535", "tcp://eth0:5555"})
    EXPECT_EQ(problem_of_endpoint(good), "") << good;
  EXPECT_EQ(problem_of_endpoint("ipc://" + std::string(unix_path, 'a')), "");
}

TEST(Endpoint, WhatIsWrongIsSaidInWords) {
  const auto expect_words = [](const std::string& endpoint, const std::string& words) {
    EXPECT_NE(problem_of_endpoint(endpoint).find(words), std::string::npos)
        << endpoint << ": " << problem_of_endpoint(endpoint);
  };
  for (const char* none :
       {"", "nonsense", "udp://127.0.0.1:1", "inproc://a", "TCP://127.0.0.1:1", "tcp:/1:2"})
    expect_words(none, "is neither ipc://PATH nor tcp://ADDRESS:PORT");
  for (const char* port : {"99999", "65536", "0", "-1", "", "5555x", " 5555", "1e3", "100000000000000000000"})
    expect_words(std::string("tcp://127.0.0.1:") + port, std::string("has the port \"") + port + "\"");
  for (const char* without : {"tcp://1.2.3.4", "tcp://", "tcp://[::1]", "tcp://localhost"})
    expect_words(without, "has no port");
  expect_words("tcp://:5555", "has no address");
  for (const char* host : {"a b", "127.0.0.1;10.0.0.1", "::1", "a/b", "**"})
    expect_words(std::string("tcp://") + host + ":5555", std::string("has the address \"") + host + "\"");
  for (const char* path : {"ipc://", "ipc://@", "ipc://*"}) expect_words(path, "has no path");
  expect_words("ipc:///tmp/", "is a folder");
  expect_words("ipc:///tmp/a\nb", "control character");
  expect_words("ipc://" + std::string(unix_path + 1, 'a'), "has a path of 108 bytes");
}

}  // namespace endpoint_test
}  // namespace strake
