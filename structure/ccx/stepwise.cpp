#include "structure/ccx/stepwise.hpp"

#include "proto/error.hpp"
#include "structure/body/surface.hpp"

#include <cstring>
#include <utility>

namespace strake::structure::ccx {
namespace {

/// Stores a text in an archive, which takes numbers only: its length, then its bytes, eight to each number.
std::vector<std::int64_t> as_numbers(const std::string& bytes) {
  std::vector<std::int64_t> numbers(1 + (bytes.size() + 7) / 8, 0);
  numbers[0] = static_cast<std::int64_t>(bytes.size());
  std::memcpy(numbers.data() + 1, bytes.data(), bytes.size());
  return numbers;
}

std::string as_bytes(const std::vector<std::int64_t>& numbers) {
  std::string bytes(static_cast<std::size_t>(numbers.at(0)), '\0');
  if (bytes.size() > 8 * (numbers.size() - 1)) return {};
  std::memcpy(bytes.data(), numbers.data() + 1, bytes.size());
  return bytes;
}

}  // namespace

Stepwise::Stepwise(const Parameters& p, deck::Model model) : CalculixSolver(p, std::move(model)) {
  state_.now = at_rest();
  saved_ = state_;
}

void Stepwise::begin_at(Now found) {
  state_ = State{};
  state_.now = std::move(found);
  saved_ = state_;
}

void Stepwise::advance(double t, double dt, const Load& load) {
  const std::string when = at_time(t + dt);
  deck::WindowLoad window = load_of({.t = t, .dt = dt}, load.mean(t, t + dt, interface().position.cols()));
  window.windows_before = state_.steps;

  runner_.run(deck::calculix_window(model_, wanted_, window),
              state_.restart ? *state_.restart : std::string(), 1, when);
  std::vector<Printed> printed = read_printed(runner_.file("dat"), wanted_.node, model_.n_nodes());
  std::vector<BodyField> fields = read_fields(runner_.file("frd"), model_.n_nodes());
  if (printed.size() != 1 || fields.empty())
    runner_.fail(when, "ended well and printed nothing of the window");

  State next;
  next.now = {.time = t + dt,
              .displacement = std::move(printed.front().displacement),
              .velocity = std::move(printed.front().velocity),
              .body = std::move(fields.back())};
  next.restart = std::make_shared<const std::string>(runner_.content("rout", when));
  next.printed_strain = printed.front().strain;
  next.strain = (next.printed_strain - state_.printed_strain) / thickness_;
  next.kinetic = printed.front().kinetic / thickness_;
  next.steps = state_.steps + 1;
  // Loads and gravity work on the way, and the supports give the momentum that their frame hides, V·Δp.
  const Points way = next.now.displacement - state_.now.displacement;
  const Eigen::Map<const Eigen::MatrixXd> force(window.force.data(), model_.dimension, model_.n_nodes());
  next.external = state_.external + force.cwiseProduct(way.topRows(model_.dimension)).sum() +
                  window.gravity * model_.gravity.dot(way * model_.node_mass) +
                  model_.support_velocity.dot(momentum(next.now) - momentum(state_.now));
  state_ = std::move(next);
}

Eigen::Vector3d Stepwise::momentum(const Now& at) const {
  return at.velocity * model_.node_mass;
}

Energy Stepwise::energy() const {
  const Eigen::Vector3d& v = model_.support_velocity;
  return {.kinetic =
              state_.kinetic + v.dot(momentum(state_.now)) + 0.5 * model_.node_mass.sum() * v.squaredNorm(),
          .strain = state_.strain,
          .external = state_.external};
}

void Stepwise::write(Archive& archive) const {
  archive.real["ccx.displacement"] = saved_.now.displacement;
  archive.real["ccx.velocity"] = saved_.now.velocity;
  archive.real["ccx.body.displacement"] = saved_.now.body.displacement;
  archive.real["ccx.body.velocity"] = saved_.now.body.velocity;
  archive.real["ccx.body.von_mises"] = saved_.now.body.von_mises;
  archive.real["ccx.scalars"] = Eigen::Matrix<double, 5, 1>(saved_.now.time, saved_.strain, saved_.kinetic,
                                                            saved_.external, saved_.printed_strain);
  archive.integer["ccx.steps"] = {saved_.steps};
  archive.integer["ccx.restart"] = as_numbers(saved_.restart ? *saved_.restart : std::string());
}

void Stepwise::read(const Archive& archive) {
  const auto real = [&](const std::string& name, Eigen::Index rows, Eigen::Index columns) {
    const auto found = archive.real.find(name);
    if (found == archive.real.end() || found->second.rows() != rows || found->second.cols() != columns)
      throw Error(ExitCode::case_file, "structure checkpoint", name + " is missing or of another mesh",
                  "resume with the structure.plate and structure.fem keys of the run that wrote it");
    return found->second;
  };
  const auto k = static_cast<Eigen::Index>(wanted_.node.size());
  const Eigen::Index n = model_.n_nodes();
  State read;
  read.now.displacement = real("ccx.displacement", 3, k);
  read.now.velocity = real("ccx.velocity", 3, k);
  read.now.body = {.time = 0,
                   .displacement = real("ccx.body.displacement", 3, n),
                   .velocity = real("ccx.body.velocity", 3, n),
                   .von_mises = real("ccx.body.von_mises", n, 1)};
  const Eigen::MatrixXd scalars = real("ccx.scalars", 5, 1);
  read.now.time = scalars(0);
  read.strain = scalars(1);
  read.kinetic = scalars(2);
  read.external = scalars(3);
  read.printed_strain = scalars(4);
  read.steps = static_cast<int>(archive.integer.at("ccx.steps").at(0));
  if (std::string bytes = as_bytes(archive.integer.at("ccx.restart")); !bytes.empty())
    read.restart = std::make_shared<const std::string>(std::move(bytes));
  state_ = std::move(read);
  saved_ = state_;
}

std::vector<std::string> Stepwise::lines() const {
  if (parameters_.analysis != Analysis::dynamic) return {headline()};
  return {headline(),
          "Newmark 1/4-1/2 with the mean load of a window; one call per window, each from the last one's "
          "restart file"};
}

}  // namespace strake::structure::ccx
