#include "structure/fem/element/cell_sums.hpp"

#include <deal.II/base/multithread_info.h>
#include <deal.II/base/work_stream.h>

#include <utility>

namespace strake::structure::fem {
namespace {

struct Nothing {};

/// A cell that WorkStream holds; each has a part of its own.
struct OfCell {
  explicit OfCell(std::unique_ptr<CellPart> own) : part(std::move(own)) {}
  OfCell(const OfCell& other) : cell(other.cell), part(other.part->copy()) {}
  OfCell& operator=(const OfCell& other) {
    cell = other.cell;
    part = other.part->copy();
    return *this;
  }
  int cell = 0;
  std::unique_ptr<CellPart> part;
};

}  // namespace

bool in_one_thread(int n_cells) {
  constexpr int few = 1000;  // here handing cells to threads costs as much as it saves
  return n_cells < few || dealii::MultithreadInfo::n_threads() == 1;
}

void compute_in_threads(int n_cells, const CellPart& sample,
                        const std::function<void(int, CellPart&)>& compute,
                        const std::function<void(int, const CellPart&)>& add) {
  dealii::WorkStream::run(
      0, n_cells,
      [&](int c, Nothing&, OfCell& result) {
        result.cell = c;
        compute(c, *result.part);
      },
      [&](const OfCell& result) { add(result.cell, *result.part); }, Nothing{}, OfCell(sample.copy()));
}

}  // namespace strake::structure::fem
