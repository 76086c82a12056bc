#include "coupler/acceleration/accelerator.hpp"

#include "coupler/acceleration/aitken.hpp"
#include "coupler/acceleration/quasi_newton.hpp"
#include "proto/error.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <numeric>
#include <string_view>

namespace strake {
namespace {

/// `what`: a sentence's subject with {} for the name of the field.
void refuse_non_finite(const Eigen::VectorXd& values, const std::vector<AcceleratorBlock>& blocks,
                       std::string_view what, int iteration) {
  if (values.allFinite()) return;
  Eigen::Index first = 0;
  while (std::isfinite(values[first])) ++first;
  const double value = values[first];
  std::string name = "interface motion";
  Eigen::Index size = values.size();
  for (const AcceleratorBlock& block : blocks) {
    name = block.name;
    size = block.size;
    if (first < block.size) break;
    first -= block.size;
  }
  throw Error(ExitCode::solver_fault, fmt::format("coupling, iteration {}", iteration),
              fmt::format("{} is not finite: value {} of {} is {}", fmt::format(fmt::runtime(what), name),
                          first, size, value),
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

void Accelerator::set_blocks(std::vector<AcceleratorBlock> blocks) {
  blocks_ = std::move(blocks);
}

void Accelerator::learn(const Eigen::VectorXd&, const Eigen::VectorXd&) {}

void Accelerator::observe(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) {
  assert(x.size() == hx.size());
  assert(blocks_.empty() || std::accumulate(blocks_.begin(), blocks_.end(), Eigen::Index{0},
                                            [](Eigen::Index sum, const AcceleratorBlock& block) {
                                              return sum + block.size;
                                            }) == x.size());
  step_ = {};
  ++state_.iteration;
  refuse_non_finite(x, blocks_, "the {} that was sent", state_.iteration);
  refuse_non_finite(hx, blocks_, "the {} that came back", state_.iteration);
  learn(hx - x, hx);
  state_.previous_residual = hx - x;
  state_.previous_image = hx;
}

Eigen::VectorXd Accelerator::next(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) {
  observe(x, hx);
  Eigen::VectorXd result = iterate(x, hx);
  refuse_non_finite(result, blocks_, "the accelerated {}", state_.iteration);
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
  if (p.kind == "iqn-ils") return std::make_unique<IqnIls>(p);
  if (p.kind == "iqn-imvj") return std::make_unique<IqnImvj>(p);
  throw Error(ExitCode::case_file, "coupling.surface.accelerator.kind",
              fmt::format("\"{}\" is not an accelerator", p.kind), "iqn-ils, iqn-imvj, aitken or constant");
}

void AcceleratorState::save(Archive& archive) const {
  archive.integer["accelerator.iteration"] = {iteration};
  archive.integer["accelerator.careful"] = {careful};
  archive.real["accelerator.steepest"] = Eigen::RowVector4d(steepest, steepest_before, first, unexplained);
  archive.real["accelerator.relaxation"] = Eigen::MatrixXd::Constant(1, 1, relaxation);
  const auto put = [&](const std::string& name, const Eigen::MatrixXd& value) {
    if (value.size() > 0) archive.real["accelerator." + name] = value;
  };
  put("previous_residual", previous_residual);
  put("previous_image", previous_image);
  put("residual_sum", residual_sum);
  secants.save(archive, "accelerator.secants");
  jacobian.save(archive, "accelerator.jacobian");
}

void AcceleratorState::load(const Archive& archive) {
  *this = {};
  const auto counts = archive.integer.find("accelerator.iteration");
  const auto omega = archive.real.find("accelerator.relaxation");
  if (counts == archive.integer.end() || counts->second.size() != 1 || omega == archive.real.end() ||
      omega->second.size() != 1)
    throw Error(ExitCode::case_file, "checkpoint, coupler.h5", "the accelerator's state is missing",
                "resume from the other checkpoint");
  const auto get = [&](const std::string& name) { return at_or(archive.real, "accelerator." + name); };
  iteration = static_cast<int>(counts->second[0]);
  if (const auto left = archive.integer.find("accelerator.careful");
      left != archive.integer.end() && left->second.size() == 1)
    careful = static_cast<int>(left->second[0]);
  if (const auto slopes = archive.real.find("accelerator.steepest");
      slopes != archive.real.end() && slopes->second.size() == 4) {
    steepest = slopes->second(0, 0);
    steepest_before = slopes->second(0, 1);
    first = slopes->second(0, 2);
    unexplained = slopes->second(0, 3);
  }
  relaxation = omega->second(0, 0);
  const auto vector = [](const Eigen::MatrixXd& m) -> Eigen::VectorXd { return m.reshaped(); };
  previous_residual = vector(get("previous_residual"));
  previous_image = vector(get("previous_image"));
  residual_sum = vector(get("residual_sum"));
  secants.load(archive, "accelerator.secants");
  jacobian.load(archive, "accelerator.jacobian");
}

}  // namespace strake
