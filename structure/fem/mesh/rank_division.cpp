#include "structure/fem/mesh/mesh.hpp"
#include "structure/fem/mesh/rank_division_parts.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <span>
#include <vector>

namespace strake::structure::fem {

using Eigen::Index;

Communicator& RankDivision::communicator() const {
  return parts_->communicator;
}

int RankDivision::number(int entry) const {
  return alone() ? entry : parts_->on_one_rank[static_cast<std::size_t>(entry)];
}

Index RankDivision::own_of_parts() const {
  return parts_->entries->locally_owned_size();
}

Index RankDivision::size_of_parts() const {
  return static_cast<Index>(parts_->entries->size());
}

Eigen::MatrixXd RankDivision::sum(const Eigen::MatrixXd& own) const {
  if (alone()) return own;
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(own.rows(), own.cols());
  const std::span<const double> values(own.data(), static_cast<std::size_t>(own.size()));
  for (const Bytes& bytes : communicator().gather(std::as_bytes(values)))
    total += Eigen::Map<const Eigen::MatrixXd>(reinterpret_cast<const double*>(bytes.data()), own.rows(),
                                               own.cols());
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
  const auto& exchange = *parts_->entries;
  std::vector<double> sent(exchange.n_import_indices());
  std::vector<MPI_Request> requests;
  const dealii::ArrayView<double> ghosts(x.data() + own_of_parts(), exchange.n_ghost_indices());
  exchange.export_to_ghosted_array_start<double>(
      0, dealii::ArrayView<const double>(x.data(), exchange.locally_owned_size()),
      dealii::ArrayView<double>(sent.data(), sent.size()), ghosts, requests);
  exchange.export_to_ghosted_array_finish<double>(ghosts, requests);
}

Eigen::VectorXd RankDivision::whole(const Eigen::VectorXd& x) const {
  if (alone()) return x;
  const auto own = static_cast<std::size_t>(own_of_parts());
  const std::vector<Bytes> places =
      communicator().gather(std::as_bytes(std::span(parts_->on_one_rank.data(), own)));
  const std::vector<Bytes> values = communicator().gather(std::as_bytes(std::span(x.data(), own)));
  Eigen::VectorXd all(size_of_parts());
  for (std::size_t r = 0; r < values.size(); ++r) {
    const auto* const place = reinterpret_cast<const int*>(places[r].data());
    const auto* const value = reinterpret_cast<const double*>(values[r].data());
    for (std::size_t i = 0; i < values[r].size() / sizeof(double); ++i) all(place[i]) = value[i];
  }
  return all;
}

Eigen::VectorXd RankDivision::part(const Eigen::VectorXd& all) const {
  if (alone()) return all;
  return all(parts_->on_one_rank);
}

std::vector<Bytes> RankDivision::on_first(std::span<const std::byte> own) const {
  const std::vector<std::size_t> sizes = communicator().all(own.size());
  std::vector<Bytes> to(sizes.size()), from(sizes.size());
  if (!first()) to[0].assign(own.begin(), own.end());
  for (std::size_t r = 1; first() && r < sizes.size(); ++r) from[r].resize(sizes[r]);
  communicator().exchange(to, from);
  if (first()) from[0].assign(own.begin(), own.end());
  return from;
}

Eigen::MatrixXd RankDivision::columns_on_first(const Eigen::MatrixXd& own) const {
  if (alone()) return own;
  std::vector<double> values;
  for (const Bytes& bytes : on_first(std::as_bytes(std::span(own.data(), own.data() + own.size()))))
    std::ranges::copy(values_of<double>(bytes), std::back_inserter(values));
  const Eigen::Map<const Eigen::MatrixXd> all(values.data(), own.rows(),
                                              static_cast<Index>(values.size()) / own.rows());
  std::vector<Index> order(static_cast<std::size_t>(all.cols()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, {}, [&](Index i) { return all(0, i); });
  return all(Eigen::all, order);
}

template <int dim>
Eigen::VectorXd Mesh<dim>::from_owners(const Eigen::VectorXd& of_cells) const {
  Eigen::VectorXd values(of_cells.size());
  values(cell_place) = of_cells;
  cell_division.update(values);
  return values(cell_place);
}

template <int dim>
Eigen::VectorXd Mesh<dim>::whole(const Eigen::VectorXd& of_cells) const {
  Eigen::VectorXd values(of_cells.size());
  values(cell_place) = of_cells;
  return cell_division.whole(values);
}

template Eigen::VectorXd Mesh<2>::from_owners(const Eigen::VectorXd&) const;
template Eigen::VectorXd Mesh<2>::whole(const Eigen::VectorXd&) const;
template Eigen::VectorXd Mesh<3>::from_owners(const Eigen::VectorXd&) const;
template Eigen::VectorXd Mesh<3>::whole(const Eigen::VectorXd&) const;

}  // namespace strake::structure::fem
