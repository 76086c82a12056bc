#include "structure/fem/mesh/joined_frame.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace strake::structure::fem {
namespace {

using Eigen::Index;

/// What a rank sends, as one row of numbers of 64 bits after the other.
class Message {
 public:
  Message() = default;
  explicit Message(const Bytes& bytes) : bytes_(bytes) {}
  template <class T>
  void put(T value) {
    static_assert(sizeof(T) == 8);
    const auto* const begin = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), begin, begin + sizeof value);
  }
  template <class T>
  T take() {
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  Bytes bytes() && { return std::move(bytes_); }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

/// The same number on all ranks for a point: its node in the body on one rank, then its part.
template <int dim>
std::vector<std::int64_t> numbers_of_points(const Recovery<dim>& recovery, const Mesh<dim>& mesh) {
  const std::int64_t parts = 1 + *std::ranges::max_element(mesh.part);
  const auto all_parts = static_cast<std::int64_t>(mesh.division.max(static_cast<double>(parts)));
  std::vector<std::int64_t> number(static_cast<std::size_t>(recovery.size()));
  for (int c = 0; c < mesh.n_cells(); ++c)
    for (Index a = 0; a < mesh.cell.rows(); ++a)
      number[static_cast<std::size_t>(recovery.cell()(a, c))] =
          mesh.division.number(dim * mesh.cell(a, c)) / dim * all_parts +
          mesh.part[static_cast<std::size_t>(c)];
  return number;
}

/// Own points with the values in them, then own cells with the points of their pieces.
template <int dim>
Bytes message_of(const Frame& frame, const Recovery<dim>& recovery, const Mesh<dim>& mesh) {
  const std::vector<std::int64_t> number = numbers_of_points(recovery, mesh);
  const auto owns = [&](Index i) {
    return mesh.division.owns(dim * recovery.node()[static_cast<std::size_t>(i)]);
  };
  std::int64_t points = 0;
  for (Index i = 0; i < frame.position.cols(); ++i) points += owns(i);
  Message message;
  message.put(points);
  for (Index i = 0; i < frame.position.cols(); ++i) {
    if (!owns(i)) continue;
    message.put(number[static_cast<std::size_t>(i)]);
    for (const double x : frame.position.col(i)) message.put(x);
    for (const Frame::Array& array : frame.point_data)
      for (const double x : array.value.col(i)) message.put(x);
  }
  const Index pieces = frame.cells.cols() / mesh.n_cells();
  message.put(static_cast<std::int64_t>(std::ranges::count(mesh.own, 1)));
  for (Index c = 0; c < mesh.n_cells(); ++c) {
    if (mesh.own[static_cast<std::size_t>(c)] == 0) continue;
    message.put(static_cast<std::int64_t>(mesh.number[static_cast<std::size_t>(c)]));
    for (const int i : frame.cells.middleCols(c * pieces, pieces).reshaped())
      message.put(number[static_cast<std::size_t>(i)]);
  }
  return std::move(message).bytes();
}

struct Point {
  std::int64_t number;
  std::vector<double> values;
};
struct Cell {
  std::int64_t number;
  std::vector<std::int64_t> points;
};

void take(Message& message, std::size_t values, std::size_t corners, std::vector<Point>& points,
          std::vector<Cell>& cells) {
  for (auto left = message.take<std::int64_t>(); left > 0; --left) {
    Point& point = points.emplace_back(message.take<std::int64_t>(), std::vector<double>(values));
    for (double& x : point.values) x = message.take<double>();
  }
  for (auto left = message.take<std::int64_t>(); left > 0; --left) {
    Cell& cell = cells.emplace_back(message.take<std::int64_t>(), std::vector<std::int64_t>(corners));
    for (std::int64_t& i : cell.points) i = message.take<std::int64_t>();
  }
}

}  // namespace

template <int dim>
Frame joined_frame(const Frame& own, const Recovery<dim>& recovery, const Mesh<dim>& mesh) {
  const std::vector<Bytes> arrived = mesh.division.on_first(message_of(own, recovery, mesh));
  Frame frame;
  if (!mesh.division.first()) return frame;
  Index rows = own.position.rows();
  for (const Frame::Array& array : own.point_data) rows += array.value.rows();
  const Index pieces = own.cells.cols() / mesh.n_cells();
  std::vector<Point> points;
  std::vector<Cell> cells;
  for (const Bytes& bytes : arrived) {
    Message message(bytes);
    take(message, static_cast<std::size_t>(rows), static_cast<std::size_t>(own.cells.rows() * pieces), points,
         cells);
  }
  std::ranges::sort(points, {}, &Point::number);
  std::ranges::sort(cells, {}, &Cell::number);

  frame.time = own.time;
  const auto n = static_cast<Index>(points.size());
  frame.position.resize(3, n);
  for (const Frame::Array& array : own.point_data)
    frame.point_data.push_back({array.name, array.unit, Eigen::MatrixXd(array.value.rows(), n)});
  for (Index i = 0; i < n; ++i) {
    const double* value = points[static_cast<std::size_t>(i)].values.data();
    for (double& x : frame.position.col(i)) x = *value++;
    for (Frame::Array& array : frame.point_data)
      for (double& x : array.value.col(i)) x = *value++;
  }
  frame.cells.resize(own.cells.rows(), static_cast<Index>(cells.size()) * pieces);
  int* corner = frame.cells.data();
  for (const Cell& cell : cells)
    for (const std::int64_t number : cell.points)
      *corner++ =
          static_cast<int>(std::ranges::lower_bound(points, number, {}, &Point::number) - points.begin());
  return frame;
}

template Frame joined_frame(const Frame&, const Recovery<2>&, const Mesh<2>&);
template Frame joined_frame(const Frame&, const Recovery<3>&, const Mesh<3>&);

}  // namespace strake::structure::fem
