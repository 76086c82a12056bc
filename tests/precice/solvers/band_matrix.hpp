#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

/// A square matrix whose entries lie within `width` of the diagonal. A x = b is solved by elimination with
/// row exchanges.
class BandMatrix {
 public:
  BandMatrix(int size, int width) : size_(size), width_(width), entries_(square(size)) {}

  void clear() { std::fill(entries_.begin(), entries_.end(), 0.0); }
  double& operator()(int row, int column) { return entries_[index(row, column)]; }

  /// Overwrites the matrix; b becomes x.
  void solve(std::vector<double>& b) {
    for (int k = 0; k < size_; ++k) {
      const int below = std::min(size_ - 1, k + width_), right = std::min(size_ - 1, k + 2 * width_);
      int pivot = k;
      for (int i = k + 1; i <= below; ++i)
        if (std::abs((*this)(i, k)) > std::abs((*this)(pivot, k))) pivot = i;
      if (pivot != k) {
        for (int j = k; j <= right; ++j) std::swap((*this)(k, j), (*this)(pivot, j));
        std::swap(at(b, k), at(b, pivot));
      }
      for (int i = k + 1; i <= below; ++i) {
        const double factor = (*this)(i, k) / (*this)(k, k);
        if (factor == 0) continue;
        for (int j = k; j <= right; ++j) (*this)(i, j) -= factor * (*this)(k, j);
        at(b, i) -= factor * at(b, k);
      }
    }
    for (int k = size_ - 1; k >= 0; --k) {
      for (int j = k + 1; j <= std::min(size_ - 1, k + 2 * width_); ++j) at(b, k) -= (*this)(k, j) * at(b, j);
      at(b, k) /= (*this)(k, k);
    }
  }

 private:
  static std::size_t square(int n) { return static_cast<std::size_t>(n) * static_cast<std::size_t>(n); }
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(column);
  }
  static double& at(std::vector<double>& b, int i) { return b[static_cast<std::size_t>(i)]; }

  int size_, width_;
  std::vector<double> entries_;
};
