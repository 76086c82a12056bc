#include "structure/fem/mesh/recovery.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace strake::structure::fem {
namespace {

// Weights along one axis of the cell [0, 1]:
//   part(a, q) = |interval_q ∩ interval_a| / weight_q
// The interval of a Gauss point is as long as its weight. The interval of a node is all that is nearer to it
// than to its neighbours.
Eigen::MatrixXd nearest_along_an_axis(const Eigen::VectorXd& weight) {
  const Eigen::Index n = weight.size();  // of points, and of nodes
  Eigen::MatrixXd part(n, n);
  double begin = 0;
  for (Eigen::Index q = 0; q < n; ++q) {
    const double end = begin + weight(q);
    for (Eigen::Index a = 0; a < n; ++a) {
      const double pieces = static_cast<double>(n - 1);
      const double low = (static_cast<double>(a) - 0.5) / pieces,
                   high = (static_cast<double>(a) + 0.5) / pieces;
      part(a, q) = std::max(0.0, std::min(end, high) - std::max(begin, low)) / weight(q);
    }
    begin = end;
  }
  // The first and the last interval end with the cell, up to round-off of the weights.
  return part.array().rowwise() / part.colwise().sum().array();
}

}  // namespace

template <int dim>
Recovery<dim>::Recovery(const Mesh<dim>& mesh) : mesh_(mesh) {
  const Eigen::Index per_cell = mesh.cell.rows(), points = mesh.n_quadrature;
  // Points and nodes of a cell are lexicographic, as many of each.
  const Eigen::Index along = mesh.degree + 1;
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(along);
  for (Eigen::Index q = 0; q < points; ++q) weight(q % along) += mesh.reference_weight(q);
  const Eigen::MatrixXd part_along = nearest_along_an_axis(weight);
  nearest_ = Eigen::MatrixXd::Ones(per_cell, points);
  for (Eigen::Index a = 0; a < per_cell; ++a)
    for (Eigen::Index q = 0; q < points; ++q)
      for (Eigen::Index axis = 0, node = a, point = q; axis < dim; ++axis, node /= along, point /= along)
        nearest_(a, q) *= part_along(node % along, point % along);

  std::set<std::pair<int, int>> pairs;  // node, part: as a body of one part numbers its nodes
  const auto part = [&](int c) { return mesh.part[static_cast<std::size_t>(c)]; };
  for (int c = 0; c < mesh.n_cells(); ++c)
    for (Eigen::Index a = 0; a < per_cell; ++a) pairs.emplace(mesh.cell(a, c), part(c));
  std::map<std::pair<int, int>, int> number;
  for (const auto& pair : pairs) {
    number.emplace(pair, size());
    node_.push_back(pair.first);
    part_.push_back(pair.second);
  }
  cell_.resize(per_cell, mesh.n_cells());
  around_.resize(node_.size());
  for (int c = 0; c < mesh.n_cells(); ++c)
    for (Eigen::Index a = 0; a < per_cell; ++a) {
      cell_(a, c) = number.at({mesh.cell(a, c), part(c)});
      around_[static_cast<std::size_t>(cell_(a, c))].push_back(c);
    }
}

template <int dim>
Eigen::MatrixXd Recovery<dim>::sum_on_nodes(const Eigen::MatrixXd& at_quadrature,
                                            const Eigen::MatrixXd& to_nodes) const {
  const int points = mesh_.n_quadrature;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(at_quadrature.rows(), size());
  for (int c = 0; c < mesh_.n_cells(); ++c) {
    const Eigen::MatrixXd values = at_quadrature.middleCols(c * points, points) * to_nodes.transpose();
    for (Eigen::Index a = 0; a < cell_.rows(); ++a) sum.col(cell_(a, c)) += values.col(a);
  }
  return sum;
}

template <int dim>
Eigen::MatrixXd Recovery<dim>::on_nodes(const Eigen::MatrixXd& at_quadrature) const {
  Eigen::MatrixXd sum = sum_on_nodes(at_quadrature, mesh_.fit);
  for (int i = 0; i < size(); ++i)
    sum.col(i) /= static_cast<double>(around_[static_cast<std::size_t>(i)].size());
  return sum;
}

// Σ_cells Σ_q W_q part_aq v_q over Σ_cells Σ_q W_q part_aq, W_q the volume of a point.
template <int dim>
Eigen::MatrixXd Recovery<dim>::means_on_nodes(const Eigen::MatrixXd& at_quadrature) const {
  const Eigen::MatrixXd sum = sum_on_nodes(at_quadrature * mesh_.weight.asDiagonal(), nearest_);
  return sum.array().rowwise() / shares_of_volume().transpose().array();
}

template <int dim>
Eigen::VectorXd Recovery<dim>::shares_of_volume() const {
  return sum_on_nodes(mesh_.weight.transpose(), nearest_).transpose();
}

template <int dim>
std::vector<typename Recovery<dim>::Share> Recovery<dim>::shares(int cell, const NodeWeights& weights) const {
  std::map<int, Eigen::VectorXd> sum;
  for (const auto& [node, weight] : weights) {
    int pair = -1;
    for (Eigen::Index a = 0; a < cell_.rows(); ++a)
      if (mesh_.cell(a, cell) == node) pair = cell_(a, cell);
    const auto& around = around_[static_cast<std::size_t>(pair)];
    for (const int c : around)
      for (Eigen::Index a = 0; a < cell_.rows(); ++a) {
        if (cell_(a, c) != pair) continue;
        const Eigen::VectorXd part =
            weight / static_cast<double>(around.size()) * mesh_.fit.row(a).transpose();
        const auto found = sum.try_emplace(c, Eigen::VectorXd::Zero(mesh_.n_quadrature)).first;
        found->second += part;
      }
  }
  std::vector<Share> shares;
  for (const auto& [c, weight] : sum) shares.push_back({c, weight});
  return shares;
}

template class Recovery<2>;
template class Recovery<3>;

}  // namespace strake::structure::fem
