#include "coupler/accelerator.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "coupler/aitken.hpp"
#include "coupler/iqn_ils.hpp"
#include "proto/error.hpp"

namespace strake {
namespace {

void refuse_non_finite(const Eigen::VectorXd& values, const char* what, int iteration) {
  if (values.allFinite()) return;
  Eigen::Index first = 0;
  while (std::isfinite(values[first])) ++first;
  throw Error(
      ExitCode::solver_fault, fmt::format("coupling, iteration {}", iteration),
      fmt::format("{} is not finite: value {} of {} is {}", what, first, values.size(), values[first]),
      "see the log of the solver that sent it; a smaller coupling window may help");
}

/// x + ω (H(x) − x)
class Constant : public Accelerator {
 public:
  explicit Constant(double relaxation) : relaxation_(relaxation) {}

 protected:
  Eigen::VectorXd iterate(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) override {
    state_.relaxation = step_.relaxation = relaxation_;
    return x + relaxation_ * (hx - x);
  }

 private:
  double relaxation_;
};

}  // namespace

void Accelerator::learn(const Eigen::VectorXd&, const Eigen::VectorXd&) {}

void Accelerator::observe(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) {
  assert(x.size() == hx.size());
  step_ = {};
  ++state_.iteration;
  refuse_non_finite(x, "the interface motion sent to the fluid", state_.iteration);
  refuse_non_finite(hx, "the interface motion returned by the structure", state_.iteration);
  learn(hx - x, hx);
  state_.previous_residual = hx - x;
  state_.previous_image = hx;
}

Eigen::VectorXd Accelerator::next(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) {
  observe(x, hx);
  Eigen::VectorXd result = iterate(x, hx);
  refuse_non_finite(result, "the accelerated interface motion", state_.iteration);
  return result;
}

void Accelerator::finish_window(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) {
  observe(x, hx);
}

void Accelerator::start_window() {
  state_.iteration = 0;
  state_.previous_residual.resize(0);
  state_.previous_image.resize(0);
}

std::unique_ptr<Accelerator> make_accelerator(const AcceleratorParameters& p) {
  if (p.kind == "constant") return std::make_unique<Constant>(p.initial_relaxation);
  if (p.kind == "aitken") return std::make_unique<Aitken>(p.initial_relaxation);
  if (p.kind == "iqn-ils") return std::make_unique<IqnIls>(p.initial_relaxation, p.reused_windows, p.filter);
  throw Error(ExitCode::case_file, "coupling.surface.accelerator.kind",
              fmt::format("\"{}\" is not an accelerator", p.kind), "iqn-ils, aitken or constant");
}

void AcceleratorState::save(Archive& archive) const {
  archive.integer["accelerator.iteration"] = {iteration, static_cast<std::int64_t>(windows.size())};
  archive.real["accelerator.relaxation"] = Eigen::MatrixXd::Constant(1, 1, relaxation);
  const auto put = [&](const std::string& name, const Eigen::MatrixXd& value) {
    if (value.size() > 0) archive.real["accelerator." + name] = value;
  };
  put("previous_residual", previous_residual);
  put("previous_image", previous_image);
  for (std::size_t w = 0; w < windows.size(); ++w) {
    put(fmt::format("residual{}", w), windows[w].residual);
    put(fmt::format("image{}", w), windows[w].image);
  }
}

void AcceleratorState::load(const Archive& archive) {
  *this = {};
  const auto counts = archive.integer.find("accelerator.iteration");
  const auto omega = archive.real.find("accelerator.relaxation");
  if (counts == archive.integer.end() || counts->second.size() != 2 || counts->second[1] < 0 ||
      omega == archive.real.end() || omega->second.size() != 1)
    throw Error(ExitCode::case_file, "checkpoint, coupler.h5", "the accelerator's state is missing",
                "resume from the other checkpoint");
  const auto get = [&](const std::string& name) {
    const auto found = archive.real.find("accelerator." + name);
    return found == archive.real.end() ? Eigen::MatrixXd() : found->second;
  };
  iteration = static_cast<int>(counts->second[0]);
  relaxation = omega->second(0, 0);
  const auto vector = [](const Eigen::MatrixXd& m) -> Eigen::VectorXd { return m.reshaped(); };
  previous_residual = vector(get("previous_residual"));
  previous_image = vector(get("previous_image"));
  for (std::int64_t w = 0; w < counts->second[1]; ++w)
    windows.push_back({get(fmt::format("residual{}", w)), get(fmt::format("image{}", w))});
}

}  // namespace strake
