#pragma once

#include <type_traits>

namespace strake::fluid {

/// Doubles that one instruction works on, where the machine has such wide ones; GCC's and Clang's vector
/// types. Sums of few numbers over long rows use the lanes for several pairs, others for the components of
/// one.
typedef double Lanes2 __attribute__((vector_size(16)));
typedef double Lanes4 __attribute__((vector_size(32)));
typedef double Lanes8 __attribute__((vector_size(64)));

typedef float Floats4 __attribute__((vector_size(16)));
typedef float Floats8 __attribute__((vector_size(32)));

struct Four {
  Lanes4 lanes;
};
struct Eight {
  Lanes8 lanes;
};

/// A vector of the plane, or of space with a zero behind it.
template <int dim>
using Column = std::conditional_t<dim == 2, Lanes2, Lanes4>;
template <int dim>
inline Column<dim> column_at(const double* x) {
  if constexpr (dim == 2)
    return Lanes2{x[0], x[1]};
  else
    return Lanes4{x[0], x[1], x[2], 0};
}

inline Lanes8 all8(double x) {
  return Lanes8{x, x, x, x, x, x, x, x};
}
inline Lanes8 positive(const Lanes8& x) {
  return x > 0 ? x : Lanes8{};
}
inline double sum(const Lanes8& x) {
  const Lanes4 four = __builtin_shufflevector(x, x, 0, 1, 2, 3) + __builtin_shufflevector(x, x, 4, 5, 6, 7);
  const Lanes2 two = __builtin_shufflevector(four, four, 0, 1) + __builtin_shufflevector(four, four, 2, 3);
  return two[0] + two[1];
}

inline Lanes8 halves(double low, double high) {
  return Lanes8{low, low, low, low, high, high, high, high};
}

}  // namespace strake::fluid
