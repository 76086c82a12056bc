#include "fluid/particles/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace strake::fluid {

using std::size_t;

std::int64_t most_cells(std::int64_t n) {
  constexpr std::int64_t per_particle = 16, few = 65536;
  return std::min<std::int64_t>(per_particle * n + few, std::numeric_limits<std::int32_t>::max());
}

template <int dim>
typename CellGrid<dim>::Extent CellGrid<dim>::extent(const Vectors<dim>& position, int direction) {
  const auto n = position.cols();
  if (n == 0) return {};
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const double* x = position.data() + direction;
#pragma omp parallel for schedule(static) reduction(min : low) reduction(max : high)
  for (Eigen::Index i = 0; i < n; ++i) {
    low = std::min(low, x[dim * i]);
    high = std::max(high, x[dim * i]);
  }
  constexpr Eigen::Index samples = 1001;
  std::vector<double> sample;
  for (Eigen::Index i = 0; i < n; i += std::max<Eigen::Index>(1, n / samples)) sample.push_back(x[dim * i]);
  std::sort(sample.begin(), sample.end());
  const size_t last = sample.size() - 1;
  return {.low = low,
          .high = high,
          .median = sample[sample.size() / 2],
          .bulk = sample[last - last / 10] - sample[last / 10]};
}

template <int dim>
void CellGrid<dim>::lay(const Vectors<dim>& position, double reach, const Periodic<dim>& periodic) {
  constexpr double enough = 1e15;  // cells along a direction, before any limit: still an exact integer
  std::array<Extent, dim> extent;
  std::array<double, dim> count, excess;  // excess: cells beside those of the bulk
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<size_t>(d);
    extent[k] = CellGrid::extent(position, d);
    seam_[k] = periodic.along(d);
    if (seam_[k]) {
      count[k] = std::min(enough, std::floor(periodic.length()[d] / reach));
      excess[k] = 1;
    } else {
      count[k] = std::floor(std::min(enough, (extent[k].high - extent[k].low) / reach)) + 1;
      excess[k] = count[k] / (extent[k].bulk / reach + 1);
    }
  }
  const auto cells = [&] {
    double all = 1;
    for (const double along : count) all *= along;
    return all;
  };
  const auto most = static_cast<double>(most_cells(position.cols()));
  while (cells() > most) {
    size_t chosen = dim;
    for (size_t k = 0; k < dim; ++k)
      if (count[k] > 1 && (chosen == dim || excess[k] > excess[chosen])) chosen = k;
    count[chosen] = std::ceil(0.5 * count[chosen]);
    excess[chosen] *= 0.5;
  }
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<size_t>(d);
    const auto& [low, high, median, bulk] = extent[k];
    count_[k] = static_cast<std::int32_t>(count[k]);
    size_[k] = seam_[k] ? periodic.length()[d] / count[k] : reach;
    const double covered = count[k] * size_[k];
    origin_[k] = seam_[k] ? low : std::clamp(median - 0.5 * covered, low, std::max(low, high - covered));
  }
}

template <int dim>
typename CellGrid<dim>::Place CellGrid<dim>::place(const double* x) const {
  Place p{};
  for (size_t d = 0; d < dim; ++d) {
    double at = (x[d] - origin_[d]) / size_[d];
    if (seam_[d]) {
      if (at < 0) at += count_[d];
      if (at >= count_[d]) at -= count_[d];
    }
    p[d] = static_cast<std::int32_t>(std::clamp(at, 0.0, static_cast<double>(count_[d] - 1)));
  }
  return p;
}

template <int dim>
Vector<dim> CellGrid<dim>::centre(const Place& p) const {
  Vector<dim> x;
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<size_t>(d);
    x[d] = origin_[k] + (p[k] + 0.5) * size_[k];
  }
  return x;
}

template class CellGrid<2>;
template class CellGrid<3>;

}  // namespace strake::fluid
