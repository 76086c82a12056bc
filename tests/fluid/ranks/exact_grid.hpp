#pragma once

#include "fluid/ranks/shared_grid.hpp"
#include "proto/ranks/communicator.hpp"
#include "tests/algebra/factors.hpp"

#include <algorithm>
#include <vector>

namespace strake::fluid {

/// Solves the grid's equation exactly: every rank factorises the whole of it.
class ExactGrid final : public SharedGrid {
 public:
  explicit ExactGrid(Communicator& ranks) : ranks_(ranks) {}

  void build(const SharedRows& rows) override {
    struct Entry {
      std::int64_t row, column;
      double value;
    };
    first_ = rows.first;
    own_ = rows.own;
    Bytes own;
    for (std::size_t i = 0; i + 1 < rows.start.size(); ++i) {
      append(own, Entry{rows.number[i], rows.number[i], rows.diagonal[i]});
      for (auto e = static_cast<std::size_t>(rows.start[i]); e < static_cast<std::size_t>(rows.start[i + 1]);
           ++e)
        append(own,
               Entry{rows.number[i], rows.number[static_cast<std::size_t>(rows.column[e])], rows.value[e]});
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (const Bytes& bytes : ranks_.gather(own))
      for (const Entry& entry : values_of<Entry>(bytes))
        entries.emplace_back(static_cast<int>(entry.row), static_cast<int>(entry.column), entry.value);
    size_ = static_cast<Eigen::Index>(ranks_.sum(own_));
    Eigen::SparseMatrix<double> matrix(size_, size_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    asymmetry = std::max(
        asymmetry,
        Eigen::SparseMatrix<double>(matrix - Eigen::SparseMatrix<double>(matrix.transpose())).norm() /
            matrix.norm());
    for (Eigen::Index i = 0; i < size_; ++i) matrix.coeffRef(i, i) *= 1 + 1e-6;
    factors_.compute(matrix);
  }

  void solve(std::span<const float> right, std::span<float> solution) override {
    Eigen::VectorXd all(size_);
    Eigen::Index at = 0;
    for (const Bytes& bytes : ranks_.gather(std::as_bytes(right)))
      for (const float value : values_of<float>(bytes)) all[at++] = value;
    const Eigen::VectorXd x = factors_.solve(all);
    for (std::size_t k = 0; k < solution.size(); ++k)
      solution[k] = static_cast<float>(x[first_ + static_cast<Eigen::Index>(k)]);
  }

  double asymmetry = 0;

 private:
  Communicator& ranks_;
  std::int64_t first_ = 0, own_ = 0;
  Eigen::Index size_ = 0;
  SparseFactors factors_;
};

}  // namespace strake::fluid
