#include "coupler/acceleration/secants.hpp"

#include "proto/error.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd LeastSquares::alpha(const VectorXd& g) const {
  const VectorXd right = -(u.transpose() * g);
  return r.triangularView<Eigen::Upper>().solve(right).cwiseQuotient(length);
}

void Secants::append(const std::vector<Index>& sizes, const VectorXd& residual_change, VectorXd image_change,
                     int most) {
  residual.resize(sizes.size());
  drop_oldest(columns() + 1 - std::max(1, most));
  if (own == 0) windows.push_back(0);
  Index begin = 0;
  for (std::size_t b = 0; b < sizes.size(); begin += sizes[b++])
    residual[b].append(residual_change.segment(begin, sizes[b]));
  image.push_back(std::make_shared<const VectorXd>(std::move(image_change)));
  ++windows.back();
  ++own;
}

void Secants::start_window(int keep) {
  own = 0;
  Index old = 0;
  for (std::size_t w = 0; w + static_cast<std::size_t>(std::max(keep, 0)) < windows.size(); ++w)
    old += windows[w];
  drop_oldest(old);
}

void Secants::drop_oldest(Index n) {
  if (n <= 0) return;
  image.erase(image.begin(), image.begin() + n);
  for (OrthonormalBasis& block : residual) {
    block.drop_oldest(n);
    block.compress();
  }
  while (n > 0) {
    const Index from_window = std::min(n, windows.front());
    windows.front() -= from_window;
    n -= from_window;
    if (windows.front() == 0) windows.erase(windows.begin());
  }
  own = std::min(own, columns());
}

VectorXd Secants::project(const std::vector<Index>& sizes, const VectorXd& weights, const VectorXd& r) const {
  Index rows = 0, begin = 0, row = 0;
  for (const OrthonormalBasis& block : residual) rows += block.coordinates.rows();
  VectorXd g(rows);
  for (std::size_t b = 0; b < residual.size(); begin += sizes[b++]) {
    const Index n = residual[b].coordinates.rows();
    g.segment(row, n) =
        weights[static_cast<Index>(b)] * transposed_times(residual[b].basis, r.segment(begin, sizes[b]));
    row += n;
  }
  return g;
}

// Gram–Schmidt on the small columns, each done twice.
LeastSquares Secants::factorise(const VectorXd& weights, const SecantFilter& filter) const {
  Index rows = 0, row = 0;
  for (const OrthonormalBasis& block : residual) rows += block.coordinates.rows();
  MatrixXd stacked(rows, columns());
  for (std::size_t b = 0; b < residual.size(); ++b) {
    const Index n = residual[b].coordinates.rows();
    stacked.middleRows(row, n) = weights[static_cast<Index>(b)] * residual[b].coordinates;
    row += n;
  }
  const Index most = std::min(rows, columns());
  LeastSquares result = {{}, MatrixXd(rows, most), MatrixXd::Zero(most, most), VectorXd(most)};
  Index k = 0;
  double triangle = 0;  // |R|² of the columns taken, unscaled
  for (Index c = columns() - 1; c >= 0 && k < most; --c) {
    const double length = stacked.col(c).norm();
    if (length == 0) continue;
    VectorXd direction = stacked.col(c) / length, projection = VectorXd::Zero(k);
    for (int pass = 0; pass < 2; ++pass) {
      const VectorXd part = result.u.leftCols(k).transpose() * direction;
      direction -= result.u.leftCols(k) * part;
      projection += part;
    }
    const double fresh = direction.norm();
    const double limit = c >= columns() - own ? filter.own_limit : filter.limit;
    const double beside =
        filter.kind == SecantFilter::Kind::qr2 ? 1 : std::sqrt(triangle + length * length) / length;
    if (fresh <= limit * beside) continue;
    triangle += length * length;
    result.r.col(k).head(k) = projection;
    result.r(k, k) = fresh;
    result.u.col(k) = direction / fresh;
    result.length[k] = length;
    result.kept.push_back(c);
    ++k;
  }
  result.u.conservativeResize(rows, k);
  result.r.conservativeResize(k, k);
  result.length.conservativeResize(k);
  return result;
}

void Secants::add_residuals(const LeastSquares& problem, const VectorXd& alpha,
                            const std::vector<Index>& sizes, VectorXd& r) const {
  Index begin = 0;
  for (std::size_t b = 0; b < residual.size(); begin += sizes[b++]) {
    VectorXd part = VectorXd::Zero(residual[b].coordinates.rows());
    for (std::size_t k = 0; k < problem.kept.size(); ++k)
      part += alpha[static_cast<Index>(k)] * residual[b].coordinates.col(problem.kept[k]);
    add_times(residual[b].basis, part, r.segment(begin, sizes[b]));
  }
}

SharedColumns Secants::images(const LeastSquares& problem) const {
  SharedColumns images;
  for (const Index c : problem.kept) images.push_back(image[static_cast<std::size_t>(c)]);
  return images;
}

// α = −diag(length)⁻¹ R⁻¹ Uᵀ g with g_b = w_b Q_bᵀ r_b, so (ΔR⁺)ᵀ is w_b Q_b U_b R⁻ᵀ diag(length)⁻¹ in block
// b.
SharedColumns Secants::pseudo_inverse(const LeastSquares& problem, const std::vector<Index>& sizes,
                                      const VectorXd& weights) const {
  const MatrixXd small = problem.r.triangularView<Eigen::Upper>()
                             .solve<Eigen::OnTheLeft>(MatrixXd(problem.u.transpose()))
                             .transpose() *
                         problem.length.cwiseInverse().asDiagonal();
  Index whole = 0, begin = 0, row = 0;
  for (const Index size : sizes) whole += size;
  std::vector<VectorXd> stacked(problem.kept.size(), VectorXd::Zero(whole));
  for (std::size_t b = 0; b < residual.size(); begin += sizes[b++]) {
    const Index n = residual[b].coordinates.rows();
    const SharedColumns part =
        combine(residual[b].basis, weights[static_cast<Index>(b)] * small.middleRows(row, n));
    for (std::size_t j = 0; j < part.size(); ++j) stacked[j].segment(begin, sizes[b]) = *part[j];
    row += n;
  }
  SharedColumns columns;
  for (VectorXd& column : stacked) columns.push_back(std::make_shared<const VectorXd>(std::move(column)));
  return columns;
}

void Secants::save(Archive& archive, const std::string& name) const {
  archive.integer[name + ".windows"] = {windows.begin(), windows.end()};
  archive.integer[name + ".counts"] = {static_cast<std::int64_t>(residual.size()), own};
  const auto put = [&](const std::string& what, const MatrixXd& value) {
    if (value.size() > 0) archive.real[name + what] = value;
  };
  put(".image", to_matrix(image));
  for (std::size_t b = 0; b < residual.size(); ++b) {
    put(fmt::format(".basis{}", b), to_matrix(residual[b].basis));
    put(fmt::format(".coordinates{}", b), residual[b].coordinates);
  }
}

void Secants::load(const Archive& archive, const std::string& name) {
  *this = {};
  const auto get = [&](const std::string& what) { return at_or(archive.real, name + what); };
  const auto counts = archive.integer.find(name + ".windows"), sizes = archive.integer.find(name + ".counts");
  if (counts == archive.integer.end() || sizes == archive.integer.end() || sizes->second.size() != 2)
    throw Error(ExitCode::case_file, "checkpoint, coupler.h5", fmt::format("{} is missing", name),
                "resume from the other checkpoint");
  windows.assign(counts->second.begin(), counts->second.end());
  own = sizes->second[1];
  image = to_columns(get(".image"));
  for (std::int64_t b = 0; b < sizes->second[0]; ++b)
    residual.push_back({to_columns(get(fmt::format(".basis{}", b))), get(fmt::format(".coordinates{}", b))});
  // A block that has not moved has columns without a direction.
  for (OrthonormalBasis& block : residual)
    if (block.coordinates.size() == 0) block.coordinates.resize(0, columns());
}

}  // namespace strake
