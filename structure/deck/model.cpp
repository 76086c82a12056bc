#include "structure/deck/model.hpp"

#include "proto/error.hpp"

#include <array>
#include <limits>

namespace strake::structure::deck {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// A node's place in its cell, 0 … degree along each axis.
using Place = std::array<int, 3>;

Place place_of(int index, int degree) {
  const int row = degree + 1;
  return {index % row, index / row % row, index / (row * row)};
}

int index_of(const Place& p, int degree) {
  const int row = degree + 1;
  return p[0] + row * (p[1] + row * p[2]);
}

int middles(const Place& p, int degree) {
  if (degree == 1) return 0;
  return (p[0] == 1) + (p[1] == 1) + (p[2] == 1);
}

/// The kept nodes of a cell in the decks' order.
std::vector<int> deck_order(int dimension, int degree) {
  const int d = degree;
  std::vector<Place> places;
  const int layers = dimension == 3 ? 2 : 1;
  for (int l = 0; l < layers; ++l)
    for (const auto& [x, y] : {std::pair{0, 0}, {d, 0}, {d, d}, {0, d}}) places.push_back({x, y, l * d});
  if (d == 2) {
    for (int l = 0; l < layers; ++l)
      for (const auto& [x, y] : {std::pair{1, 0}, {2, 1}, {1, 2}, {0, 1}}) places.push_back({x, y, l * d});
    if (dimension == 3)
      for (const auto& [x, y] : {std::pair{0, 0}, {2, 0}, {2, 2}, {0, 2}}) places.push_back({x, y, 1});
  }
  std::vector<int> order;
  for (const Place& p : places) order.push_back(index_of(p, degree));
  return order;
}

/// Values of the serendipity shape functions in the middle of a face or a cell, at the nodes around it:
///   face, square   ½ in the middles of its 4 edges, −¼ in its 4 corners
///   cell, cube     ¼ in the middles of its 12 edges, −¼ in its 8 corners
std::vector<std::pair<int, double>> share_of(const Place& middle) {
  std::vector<std::pair<int, double>> share;
  const int n_middle = middles(middle, 2);
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z) {
        const Place p = {x, y, z};
        bool around = true;  // differs from the middle along those axes only in which that is a middle
        for (std::size_t k = 0; k < 3; ++k) around = around && (middle[k] == 1 || p[k] == middle[k]);
        if (!around || middles(p, 2) > 1) continue;
        const double weight = middles(p, 2) == 0 ? -0.25 : n_middle == 2 ? 0.5 : 0.25;
        share.emplace_back(index_of(p, 2), weight);
      }
  return share;
}

/// The nodes of the new model as combinations of the old: old × new.
Weights combination(const Model& old, std::vector<int>& kept, std::vector<int>& number) {
  const int per_cell = static_cast<int>(old.cell.rows());
  number.assign(static_cast<std::size_t>(old.n_nodes()), -1);
  std::vector<bool> keep(number.size(), false);
  for (Eigen::Index c = 0; c < old.cell.cols(); ++c)
    for (int a = 0; a < per_cell; ++a)
      if (middles(place_of(a, old.degree), old.degree) < 2)
        keep[static_cast<std::size_t>(old.cell(a, c))] = true;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) {
      number[i] = static_cast<int>(kept.size());
      kept.push_back(static_cast<int>(i));
    }

  Triplets entries;
  std::vector<bool> done(keep.size(), false);
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) entries.emplace_back(static_cast<int>(i), number[i], 1.0);
  for (Eigen::Index c = 0; c < old.cell.cols(); ++c)
    for (int a = 0; a < per_cell; ++a) {
      const auto node = static_cast<std::size_t>(old.cell(a, c));
      if (keep[node] || done[node]) continue;
      done[node] = true;
      for (const auto& [b, weight] : share_of(place_of(a, 2)))
        entries.emplace_back(static_cast<int>(node), number[static_cast<std::size_t>(old.cell(b, c))],
                             weight);
    }
  Weights matrix(old.n_nodes(), static_cast<Eigen::Index>(kept.size()));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

Model with_edge_nodes(Model old) {
  std::vector<int> kept, number;
  const Weights from_old = combination(old, kept, number);
  Model model = old;

  model.node.resize(3, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i)
    model.node.col(static_cast<Eigen::Index>(i)) = old.node.col(kept[i]);
  const std::vector<int> order = deck_order(old.dimension, old.degree);
  model.cell.resize(static_cast<Eigen::Index>(order.size()), old.cell.cols());
  for (Eigen::Index c = 0; c < old.cell.cols(); ++c)
    for (std::size_t a = 0; a < order.size(); ++a)
      model.cell(static_cast<Eigen::Index>(a), c) = number[static_cast<std::size_t>(old.cell(order[a], c))];

  model.fixed.clear();
  for (const int unknown : old.fixed) {
    const int node = number[static_cast<std::size_t>(unknown / old.dimension)];
    if (node >= 0) model.fixed.push_back(old.dimension * node + unknown % old.dimension);
  }
  model.interface = old.interface * from_old;
  model.probe_weights = old.probe_weights * from_old;
  if (old.node_mass.size() > 0) model.node_mass = from_old.transpose() * old.node_mass;
  model.own_load = Eigen::VectorXd::Zero(model.dimension * model.node.cols());
  for (Eigen::Index row = 0; row < from_old.outerSize(); ++row)
    for (Weights::InnerIterator it(from_old, row); it; ++it)
      model.own_load.segment(old.dimension * it.col(), old.dimension) +=
          it.value() * old.own_load.segment(old.dimension * it.row(), old.dimension);
  return model;
}

std::set<int> nodes_of(const Weights& weights) {
  return {weights.innerIndexPtr(), weights.innerIndexPtr() + weights.nonZeros()};
}

double shortest_edge(const Model& m) {
  double shortest = std::numeric_limits<double>::infinity();
  for (Eigen::Index c = 0; c < m.cell.cols(); ++c)
    for (int a = 0; a < (m.dimension == 2 ? 4 : 8); ++a)
      for (int b = 0; b < a; ++b)
        shortest = std::min(shortest, (m.node.col(m.cell(a, c)) - m.node.col(m.cell(b, c))).norm());
  return shortest;
}

void require_plain_materials(const Model& m) {
  for (const Part& part : m.parts) {
    if (part.material.model == MaterialModel::neo_hookean)
      throw Error(ExitCode::case_file, "structure, part \"" + part.name + "\"",
                  "the neo-Hookean energy of this case has no counterpart in the other program",
                  "structure.material.model = \"saint_venant_kirchhoff\"");
    if ((part.material.model == MaterialModel::linear) !=
        (m.parts.front().material.model == MaterialModel::linear))
      throw Error(ExitCode::case_file, "structure, part \"" + part.name + "\"",
                  "linear and nonlinear parts in one body: the other programs know one kinematics for all",
                  "the same structure.material.model in every part");
  }
}

}  // namespace strake::structure::deck
