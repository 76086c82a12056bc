#pragma once

namespace strake::fluid {

/// Doubles that one instruction works on, where the machine has such wide ones; GCC's and Clang's vector
/// types. Sums over short neighbour rows use the lanes for the components of one pair, not for several pairs.
typedef double Lanes4 __attribute__((vector_size(32)));
typedef double Lanes8 __attribute__((vector_size(64)));

struct Four {
  Lanes4 lanes;
};
struct Eight {
  Lanes8 lanes;
};

inline Lanes8 halves(double low, double high) {
  return Lanes8{low, low, low, low, high, high, high, high};
}

}  // namespace strake::fluid
