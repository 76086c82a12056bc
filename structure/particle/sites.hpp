#pragma once

#include "structure/particle/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace strake::structure {

/// What a lattice cell is before particles are numbered.
struct Site {
  int part = 0;
  bool fixed = false, inside = true;
  double share = 1;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // [spacing] of the particle from the cell's middle
};

/// Cells in the order of their numbers: x slowest.
struct Before {
  template <class Cell>
  bool operator()(const Cell& a, const Cell& b) const {
    return std::lexicographical_compare(a.data(), a.data() + a.size(), b.data(), b.data() + b.size());
  }
};
template <int dim>
using Sites = std::map<Eigen::Matrix<int, dim, 1>, Site, Before>;

template <int dim>
struct Placement {
  Eigen::Matrix<double, dim, 1> origin;  // [m] lower corner of cell 0
  Sites<dim> sites;
};

/// The cells of any body, by samples of its volume: see Lattice.
template <int dim>
Placement<dim> sampled(const Solid&, double spacing, Places);

/// Calls `visit` with each line of lattice cells along an axis whose middle crosses a facet. A line is given
/// as a cell of it (0 along the axis); the crossing is in spacings from the origin.
template <int dim, class Visit>
void for_each_line(const Solid& solid, int facet, int axis, const Eigen::Matrix<double, dim, 1>& origin,
                   double spacing, Visit visit) {
  constexpr double slack = 1e-6;  // [spacing] round-off of the coordinates
  using Cell = Eigen::Matrix<int, dim, 1>;
  using Place = Eigen::Matrix<double, dim, 1>;
  const auto corner = [&](Eigen::Index k) -> Place {
    return (solid.node.col(solid.facet(k, facet)).template head<dim>() - origin) / spacing;
  };
  Place low = corner(0), high = low;
  for (Eigen::Index k = 1; k < solid.facet.rows(); ++k) {
    low = low.cwiseMin(corner(k));
    high = high.cwiseMax(corner(k));
  }
  Cell first, end;
  for (int k = 0; k < dim; ++k) {  // middles at whole numbers and a half
    first[k] = static_cast<int>(std::ceil(low[k] - 0.5 - slack));
    end[k] = static_cast<int>(std::floor(high[k] - 0.5 + slack)) + 1;
  }
  first[axis] = 0;
  end[axis] = 1;
  for_each_cell<dim>(first, end, [&](const Cell& line) {
    const Place middle = line.template cast<double>().array() + 0.5;
    if constexpr (dim == 2) {
      const int across = 1 - axis;
      const Place a = corner(0), b = corner(1);
      visit(line, a[axis] + (middle[across] - a[across]) / (b[across] - a[across]) * (b[axis] - a[axis]));
    } else {
      // Two triangles: areas of the parts that the middle cuts each into, seen along the axis.
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const auto area = [&](const Place& a, const Place& b, const Place& c) {
        return (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
      };
      for (const Eigen::Index k : {1, 2}) {
        const Place a = corner(0), b = corner(k), c = corner(k + 1);
        const double whole = area(a, b, c);
        const double wa = area(middle, b, c) / whole, wb = area(a, middle, c) / whole, wc = 1 - wa - wb;
        if (!(std::min({wa, wb, wc}) >= -slack)) continue;
        visit(line, wa * a[axis] + wb * b[axis] + wc * c[axis]);
        return;
      }
    }
  });
}

}  // namespace strake::structure
