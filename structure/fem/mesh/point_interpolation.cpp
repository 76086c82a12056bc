#include "structure/fem/mesh/point_interpolation.hpp"

#include <cassert>
#include <vector>

namespace strake::structure::fem {

template <int dim>
PointInterpolation<dim>::PointInterpolation(const Discretisation<dim>& discretisation, const Points& at)
    : division_(discretisation.mesh().division), shape_(at.cols(), discretisation.mesh().n_nodes()) {
  std::vector<Eigen::Triplet<double>> entries;
  int i = 0;
  for (const auto& place : discretisation.locate(at)) {
    for (const auto& [node, weight] : place.weights) entries.emplace_back(i, node, weight);
    ++i;
  }
  shape_.setFromTriplets(entries.begin(), entries.end());
}

template <int dim>
Points PointInterpolation<dim>::at_points(const Eigen::VectorXd& unknowns) const {
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, dim, Eigen::RowMajor>> nodes(
      unknowns.data(), shape_.cols(), dim);
  Points values = Points::Zero(3, shape_.rows());
  values.template topRows<dim>() = (shape_ * nodes).transpose();
  return division_.sum(values);
}

template <int dim>
Eigen::VectorXd PointInterpolation<dim>::to_unknowns(const Points& force) const {
  assert(force.cols() == shape_.rows());
  Eigen::VectorXd unknowns(dim * shape_.cols());
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, dim, Eigen::RowMajor>> nodes(unknowns.data(),
                                                                                shape_.cols(), dim);
  nodes = shape_.transpose() * force.template topRows<dim>().transpose();
  return unknowns;
}

template class PointInterpolation<2>;
template class PointInterpolation<3>;

}  // namespace strake::structure::fem
