#pragma once

#include <type_traits>

namespace strake::fluid {

/// Doubles that one instruction processes, where the machine has such wide registers; vector types of GCC and
/// Clang. Sums of few numbers over long rows use the lanes for several pairs, others for the components of
/// one.
typedef double Double2 __attribute__((vector_size(16)));
typedef double Double4 __attribute__((vector_size(32)));
typedef double Double8 __attribute__((vector_size(64)));

typedef float Float4 __attribute__((vector_size(16)));
typedef float Float8 __attribute__((vector_size(32)));

struct Four {
  Double4 lanes;
};
struct Eight {
  Double8 lanes;
};

/// A vector of the plane, or of space with a zero behind it.
template <int dim>
using VecD = std::conditional_t<dim == 2, Double2, Double4>;
template <int dim>
inline VecD<dim> vec_at(const double* x) {
  if constexpr (dim == 2)
    return Double2{x[0], x[1]};
  else
    return Double4{x[0], x[1], x[2], 0};
}

inline Double8 all8(double x) {
  return Double8{x, x, x, x, x, x, x, x};
}
inline Double8 positive(const Double8& x) {
  return x > 0 ? x : Double8{};
}
inline double sum(const Double8& x) {
  const Double4 four = __builtin_shufflevector(x, x, 0, 1, 2, 3) + __builtin_shufflevector(x, x, 4, 5, 6, 7);
  const Double2 two = __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
  return two[0] + two[1];
}

inline Double8 halves(double low, double high) {
  return Double8{low, low, low, low, high, high, high, high};
}

}  // namespace strake::fluid
