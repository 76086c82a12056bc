#include "structure/particle/lattice.hpp"

#include <algorithm>
#include <cmath>

namespace strake::structure {

Lattice make_lattice(const Plate& plate, double spacing, double radius, ClampColumn clamp) {
  const int span = static_cast<int>(std::lround(plate.length / spacing));
  const int beyond =
      std::max(2, static_cast<int>(std::floor(radius)));  // two at least, else the reach of a bond
  Lattice lattice;
  lattice.spacing = spacing;
  lattice.layers = static_cast<int>(std::lround(plate.thickness / spacing));
  lattice.outside_left = plate.left == Support::clamped ? beyond : 0;
  lattice.outside_right = plate.right == Support::clamped ? beyond : 0;
  lattice.columns = span + lattice.outside_left + lattice.outside_right;

  const Eigen::Index n = static_cast<Eigen::Index>(lattice.columns) * lattice.layers;
  lattice.position.resize(2, n);
  lattice.fixed.assign(static_cast<std::size_t>(n), 0);
  lattice.inside.assign(static_cast<std::size_t>(n), 1);
  const int held = clamp == ClampColumn::inside ? 1 : 0;  // columns inside the span that are fixed
  const double left = plate.bottom.x() - 0.5 * plate.length;
  for (int c = 0; c < lattice.columns; ++c) {
    const int in_span = c - lattice.outside_left;
    const bool fixed = (plate.left == Support::clamped && in_span < held) ||
                       (plate.right == Support::clamped && in_span >= span - held);
    for (int l = 0; l < lattice.layers; ++l) {
      const Eigen::Index i = lattice.index(c, l);
      lattice.position.col(i) << left + (in_span + 0.5) * spacing, plate.bottom.y() + (l + 0.5) * spacing;
      lattice.fixed[static_cast<std::size_t>(i)] = fixed;
      lattice.inside[static_cast<std::size_t>(i)] = in_span >= 0 && in_span < span;
    }
  }
  return lattice;
}

Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation(const Lattice& lattice, const Points& at) {
  const Eigen::Vector2d origin = lattice.position.col(0);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index p = 0; p < at.cols(); ++p) {
    const auto cell = [&](double coordinate, int count) {
      const double s = coordinate / lattice.spacing;
      const int c = std::clamp(static_cast<int>(std::floor(s)), 0, count - 2);
      return std::pair{c, s - c};
    };
    const auto [column, s] = cell(at(0, p) - origin.x(), lattice.columns);
    const auto [layer, r] = cell(at(1, p) - origin.y(), lattice.layers);
    const auto add = [&, c = column, l = layer](int dc, int dl, double weight) {
      if (weight != 0)
        entries.emplace_back(static_cast<int>(p), static_cast<int>(lattice.index(c + dc, l + dl)), weight);
    };
    add(0, 0, (1 - s) * (1 - r));
    add(1, 0, s * (1 - r));
    add(0, 1, (1 - s) * r);
    add(1, 1, s * r);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> N(at.cols(), lattice.size());
  N.setFromTriplets(entries.begin(), entries.end());
  return N;
}

}  // namespace strake::structure
