#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// The boxes of the ranks, as a Partition makes them: six numbers per rank, the lower and the upper corner. A
/// box has the places above its lower and up to its upper corner. The owner of a place is found in a tree of
/// cuts, in about log N looks of N boxes.
class RankBoxes {
 public:
  using Place = std::array<double, 3>;

  void assign(std::span<const double> boxes);
  std::span<const double> values() const { return values_; }

  bool owns(int rank, const Place& at) const;
  /// Returns the lowest rank whose box has the place; 0 where none has.
  int owner(const Place& at) const;

 private:
  /// A cut of space, or a list of boxes. Places up to `at` lie in the first node behind it, the others in the
  /// second.
  struct Node {
    double at = 0;
    int axis = -1;                       // below 0: a list
    std::int32_t first = 0, second = 0;  // nodes, or the list's begin and end in `list_`
  };
  std::int32_t add(const std::vector<int>& ranks);
  std::vector<double> values_;
  std::vector<Node> nodes_;  // the first one is the root
  std::vector<int> list_;
};

}  // namespace strake::fluid
