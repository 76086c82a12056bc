#pragma once

#include "coupler/processes/remote.hpp"
#include "coupler/transport/sockets.hpp"
#include "proto/error.hpp"
#include "tests/text/golden.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

namespace strake {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

inline std::string raw(const std::string& hexadecimal) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hexadecimal.size(); i += 2)
    bytes += static_cast<char>(std::stoi(hexadecimal.substr(i, 2), nullptr, 16));
  return bytes;
}

inline InterfaceMesh three_points() {
  InterfaceMesh mesh;
  mesh.position = Points::Zero(3, 3);
  return mesh;
}
inline Advanced force(double value) {
  Advanced advanced;
  advanced.output = {{"force", "N", true, Points::Constant(3, 3, value)}};
  advanced.dt_limit = 1e-3;
  return advanced;
}

/// The other end, one message at a time.
class Script {
 public:
  Script(const std::string& endpoint, std::string name)
      : name_(std::move(name)), line_(std::make_unique<ParticipantSocket>(endpoint)) {}
  void leave() { line_.reset(); }

  void hello(const std::string& token, const std::string& hash = std::string(32, '\0'),
             std::uint32_t protocol = wire::protocol) {
    line_->send(
        wire::encode(wire::Reply{0, wire::Hello{protocol, name_, raw(token), "script", "1", hash}}, name_));
  }
  /// The next request, decoded as T.
  template <class T>
  T hear() {
    const auto parts = line_->receive(std::chrono::seconds(5));
    if (!parts) throw std::runtime_error("nothing was asked");
    wire::Request request = wire::decode_request(*parts);
    sequence_ = request.sequence;
    return std::get<T>(std::move(request.what));
  }
  template <class T>
  void say(T what) {
    say(sequence_, std::move(what));
  }
  template <class T>
  void say(std::uint64_t sequence, T what) {
    line_->send(wire::encode(wire::Reply{sequence, std::move(what)}, name_));
  }
  void send(const wire::Parts& parts) { line_->send(parts); }
  std::uint64_t sequence() const { return sequence_; }
  void join(const std::string& token) {
    hello(token);
    hear<strake::Setup>();
    say(wire::Ready{three_points(), {}});
  }

 private:
  std::string name_;
  std::unique_ptr<ParticipantSocket> line_;
  std::uint64_t sequence_ = 0;
};

class Remote : public testing::Test {
 protected:
  void SetUp() override {
    options_.say = [this](const std::string& line) { said_ += line + "\n"; };
    options_.deadlines.answer_within = std::chrono::seconds(5);
  }
  Participants& participants() {
    if (!participants_) {
      participants_ = std::make_unique<Participants>(options_);
      participants_->attach("fluid");
    }
    return *participants_;
  }
  /// Plays `script` beside what the coupler does in `act`.
  void play(const std::function<void(Script&)>& script, const std::function<void()>& act) {
    std::thread other([&, endpoint = participants().endpoint()] {
      try {
        Script s(endpoint, "fluid");
        script(s);
        while (!over_) std::this_thread::sleep_for(milliseconds(1));  // it stays until the coupler is done
      } catch (const std::exception& e) {
        ADD_FAILURE() << "the script: " << e.what();
      }
    });
    act();
    over_ = true;
    other.join();
    participants_.reset();
  }
  /// The error of the first window, which the script spoils.
  Error error_of(const std::function<void(Script&)>& spoil) {
    std::optional<Error> error;
    play(
        [&](Script& s) {
          s.join(participants().token());
          s.hear<wire::Advance>();
          spoil(s);
        },
        [&] {
          try {
            participants().connect("fluid", {}).advance({0.5, 0.25}, {});
          } catch (const Error& e) {
            error = e;
          }
        });
    if (!error) {
      ADD_FAILURE() << "no error";
      return {ExitCode::done, "", ""};
    }
    expect_stored("faults.txt", this_test(), without_chance(said_ + to_text(*error)));
    return *error;
  }

  Participants::Options options_;
  std::string said_;
  std::unique_ptr<Participants> participants_;
  std::atomic<bool> over_{false};
};

}  // namespace strake
