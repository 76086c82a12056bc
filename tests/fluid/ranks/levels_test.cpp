#include "fluid/pressure_solver/ranked_levels.hpp"
#include "tests/fluid/ranks/exact_grid.hpp"
#include "tests/fluid/ranks/thread_communicator.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

// The grids above the last one: their cycle is symmetric, and an iteration with it converges.

namespace strake::fluid {
namespace {

/// The five-point Laplacian of a square of vertices, in strips of columns. The second rank has one odd column
/// alone: half of what it could interpolate from would be linearly dependent.
struct Strips {
  static constexpr int side = 32;
  static constexpr std::array<int, 5> bounds{0, 11, 12, 25, side};
  struct Edge {
    int i, j;  // j: −1 for the diagonal of i alone
  };
  static int owner(int vertex) {
    int rank = 0;
    while (vertex / side >= bounds[static_cast<std::size_t>(rank) + 1]) ++rank;
    return rank;
  }
  static std::vector<Edge> edges() {
    std::vector<Edge> all;
    for (int x = 0; x < side; ++x)
      for (int y = 0; y < side; ++y) {
        if (x + 1 < side) all.push_back({x * side + y, (x + 1) * side + y});
        if (y + 1 < side) all.push_back({x * side + y, x * side + y + 1});
        if (y == 0) all.push_back({x * side + y, -1});
      }
    return all;
  }
  static Eigen::SparseMatrix<double> matrix() {
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [i, j] : edges()) {
      entries.emplace_back(i, i, 1);
      if (j < 0) continue;
      entries.emplace_back(j, j, 1);
      entries.emplace_back(i, j, -1);
      entries.emplace_back(j, i, -1);
    }
    Eigen::SparseMatrix<double> whole(side * side, side * side);
    whole.setFromTriplets(entries.begin(), entries.end());
    return whole;
  }
};

/// The part of one rank: the edges whose first vertex is its own, in the rows of both ends.
struct Part {
  std::vector<std::int64_t> number;
  std::vector<GridPlace> place;
  SparseRows rows;
  std::vector<float> diagonal;
  std::int64_t first = 0;

  explicit Part(int rank) {
    constexpr int side = Strips::side;
    first = std::int64_t{Strips::bounds[static_cast<std::size_t>(rank)]} * side;
    const int stop = Strips::bounds[static_cast<std::size_t>(rank) + 1] * side;
    for (auto v = static_cast<int>(first); v < stop; ++v) place.push_back({v / side, v % side, 0});
    const int last = std::min(stop + side, side * side);  // and the next column, of another rank
    for (auto v = static_cast<int>(first); v < last; ++v) number.push_back(v);
    std::vector<std::vector<int>> beside(number.size());
    diagonal.assign(number.size(), 0);
    for (const auto& [i, j] : Strips::edges()) {
      if (Strips::owner(i) != rank) continue;
      const auto a = static_cast<std::size_t>(i - first);
      diagonal[a] += 1;
      if (j < 0) continue;
      const auto b = static_cast<std::size_t>(j - first);
      diagonal[b] += 1;
      beside[a].push_back(static_cast<int>(b));
      beside[b].push_back(static_cast<int>(a));
    }
    for (const auto& row : beside) {
      for (const int column : row) {
        rows.column.push_back(column);
        rows.value.push_back(-1);
      }
      rows.start.push_back(static_cast<std::int32_t>(rows.column.size()));
    }
  }
  SharedRows shared() const {
    return {.first = first,
            .own = std::ssize(place),
            .number = number,
            .start = rows.start,
            .column = rows.column,
            .value = rows.value,
            .diagonal = diagonal,
            .place = place};
  }
};

TEST(RankedLevels, AreASymmetricContraction) {
  ThreadRanks(4).run([&](Communicator& communicator) {
    auto exact = std::make_unique<ExactGrid>(communicator);
    const ExactGrid& last = *exact;
    RankedLevels levels(communicator, std::move(exact));
    const Part part(communicator.rank());
    levels.build(part.shared());
    EXPECT_EQ(levels.levels(), 2);
    EXPECT_LE(last.asymmetry, 1e-6);
    const auto cycle = [&](const Eigen::VectorXd& right) {
      std::vector<float> own, solution(part.place.size());
      for (std::size_t k = 0; k < part.place.size(); ++k)
        own.push_back(static_cast<float>(right[part.first + static_cast<Eigen::Index>(k)]));
      levels.solve(own, solution);
      Eigen::VectorXd whole(right.size());
      Eigen::Index at = 0;
      for (const Bytes& bytes : communicator.gather(std::as_bytes(std::span(solution))))
        for (const float value : values_of<float>(bytes)) whole[at++] = value;
      return whole;
    };
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    const auto vector = [&] {
      return Eigen::VectorXd(
          Eigen::VectorXd::NullaryExpr(Strips::side * Strips::side, [&] { return any(random); }));
    };
    const Eigen::VectorXd u = vector(), v = vector();
    EXPECT_NEAR(u.dot(cycle(v)), v.dot(cycle(u)), 1e-4 * u.norm() * v.norm());
    const auto matrix = Strips::matrix();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(u.size());
    for (int k = 0; k < 6; ++k) x += cycle(u - matrix * x);
    EXPECT_LE((u - matrix * x).norm(), std::pow(0.55, 6) * u.norm());
  });
}

}  // namespace
}  // namespace strake::fluid
