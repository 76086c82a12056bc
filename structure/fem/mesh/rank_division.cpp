#include "structure/fem/mesh/rank_division_parts.hpp"

#include <cstring>
#include <span>
#include <vector>

namespace strake::structure::fem {

using Eigen::Index;

Communicator& RankDivision::communicator() const {
  return parts_->communicator;
}

int RankDivision::number(int unknown) const {
  return alone() ? unknown : parts_->on_one_rank[static_cast<std::size_t>(unknown)];
}

Index RankDivision::own_of_parts() const {
  return parts_->unknowns.locally_owned_size();
}

Index RankDivision::size_of_parts() const {
  return static_cast<Index>(parts_->unknowns.size());
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

void RankDivision::update(Eigen::VectorXd& x) const {
  if (alone()) return;
  const auto& exchange = parts_->unknowns;
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

Eigen::MatrixXd RankDivision::columns_on_first(const Eigen::MatrixXd& own) const {
  const auto bytes = std::as_bytes(std::span(own.data(), static_cast<std::size_t>(own.size())));
  const std::vector<std::size_t> sizes = communicator().all(bytes.size());
  std::vector<Bytes> to(sizes.size()), from(sizes.size());
  if (!first()) to[0].assign(bytes.begin(), bytes.end());
  std::size_t total = 0;
  for (std::size_t r = 0; first() && r < sizes.size(); ++r) {
    total += sizes[r];
    if (r > 0) from[r].resize(sizes[r]);
  }
  communicator().exchange(to, from);
  if (first()) from[0].assign(bytes.begin(), bytes.end());
  Eigen::MatrixXd all(own.rows(), static_cast<Index>(total / sizeof(double)) / own.rows());
  double* next = all.data();
  for (const Bytes& part : from) {
    std::memcpy(next, part.data(), part.size());
    next += part.size() / sizeof(double);
  }
  return all;
}

}  // namespace strake::structure::fem
