#pragma once

#include "structure/fem/element/assembly.hpp"
#include "structure/fem/element/continuum.hpp"
#include "structure/fem/element/solid_shell.hpp"

#include <functional>
#include <memory>

namespace strake::structure::fem {

/// What one cell gives to a sum, whatever its type.
class CellPart {
 public:
  virtual ~CellPart() = default;
  virtual std::unique_ptr<CellPart> copy() const = 0;
};

/// Whether the cells of a body of so many are computed one after the other: there is one thread, or handing
/// cells to threads costs as much as it saves.
bool in_one_thread(int n_cells);
/// Computes the cells by deal.II's WorkStream, and adds their parts in the order of the cells. It is compiled
/// once for parts of any type: WorkStream's templates are many.
void compute_in_threads(int n_cells, const CellPart& sample,
                        const std::function<void(int, CellPart&)>& compute,
                        const std::function<void(int, const CellPart&)>& add);

/// Computes the part of each cell, and adds the parts in the order of the cells. `compute(c, part)` runs on
/// several threads at a time, `add(c, part)` on one: the same bits for any number of threads. Each thread has
/// copies of the sample.
template <class Part, class Compute, class Add>
void sum_over_cells(int n_cells, const Part& sample, const Compute& compute, const Add& add) {
  // Compiled once for both ways below, so that the compiler contracts no product differently in one of them.
  const auto compute_one = [&](int c, Part& part) __attribute__((noinline)) {
    compute(c, part);
  };
  if (in_one_thread(n_cells)) {
    Part part = sample;
    for (int c = 0; c < n_cells; ++c) {
      compute_one(c, part);
      add(c, part);
    }
    return;
  }
  struct Held final : CellPart {
    explicit Held(const Part& of) : part(of) {}
    std::unique_ptr<CellPart> copy() const override { return std::make_unique<Held>(part); }
    Part part;
  };
  compute_in_threads(
      n_cells, Held(sample), [&](int c, CellPart& held) { compute_one(c, static_cast<Held&>(held).part); },
      [&](int c, const CellPart& held) { add(c, static_cast<const Held&>(held).part); });
}

template <int dim>
template <int n, class Use>
decltype(auto) Assembly<dim>::with_element(int cell, const Use& use) const {
  if constexpr (dim == 3 && n == SolidShell::nodes)
    if (const int thin = thin_axis(cell); thin >= 0) return use(SolidShell(mesh_, cell, thin), of(cell));
  return use(Continuum<dim, n>(mesh_, cell, is_enhanced(cell)), of(cell));
}

}  // namespace strake::structure::fem
