#include "structure/failure/failure_record.hpp"

#include <algorithm>
#include <numeric>

namespace strake::structure {

void FailureRecord::report(std::map<std::string, double>& monitor) const {
  const auto tell = [&](const std::string& name, const Event& event) {
    if (!event.happened()) return;
    monitor[name + ".time"] = event.time;
    monitor[name + ".x"] = event.at.x();
    monitor[name + ".y"] = event.at.y();
    monitor[name + ".z"] = event.at.z();
  };
  tell("failure.start", start);
  tell("failure.crack", crack);
  tell("failure.parted", parted);
}

Eigen::MatrixXd FailureRecord::table() const {
  Eigen::MatrixXd table(4, 3);
  table << start.time, crack.time, parted.time, start.at, crack.at, parted.at;
  return table;
}

FailureRecord FailureRecord::from(const Eigen::MatrixXd& table) {
  const auto event = [&](Eigen::Index k) { return Event{table(0, k), table.col(k).tail<3>()}; };
  return {.start = event(0), .crack = event(1), .parted = event(2)};
}

Pieces::Pieces(Eigen::Index n) : parent_(static_cast<std::size_t>(n)) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

Eigen::Index Pieces::root(Eigen::Index i) {
  while (parent_[static_cast<std::size_t>(i)] != i) {
    auto& up = parent_[static_cast<std::size_t>(i)];
    up = parent_[static_cast<std::size_t>(up)];
    i = up;
  }
  return i;
}

void Pieces::join(Eigen::Index a, Eigen::Index b) {
  const Eigen::Index i = root(a), j = root(b);
  parent_[static_cast<std::size_t>(std::max(i, j))] = std::min(i, j);
}

std::vector<Eigen::Index> Pieces::large() {
  constexpr std::size_t debris = 100;  // a hundredth
  std::vector<Eigen::Index> piece(parent_.size());
  std::vector<std::size_t> size(parent_.size(), 0);
  for (std::size_t i = 0; i < piece.size(); ++i) {
    piece[i] = root(static_cast<Eigen::Index>(i));
    ++size[static_cast<std::size_t>(piece[i])];
  }
  for (Eigen::Index& p : piece)
    if (debris * size[static_cast<std::size_t>(p)] < piece.size()) p = -1;
  return piece;
}

bool Pieces::more_than_one(const std::vector<Eigen::Index>& pieces) {
  Eigen::Index seen = -1;
  for (const Eigen::Index p : pieces) {
    if (p < 0) continue;
    if (seen >= 0 && p != seen) return true;
    seen = p;
  }
  return false;
}

void Joint::add(Eigen::Index piece, Eigen::Index other, const Eigen::Vector3d& place) {
  if (piece < 0 || other < 0 || piece == other) return;
  const std::pair<Eigen::Index, Eigen::Index> both = std::minmax(piece, other);
  if (count_ == 0) pieces_ = both;
  if (both != pieces_) return;
  sum_ += place;
  ++count_;
}

Eigen::Vector3d Joint::middle_or(const Eigen::Vector3d& if_none) const {
  return count_ > 0 ? Eigen::Vector3d(sum_ / count_) : if_none;
}

}  // namespace strake::structure
