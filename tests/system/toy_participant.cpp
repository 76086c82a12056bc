// A participant of three points that misbehaves on request: --fault KIND [--at WINDOW].
// Its displacement is the number of its committed windows, so that rewind and commit can be seen from
// outside.

#include "coupler/serve.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

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

class Toy final : public Participant {
 public:
  explicit Toy(Wish wish) : wish_(std::move(wish)) {
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
    if (committed_ + 1 != wish_.at) return;
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
      a.output[0].value(1, 2) = std::numeric_limits<double>::quiet_NaN();
    if (committed_ + 1 == wish_.at && wish_.fault == "size") a.output[0].value = Points::Zero(3, 2);
    return a;
  }
  void rewind() override { fmt::print(stderr, "rewind\n"); }
  void commit(bool write_output) override {
    ++committed_;
    iteration_ = 0;
    fmt::print(stderr, "commit {}{}\n", committed_, write_output ? " and write" : "");
  }
  void checkpoint(const std::filesystem::path& folder) override {
    std::ofstream(folder / "toy") << committed_;
  }
  void resume(const std::filesystem::path& folder) override { std::ifstream(folder / "toy") >> committed_; }

 private:
  std::vector<Field> output() const {
    return {{"displacement", "m", false, Points::Constant(3, 3, committed_)}};
  }

  Wish wish_;
  InterfaceMesh mesh_;
  Description description_;
  int committed_ = 0, iteration_ = 0;
};

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
  if (wish.fault == "hash") options.case_hash[0] ^= 1;
  if (wish.fault == "mute") std::this_thread::sleep_for(std::chrono::minutes(1));
  if (wish.fault == "early") {
    fmt::print(stderr, "toy.toml:3:1: young = 0\n");
    return static_cast<int>(ExitCode::case_file);
  }
  return serve(options, [&](const Setup&) { return std::make_unique<Toy>(wish); });
}
