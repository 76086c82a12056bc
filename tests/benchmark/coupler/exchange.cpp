// Time per exchange: one explicit window of two solver processes through the coupler, each solver one memcpy.
// The floor has the same hops and bytes with ZeroMQ alone. Both are also measured with the coupling in the
// fluid's process, which calls the structure alone.
//   coupling_exchange [POINTS]...                 the table
//   coupling_exchange --hub POINTS WINDOWS        one row's coupler:  p50 [us], peak memory [MB]
//   coupling_exchange --floor POINTS WINDOWS      one row's floor:    p50 [us]
//   coupling_exchange --in-fluid POINTS WINDOWS, --in-fluid-floor POINTS WINDOWS
//   coupling_exchange --renumbered [POINTS]...    the fluid's points counted from the middle on: else the
//     meshes match point by point, and the mapping copies nothing; goes before the other words as well

#include "coupler/coupling/scheme.hpp"
#include "coupler/mapping/mapping.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/participant/serve.hpp"
#include "coupler/processes/remote.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>
#include <zmq.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <sys/resource.h>
#include <unistd.h>
#include <vector>

namespace {

using namespace strake;
using Clock = std::chrono::steady_clock;

bool renumbered = false;

/// n points of a wavy surface of unit size, its lattice shifted by `shift` spacings.
Points wavy_surface(Eigen::Index n, double shift) {
  const auto side = static_cast<Eigen::Index>(std::ceil(std::sqrt(static_cast<double>(n))));
  const double h = 1.0 / static_cast<double>(side);
  Points x(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double a = (static_cast<double>(i % side) + shift) * h,
                 b = (static_cast<double>(i / side) + shift) * h;
    x.col(i) << a, 0.1 * std::sin(6 * a) * std::cos(6 * b), b;
  }
  return x;
}

/// A solver that copies its answer.
class Copier final : public Participant {
 public:
  Copier(const std::string& side, Eigen::Index n) {
    const bool fluid = side == "fluid";
    mesh_.name = side;
    mesh_.position = wavy_surface(n, fluid ? 0.3 : 0);
    if (fluid && renumbered) {
      const Points in_turn = mesh_.position;
      mesh_.position << in_turn.rightCols(n - n / 2), in_turn.leftCols(n / 2);
    }
    // One vector each way, as in preCICE's figures: a structure's displacement would have its velocity beside
    // it.
    answer_ = {fluid ? "force" : "deflection", fluid ? "N" : "m", fluid, Points::Constant(3, n, 1e-3)};
    description_.initial = {answer_};
    description_.lines = {"copies"};
  }
  const InterfaceMesh& mesh() const override { return mesh_; }
  const Description& description() const override { return description_; }
  void start(const Window&, const Input&) override {}
  Advanced finish() override {
    Advanced advanced;
    advanced.output.push_back(
        {answer_.quantity, answer_.unit, answer_.conservative, Eigen::MatrixXd(answer_.value)});
    return advanced;
  }
  void rewind() override {}
  void commit(bool) override {}
  void checkpoint(const std::filesystem::path&) override {}
  void resume(const std::filesystem::path&) override {}

 private:
  InterfaceMesh mesh_;
  Description description_;
  Field answer_;
};

double p50(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

std::filesystem::path self() {
  return std::filesystem::read_symlink("/proc/self/exe");
}

template <class Exchange>
double timed(int windows, const Exchange& exchange) {
  constexpr int warm_up = 50;
  std::vector<double> microseconds;
  for (int i = 0; i < windows + warm_up; ++i) {
    const auto begin = Clock::now();
    exchange(i);
    if (i >= warm_up)
      microseconds.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
  }
  return p50(microseconds);
}

int hub(const std::string& points, int windows, bool in_fluid) {
  Participants participants({});
  for (const char* side : {"structure", "fluid"})
    if (!in_fluid || side != std::string("fluid"))
      participants.launch(side,
                          {self(),
                           {"--solver", side, "--points", points, "--renumbered", renumbered ? "1" : "0"},
                           {},
                           1,
                           {}});
  RemoteParticipant& structure = participants.connect("structure", {});
  Copier own("fluid", in_fluid ? std::stol(points) : 1);
  Participant& fluid = in_fluid ? static_cast<Participant&>(own) : participants.connect("fluid", {});
  SchemeParameters parameters;
  parameters.convergence.max_iterations = 1;
  parameters.predictor = Predictor::constant;
  Scheme scheme(fluid, structure, FieldTransfer(nearest_neighbour(structure.mesh(), fluid.mesh(), 1.0)),
                parameters);
  constexpr double dt = 1e-3;
  const double time = timed(windows, [&](int i) {
    scheme.advance({i * dt, dt});
    scheme.commit(false);
  });
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  participants.finish();
  fmt::print("{} {}\n", time, static_cast<double>(usage.ru_maxrss) / 1024);
  return 0;
}

zmq::message_t field_message(const std::vector<double>& field) {
  const auto keep = [](void*, void*) {};
  return {const_cast<double*>(field.data()), field.size() * sizeof(double), keep, nullptr};
}

int floor_solver(const std::string& endpoint, std::size_t points) {
  zmq::context_t context;
  zmq::socket_t dealer(context, zmq::socket_type::dealer);
  dealer.connect(endpoint);
  std::vector<double> field(3 * points, 1e-3), answer(3 * points);
  for (;;) {
    dealer.send(zmq::message_t(64), zmq::send_flags::sndmore);
    std::memcpy(answer.data(), field.data(), field.size() * sizeof(double));
    dealer.send(field_message(answer), zmq::send_flags::none);
    zmq::message_t part;
    do {
      if (!dealer.recv(part)) return 1;
    } while (part.more());
    if (part.size() == 0) return 0;
  }
}

int floor_hub(const std::string& points, int windows, bool in_fluid) {
  std::string folder = "/tmp/strake-floor-XXXXXX";
  if (!mkdtemp(folder.data())) return 1;
  const std::string endpoint = "ipc://" + folder + "/hub";
  zmq::context_t context;
  zmq::socket_t router(context, zmq::socket_type::router);
  router.bind(endpoint);
  std::vector<std::string> peers;
  const auto hear = [&] {
    std::vector<zmq::message_t> parts(1);
    while (router.recv(parts.back()) && parts.back().more()) parts.emplace_back();
    return parts;
  };
  const auto pass_on = [&](const std::string& peer, std::vector<zmq::message_t>& heard) {
    router.send(zmq::buffer(peer), zmq::send_flags::sndmore);
    router.send(heard[1], zmq::send_flags::sndmore);
    router.send(heard[2], zmq::send_flags::none);
  };
  std::vector<Child> children;
  std::vector<zmq::message_t> last;
  for (int i = 0; i < (in_fluid ? 1 : 2); ++i) {
    children.emplace_back(Launch{self(), {"--floor-solver", endpoint, points}, {}, 1, {}});
    last = hear();
    peers.push_back(last[0].to_string());
  }
  const std::vector<double> field(3 * std::stoul(points), 1e-3);
  std::vector<double> answer(field.size());
  const double time = timed(windows, [&](int) {
    for (const std::string& peer : peers) {
      pass_on(peer, last);
      last = hear();
    }
    if (in_fluid) std::memcpy(answer.data(), field.data(), field.size() * sizeof(double));
  });
  for (const std::string& peer : peers) {
    router.send(zmq::buffer(peer), zmq::send_flags::sndmore);
    router.send(zmq::message_t(), zmq::send_flags::none);
  }
  for (Child& child : children) child.wait(std::chrono::seconds(2));
  std::filesystem::remove_all(folder);
  fmt::print("{}\n", time);
  return 0;
}

std::vector<double> numbers(const std::string& mode, const std::string& points, int windows) {
  std::vector<std::string> words = {mode, points, std::to_string(windows)};
  if (renumbered) words.insert(words.begin(), "--renumbered");
  const Captured out = capture(self(), words, std::chrono::minutes(5));
  std::vector<double> values;
  const char* at = out.out.c_str();
  for (char* end = nullptr;; at = end) {
    const double value = std::strtod(at, &end);
    if (end == at) break;
    values.push_back(value);
  }
  if (out.exit_code != 0 || values.empty()) throw Error(ExitCode::solver_fault, mode, out.err);
  return values;
}

int table(std::vector<std::string> sizes) {
  const std::vector<std::pair<long, double>> precice = {
      {41, 138}, {1000, 186}, {10000, 920}, {100000, 14400}};
  if (sizes.empty())
    for (const auto& [n, time] : precice) sizes.push_back(std::to_string(n));
  fmt::print(
      "one exchange [us], p50 of 1000, least of three runs of each in turns; ratio: of pairs, in the "
      "middle\n");
  fmt::print("{:>8} {:>10} {:>10} {:>7} {:>10} {:>10} {:>7} {:>10} {:>12}\n", "points", "floor", "hub",
             "ratio", "floor", "in fluid", "ratio", "preCICE", "coupler MB");
  for (const std::string& n : sizes) {
    std::vector<double> ratios[2];
    double floor[2] = {HUGE_VAL, HUGE_VAL}, time[2] = {HUGE_VAL, HUGE_VAL}, memory = 0;
    for (int i = 0; i < 3; ++i)
      for (const int way : {0, 1}) {
        const double bare = numbers(way == 0 ? "--floor" : "--in-fluid-floor", n, 1000)[0];
        const auto ours = numbers(way == 0 ? "--hub" : "--in-fluid", n, 1000);
        floor[way] = std::min(floor[way], bare);
        time[way] = std::min(time[way], ours[0]);
        if (way == 0) memory = std::max(memory, ours[1]);
        ratios[way].push_back(ours[0] / bare);
      }
    std::string quoted = "-";
    for (const auto& [points, precice_time] : precice)
      if (std::to_string(points) == n) quoted = fmt::format("{:.0f}", precice_time);
    fmt::print("{:>8} {:>10.0f} {:>10.0f} {:>7.2f} {:>10.0f} {:>10.0f} {:>7.2f} {:>10} {:>12.1f}\n", n,
               floor[0], time[0], p50(ratios[0]), floor[1], time[1], p50(ratios[1]), quoted, memory);
    std::fflush(stdout);
  }
  return 0;
}

int solver(int argc, char** argv) {
  ServeOptions options;
  options.solver = "copier";
  options.version = "1";
  Eigen::Index points = 0;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i], value = argv[i + 1];
    if (key == "--connect") options.endpoint = value;
    if (key == "--name") options.name = value;
    if (key == "--points") points = std::stol(value);
    if (key == "--renumbered") renumbered = value == "1";
  }
  options.token = std::getenv("STRAKE_TOKEN");
  return serve(options, [&](const Setup&) { return std::make_unique<Copier>(options.name, points); });
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "--renumbered") {
    renumbered = true;
    words.erase(words.begin());
  }
  const std::string mode = words.empty() ? "" : words[0];
  try {
    if (mode == "--connect") return solver(argc, argv);
    const bool in_fluid = mode.starts_with("--in-fluid");
    if (mode == "--hub" || mode == "--in-fluid") return hub(words.at(1), std::stoi(words.at(2)), in_fluid);
    if (mode == "--floor" || mode == "--in-fluid-floor")
      return floor_hub(words.at(1), std::stoi(words.at(2)), in_fluid);
    if (mode == "--floor-solver") return floor_solver(words.at(1), std::stoul(words.at(2)));
    return table(words);
  } catch (const Error& e) {
    fmt::print(stderr, "{}", to_text(e));
    return static_cast<int>(e.code());
  }
}
