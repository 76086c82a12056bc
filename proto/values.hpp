#pragma once

#include <Eigen/Core>

#include <memory>
#include <new>
#include <optional>
#include <utility>

namespace strake {

/// The numbers of a field: components×n float64, column by column. To read, it is a constant Eigen matrix,
/// without the alignment of one. Copies share the numbers, which do not change while more than one has them;
/// they may lie in the message that brought them. Threads may use copies of their own at the same time.
class Values : public Eigen::Map<const Eigen::MatrixXd> {
 public:
  Values() : Map(nullptr, 0, 0) {}
  Values(Eigen::MatrixXd matrix) : Values(std::make_shared<Eigen::MatrixXd>(std::move(matrix))) {}
  template <class Derived>
  Values(const Eigen::EigenBase<Derived>& expression) : Values(Eigen::MatrixXd(expression)) {}
  /// Numbers at a multiple of 8 bytes, which `owner` keeps alive and which do not change.
  static Values lent(const double* numbers, Eigen::Index rows, Eigen::Index columns,
                     std::shared_ptr<const void> owner) {
    Values values;
    values.point_to(numbers, rows, columns);
    values.owner_ = std::move(owner);
    values.lent_ = true;
    return values;
  }
  Values(const Values&) = default;
  Values(Values&& other) noexcept : Values() { *this = std::move(other); }
  Values& operator=(const Values& other) {
    Values copy(other);
    return *this = std::move(copy);
  }
  Values& operator=(Values&& other) noexcept {
    point_to(other.data(), other.rows(), other.cols());
    owner_ = std::move(other.owner_);
    lent_ = std::exchange(other.lent_, false);
    finite_ = std::exchange(other.finite_, false);
    sum_ = std::exchange(other.sum_, std::nullopt);
    if (&other != this) other.point_to(nullptr, 0, 0);
    return *this;
  }
  ~Values() = default;

  /// To write: numbers of its own from here on, copied where others have them too. Until the next copy is
  /// made of it.
  Eigen::Map<Eigen::MatrixXd> edit() {
    if (lent_ || owner_.use_count() > 1) *this = Values(Eigen::MatrixXd(*this));
    finite_ = false;
    sum_.reset();
    return {const_cast<double*>(data()), rows(), cols()};
  }

  /// True if all values were tested before and found finite; the test need not be repeated.
  bool known_finite() const { return finite_; }
  void mark_finite() { finite_ = true; }
  /// Tests whether all values are finite, unless this is known already. Of more than `many` points it tests
  /// their sum, which is not finite if a value is not, and keeps it for `sum_over_points`. Reading the values
  /// from memory takes longer than adding them.
  bool check_finite();

  /// Σ over the columns, 3 components each, never −0. With many columns, sixteen partial sums of every
  /// sixteenth column are added at the end, since each addition to a single sum waits for the one before. The
  /// order depends on their number alone.
  Eigen::Vector3d sum_over_points() const;

 private:
  static constexpr Eigen::Index many = 512;  // points
  explicit Values(std::shared_ptr<Eigen::MatrixXd> own) : Map(own->data(), own->rows(), own->cols()) {
    owner_ = std::move(own);
  }
  /// Sets the map to other numbers, as Eigen's reference does.
  void point_to(const double* numbers, Eigen::Index rows, Eigen::Index columns) {
    new (static_cast<Map*>(this)) Map(numbers, rows, columns);
  }

  std::shared_ptr<const void> owner_;
  bool lent_ = false, finite_ = false;
  std::optional<Eigen::Vector3d> sum_;  // where `look` has computed it
};

/// Tests whether all values are finite, by Σ 0·x = 0: 0·x is zero only for finite x. The sum is many times
/// faster than a test of each value.
template <class Derived>
bool all_finite(const Eigen::DenseBase<Derived>& value) {
  return value.size() == 0 || (value.derived().array() * 0).sum() == 0;
}

}  // namespace strake
