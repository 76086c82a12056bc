#pragma once

#include "structure/fem/element/assembly.hpp"
#include "structure/fem/element/continuum.hpp"
#include "structure/fem/element/solid_shell.hpp"

#include <deal.II/base/multithread_info.h>
#include <deal.II/base/work_stream.h>

namespace strake::structure::fem {

/// Computes the part of each cell, and adds the parts in the order of the cells, by deal.II's WorkStream.
/// `compute(c, part)` runs on several threads at a time, `add(c, part)` on one: the same bits for any number
/// of threads. Each thread has copies of the sample.
template <class Part, class Compute, class Add>
void sum_over_cells(int n_cells, const Part& sample, const Compute& compute, const Add& add) {
  // Compiled once for all ways below, so that the compiler contracts no product differently in one of them.
  const auto compute_one = [&](int c, Part& part) __attribute__((noinline)) {
    compute(c, part);
  };
  constexpr int few = 1000;  // here handing cells to threads costs as much as it saves
  if (n_cells < few || dealii::MultithreadInfo::n_threads() == 1) {
    Part part = sample;
    for (int c = 0; c < n_cells; ++c) {
      compute_one(c, part);
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
        compute_one(c, result.part);
      },
      [&](const OfCell& result) { add(result.cell, result.part); }, Nothing{}, OfCell{0, sample});
}

template <int dim>
template <int n, class Use>
decltype(auto) Assembly<dim>::with_element(int cell, const Use& use) const {
  if constexpr (dim == 3 && n == SolidShell::nodes)
    if (const int thin = thin_axis(cell); thin >= 0) return use(SolidShell(mesh_, cell, thin), of(cell));
  return use(Continuum<dim, n>(mesh_, cell, is_enhanced(cell)), of(cell));
}

}  // namespace strake::structure::fem
