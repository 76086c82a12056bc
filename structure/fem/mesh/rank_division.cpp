#include "structure/fem/mesh/rank_division.hpp"

#include <deal.II/base/mpi.h>
#include <deal.II/base/partitioner.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <algorithm>
#include <numeric>
#include <span>

namespace strake::structure::fem {

using Eigen::Index;

Index RankDivision::own_of_parts() const {
  return entries().locally_owned_size();
}

Index RankDivision::size_of_parts() const {
  return static_cast<Index>(entries().size());
}

Eigen::MatrixXd RankDivision::sum(const Eigen::MatrixXd& own) const {
  if (alone()) return own;
  Eigen::MatrixXd total = own;
  const dealii::ArrayView<double> values(total.data(), static_cast<std::size_t>(total.size()));
  dealii::Utilities::MPI::sum<double>(dealii::ArrayView<const double>(values), MPI_COMM_WORLD, values);
  return total;
}

Eigen::VectorXd RankDivision::largest(const Eigen::VectorXd& own) const {
  if (alone()) return own;
  Eigen::VectorXd best = own;
  for (const Bytes& bytes :
       communicator().gather(std::as_bytes(std::span(own.data(), own.data() + own.size())))) {
    const auto* const value = reinterpret_cast<const double*>(bytes.data());
    if (std::lexicographical_compare(best.begin(), best.end(), value, value + own.size()))
      best = Eigen::Map<const Eigen::VectorXd>(value, own.size());
  }
  return best;
}

void RankDivision::update(Eigen::VectorXd& x) const {
  if (alone()) return;
  dealii::LinearAlgebra::distributed::Vector<double> shared(parts_->entries);
  std::copy_n(x.data(), own_of_parts(), shared.begin());
  shared.update_ghost_values();
  for (Index i = own_of_parts(); i < x.size(); ++i) x(i) = shared.local_element(static_cast<unsigned int>(i));
}

Eigen::VectorXd RankDivision::whole(const Eigen::VectorXd& x) const {
  if (alone()) return x;
  Eigen::VectorXd all = Eigen::VectorXd::Constant(size_of_parts(), nothing);
  for (Index i = 0; i < own_of_parts(); ++i) all(number(static_cast<int>(i))) = x(i);
  return sum(all);
}

Eigen::VectorXd RankDivision::part(const Eigen::VectorXd& all) const {
  if (alone()) return all;
  return all(parts_->on_one_rank);
}

Eigen::MatrixXd RankDivision::columns_on_first(const Eigen::MatrixXd& own) const {
  if (alone()) return own;
  std::vector<double> values;
  communicator().show_first(std::as_bytes(std::span(own.data(), own.data() + own.size())),
                            [&](std::span<const std::byte> of_rank) {
                              const auto* const value = reinterpret_cast<const double*>(of_rank.data());
                              values.insert(values.end(), value, value + of_rank.size() / sizeof(double));
                            });
  const Eigen::Map<const Eigen::MatrixXd> all(values.data(), own.rows(),
                                              static_cast<Index>(values.size()) / own.rows());
  std::vector<Index> order(static_cast<std::size_t>(all.cols()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, {}, [&](Index i) { return all(0, i); });
  return all(Eigen::all, order);
}

}  // namespace strake::structure::fem
