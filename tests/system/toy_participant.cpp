// A participant of three points that misbehaves on request: --fault KIND [--at WINDOW].
// STRAKE_TOY=NAME:KIND:WINDOW in the environment does the same for the participant of that name. Its
// displacement is the number of its committed windows, so that rewind and commit can be seen from outside.

#include "coupler/participant/serve.hpp"
#include "coupler/transport/sockets.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

using namespace strake;

struct Wish {
  std::string fault;
  int at = 1;  // window, counted from 1
};

/// Hears nothing until the step is over.
void sleep_like_a_solver(std::chrono::seconds step) {
  fmt::print(stderr, "step begins\n");
  const auto end = std::chrono::steady_clock::now() + step;
  while (std::chrono::steady_clock::now() < end) std::this_thread::sleep_until(end);
  fmt::print(stderr, "step ends\n");
}

/// When it happens, for whoever measures how long it takes to be noticed: seconds on the monotonic clock.
void note_fault() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  fmt::print(stderr, "[toy] [info] fault at {:.6f}\n", std::chrono::duration<double>(now).count());
}

class Toy final : public Participant {
 public:
  Toy(Wish wish, std::string name) : wish_(std::move(wish)), name_(std::move(name)) {
    mesh_.name = "toy";
    mesh_.dimension = 2;
    mesh_.position = Points::Zero(3, 3);
    mesh_.position.row(0) << 0, 1, 2;
    mesh_.faces.resize(2, 2);
    mesh_.faces << 0, 1, 1, 2;
    description_.initial = output();
    description_.lines = {"toy"};
  }
  const InterfaceMesh& mesh() const override { return mesh_; }
  const Description& description() const override { return description_; }
  void start(const Window&, const Input&) override {
    ++iteration_;
    if (wish_.fault == "slow") std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (committed_ + 1 != wish_.at) return;
    if (!wish_.fault.empty()) note_fault();
    if (wish_.fault == "deaf")
      for (int number : {SIGTERM, SIGHUP}) std::signal(number, SIG_IGN);  // as a library might
    if (wish_.fault == "sleep" || wish_.fault == "deaf") sleep_like_a_solver(std::chrono::seconds(60));
    if (wish_.fault == "nap") sleep_like_a_solver(std::chrono::seconds(3));
    if (wish_.fault == "crash") std::raise(SIGABRT);
    if (wish_.fault == "exit") std::_Exit(7);
    if (wish_.fault == "error")
      throw Error(ExitCode::solver_fault, "toy", "pressure did not converge\n500 iterations",
                  "lower fluid.scheme.cfl");
  }
  Advanced finish() override {
    Advanced a;
    a.output = output();
    a.monitor["iteration"] = iteration_;
    if (committed_ + 1 == wish_.at && wish_.fault == "nan")
      a.output[0].value.edit()(1, 2) = std::numeric_limits<double>::quiet_NaN();
    if (committed_ + 1 == wish_.at && wish_.fault == "size") a.output[0].value = Points::Zero(3, 2);
    return a;
  }
  void rewind() override { fmt::print(stderr, "rewind\n"); }
  void commit(bool write_output) override {
    ++committed_;
    iteration_ = 0;
    fmt::print(stderr, "commit {}{}\n", committed_, write_output ? " and write" : "");
  }
  int window() const { return committed_ + 1; }
  void checkpoint(const std::filesystem::path& folder) override {
    std::ofstream(folder / name_) << committed_;
  }
  void resume(const std::filesystem::path& folder) override { std::ifstream(folder / name_) >> committed_; }

 private:
  std::vector<Field> output() const {
    const bool fluid = name_ == "fluid";
    return {{fluid ? "force" : "displacement", fluid ? "N" : "m", fluid, Points::Constant(3, 3, committed_)}};
  }

  Wish wish_;
  std::string name_;
  InterfaceMesh mesh_;
  Description description_;
  int committed_ = 0, iteration_ = 0;
};

/// One that keeps no rules: it says what it wants without serve(), which would stop it.
int speak_wrongly(const ServeOptions& options, const Wish& wish) {
  ParticipantSocket line(options.endpoint);
  const auto say = [&](std::uint64_t sequence, auto what) {
    line.send(wire::encode(wire::Reply{sequence, std::move(what)}, options.name));
  };
  std::string token(options.token.size() / 2, '\0');
  sodium_hex2bin(reinterpret_cast<unsigned char*>(token.data()), token.size(), options.token.data(),
                 options.token.size(), nullptr, nullptr, nullptr);
  if (wish.fault == "token") token.assign(16, 'x');
  const std::string hash(options.case_hash.begin(), options.case_hash.end());
  if (wish.fault == "token" || wish.fault == "protocol") note_fault();
  say(0, wire::Hello{wish.fault == "protocol" ? wire::protocol + 1 : wire::protocol, options.name, token,
                     "toy", "1", hash});
  Toy toy(wish, options.name);
  for (;;) {
    const auto parts = line.receive(std::chrono::seconds(60));
    if (!parts) return 1;
    const wire::Request request = wire::decode_request(*parts);
    const auto n = request.sequence;
    if (std::holds_alternative<wire::Refused>(request.what)) return 1;
    if (std::holds_alternative<Setup>(request.what)) say(n, wire::Ready{toy.mesh(), toy.description()});
    if (const auto* checkpoint = std::get_if<wire::Checkpoint>(&request.what)) {
      if (checkpoint->before == wire::Before::commit) toy.commit(checkpoint->write_output);
      toy.checkpoint(checkpoint->folder);
      say(n, wire::Done{});
    }
    if (std::holds_alternative<wire::Stop>(request.what)) {  // two words while it ends, then the answer
      say(n, wire::Working{0.5, "writing"});
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      say(n, wire::Working{1, "writing"});
      say(n, wire::Done{});
      return 0;
    }
    const auto* advance = std::get_if<wire::Advance>(&request.what);
    if (!advance) continue;
    if (advance->before == wire::Before::commit) toy.commit(advance->write_output);
    const Advanced answer = toy.finish();
    if (toy.window() < wish.at) {
      say(n, answer);
      continue;
    }
    note_fault();
    if (wish.fault == "twice") say(n, answer), say(n, answer);
    if (wish.fault == "stale") say(n - 1, answer);
    if (wish.fault == "kind") say(n, wire::Done{});
    if (wish.fault == "garbage") {
      const std::string bytes(1000, '\xff');
      line.send({{std::as_bytes(std::span(bytes)), nullptr}});
    }
    wire::Parts parts_of = wire::encode(wire::Reply{n, answer}, options.name);
    if (wish.fault == "short") parts_of[1].bytes = parts_of[1].bytes.first(parts_of[1].bytes.size() - 8);
    const std::vector<double> numbers(9, std::numeric_limits<double>::quiet_NaN());
    if (wish.fault == "raw-nan") parts_of[1] = {std::as_bytes(std::span(numbers)), nullptr};
    if (wish.fault == "short" || wish.fault == "raw-nan") line.send(parts_of);
  }
}

bool keeps_no_rules(const std::string& fault) {
  for (const char* rude :
       {"token", "protocol", "twice", "stale", "kind", "garbage", "short", "raw-nan", "talkative"})
    if (fault == rude) return true;
  return false;
}

/// STRAKE_TOY=structure:nan:20
void read_wish(const char* text, const std::string& name, Wish& wish) {
  const std::string all = text ? text : "";
  const auto first = all.find(':'), second = all.find(':', first + 1);
  if (first == std::string::npos || second == std::string::npos || all.substr(0, first) != name) return;
  wish = {all.substr(first + 1, second - first - 1), std::stoi(all.substr(second + 1))};
}

}  // namespace

int main(int argc, char** argv) {
  ServeOptions options;
  options.solver = "toy";
  options.version = "1";
  Wish wish;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i], value = argv[i + 1];
    if (key == "--connect") options.endpoint = value;
    if (key == "--name") options.name = value;
    if (key == "--fault") wish.fault = value;
    if (key == "--at") wish.at = std::stoi(value);
    if (key == "--case-hash")
      for (std::size_t k = 0; k < options.case_hash.size(); ++k)
        options.case_hash[k] = static_cast<std::uint8_t>(std::stoi(value.substr(2 * k, 2), nullptr, 16));
  }
  const char* token = std::getenv("STRAKE_TOKEN");
  options.token = token ? token : "";
  read_wish(std::getenv("STRAKE_TOY"), options.name, wish);
  for (const char* before_hello : {"hash", "mute", "early"})
    if (wish.fault == before_hello) note_fault();
  if (wish.fault == "hash") options.case_hash[0] ^= 1;
  if (wish.fault == "mute") std::this_thread::sleep_for(std::chrono::minutes(1));
  if (wish.fault == "early") {
    fmt::print(stderr, "toy.toml:3:1: young = 0\n");
    return static_cast<int>(ExitCode::case_file);
  }
  if (keeps_no_rules(wish.fault)) return speak_wrongly(options, wish);
  return serve(options, [&](const Setup&) { return std::make_unique<Toy>(wish, options.name); });
}
