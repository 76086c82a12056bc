#pragma once

#include "structure/fem/element/assembly.hpp"

#include <deal.II/base/multithread_info.h>
#include <deal.II/base/work_stream.h>

#include <algorithm>

namespace strake::structure::fem {

/// Computes the part of each cell, and adds the parts in the order of the cells, by deal.II's WorkStream.
/// `compute(c, part)` runs on several threads at a time, `add(c, part)` on one: the same bits for any number
/// of threads. Each thread has copies of the sample.
template <class Part, class Compute, class Add>
void sum_over_cells(int n_cells, const Part& sample, const Compute& compute, const Add& add) {
  constexpr int few = 1000;  // here handing cells to threads costs as much as it saves
  if (n_cells < few || dealii::MultithreadInfo::n_threads() == 1) {
    Part part = sample;
    for (int c = 0; c < n_cells; ++c) {
      compute(c, part);
      add(c, part);
    }
    return;
  }
  struct Nothing {};
  struct OfCell {
    int cell;
    Part part;
  };
  dealii::WorkStream::run(
      0, n_cells,
      [&](int c, Nothing&, OfCell& result) {
        result.cell = c;
        compute(c, result.part);
      },
      [&](const OfCell& result) { add(result.cell, result.part); }, Nothing{}, OfCell{0, sample});
}

template <int dim>
template <class Local, class Compute>
Matrix Assembly<dim>::scatter(const Local& sample, const Compute& compute) const {
  Matrix result(pattern_.rows(), pattern_.cols());
  result.resizeNonZeros(pattern_.nonZeros());
  std::copy_n(pattern_.outerIndexPtr(), pattern_.rows() + 1, result.outerIndexPtr());
  std::copy_n(pattern_.innerIndexPtr(), pattern_.nonZeros(), result.innerIndexPtr());
  result.coeffs().setZero();
  double* value = result.valuePtr();
  const int* row_begin = result.outerIndexPtr();
  const int per_cell = static_cast<int>(mesh_.cell.rows());
  sum_over_cells(mesh_.n_cells(), sample, compute, [&](int c, const Local& local) {
    std::size_t slot = static_cast<std::size_t>(c) * static_cast<std::size_t>(per_cell * per_cell);
    for (int a = 0; a < per_cell; ++a)
      for (int b = 0; b < per_cell; ++b, ++slot)
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j)
            value[row_begin[dim * mesh_.cell(a, c) + i] + slot_[slot] + j] += local(dim * a + i, dim * b + j);
  });
  return result;
}

}  // namespace strake::structure::fem
