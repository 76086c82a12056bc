#include "fluid/pressure_solver/pressure_system.hpp"

#include <algorithm>

namespace strake::fluid {

namespace {

/// Marks the rows whose pressure may be undetermined. Such a row has neither P = 0 beside it nor
/// compressibility. Neither has any row that is connected with it through the first and the last neighbours
/// of rows. All other rows are determined.
std::vector<char> doubtful_rows(const PressureSystem& system) {
  const std::int64_t n = system.size();
  std::vector<char> doubtful(static_cast<std::size_t>(n));
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < n; ++k) {
    const auto row = static_cast<std::size_t>(k);
    double sum = 0;
    for (std::int64_t e = system.start[row]; e < system.stop[row]; ++e) sum -= system.value.data()[e];
    // A neighbour at P = 0 or compressibility makes the diagonal larger than its row; round-off does not.
    doubtful[row] = system.diagonal[k] - sum > 1e-10 * system.diagonal[k] ? 0 : 1;
  }
  std::vector<std::int32_t> root(static_cast<std::size_t>(n));
  const auto find = [&](std::int32_t k) {
    std::int32_t* const up = root.data();
    while (up[k] != k) k = up[k] = up[up[k]];
    return k;
  };
  const auto join = [&](std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    char& both = doubtful[static_cast<std::size_t>(std::min(a, b))];
    both = static_cast<char>(both & doubtful[static_cast<std::size_t>(std::max(a, b))]);
  };
  // The root of a row whose first neighbour comes before it is that neighbour's, which is known by then.
  const std::int32_t* const column = system.column.data();
  for (std::int64_t k = 0; k < n; ++k) {
    const auto row = static_cast<std::size_t>(k);
    const auto own = static_cast<std::int32_t>(k);
    const bool hangs = system.start[row] < system.stop[row] && column[system.start[row]] < own;
    const std::int32_t top = hangs ? root.data()[column[system.start[row]]] : own;
    root[row] = top;
    doubtful.data()[top] = static_cast<char>(doubtful.data()[top] & doubtful[row]);
  }
  for (std::int64_t k = 0; k < n; ++k) {
    const auto row = static_cast<std::size_t>(k);
    if (system.start[row] == system.stop[row]) continue;
    for (const std::int64_t e : {system.start[row], system.stop[row] - 1})
      if (root[row] != root.data()[column[e]]) join(static_cast<std::int32_t>(k), column[e]);
  }
  for (std::int64_t k = 0; k < n; ++k)
    doubtful[static_cast<std::size_t>(k)] =
        doubtful[static_cast<std::size_t>(find(static_cast<std::int32_t>(k)))];
  return doubtful;
}

}  // namespace

int close_sealed_blocks(PressureSystem& system) {
  const std::int64_t n = system.size();
  const std::vector<char> doubtful = doubtful_rows(system);
  std::vector<char> seen(static_cast<std::size_t>(n), 0);
  std::vector<std::int64_t> block;
  int sealed = 0;
  for (std::int64_t seed = 0; seed < n; ++seed) {
    if (!doubtful[static_cast<std::size_t>(seed)] || seen[static_cast<std::size_t>(seed)]) continue;
    block.assign(1, seed);
    seen[static_cast<std::size_t>(seed)] = 1;
    bool held = false;
    for (std::size_t at = 0; at < block.size(); ++at) {
      const auto k = static_cast<std::size_t>(block[at]);
      held = held || !doubtful[k];
      for (std::int64_t e = system.start[k]; e < system.stop[k]; ++e) {
        const std::int32_t j = system.column[static_cast<std::size_t>(e)];
        if (!seen[static_cast<std::size_t>(j)]) {
          seen[static_cast<std::size_t>(j)] = 1;
          block.push_back(j);
        }
      }
    }
    if (held) continue;
    ++sealed;
    double mean = 0;
    for (const std::int64_t k : block) mean += system.right[k];
    mean /= static_cast<double>(block.size());
    for (const std::int64_t k : block) system.right[k] -= mean;
    system.diagonal[seed] *= 2;
  }
  return sealed;
}

}  // namespace strake::fluid
