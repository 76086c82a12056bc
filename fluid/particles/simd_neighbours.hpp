#pragma once

#include "fluid/particles/periodic.hpp"
#include "fluid/particles/simd.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) && defined(__BMI2__)
#define STRAKE_AVX512
#include <immintrin.h>
#endif

/// Functions of the neighbour search on eight or sixteen particles at a time. They fetch places through a
/// list of indices, compare them with one bit per lane as result, and pack the values of the set bits.
/// Written out for AVX-512, where the compiler's own gather is two to three times slower; plain loops
/// elsewhere. Lanes beyond `n` are neither read nor written.
namespace strake::fluid::simd {

inline constexpr int width = 8;         // of doubles
inline constexpr int wide = 2 * width;  // of floats and indices

/// Returns one bit for each of the first n lanes.
inline std::uint32_t first_bits(std::int64_t n) {
  return n >= 32 ? ~0U : (1U << n) - 1U;
}

/// The bits of `value` moved to the places of the set bits of `places`, in order.
inline std::uint32_t deposit(std::uint32_t value, std::uint32_t places) {
#ifdef STRAKE_AVX512
  return _pdep_u32(value, places);
#else
  std::uint32_t out = 0;
  for (; places; places &= places - 1, value >>= 1)
    if (value & 1) out |= places & (~places + 1);
  return out;
#endif
}
/// Packs the indices of the set bits of `bits` (sixteen at most) to `to`; returns their number.
inline int pack(const std::int32_t* from, std::uint32_t bits, std::int32_t* to) {
  const int count = std::popcount(bits);
#ifdef STRAKE_AVX512
  const auto mask = static_cast<__mmask16>(bits);
  _mm512_mask_storeu_epi32(to, static_cast<__mmask16>(first_bits(count)),
                           _mm512_maskz_compress_epi32(mask, _mm512_maskz_loadu_epi32(mask, from)));
#else
  for (; bits; bits &= bits - 1) *to++ = from[std::countr_zero(bits)];
#endif
  return count;
}
/// The same for doubles, eight at most.
inline int pack(const double* from, std::uint32_t bits, double* to) {
  const int count = std::popcount(bits);
#ifdef STRAKE_AVX512
  const auto mask = static_cast<__mmask8>(bits);
  _mm512_mask_storeu_pd(to, static_cast<__mmask8>(first_bits(count)),
                        _mm512_maskz_compress_pd(mask, _mm512_maskz_loadu_pd(mask, from)));
#else
  for (; bits; bits &= bits - 1) *to++ = from[std::countr_zero(bits)];
#endif
  return count;
}

/// (1 − entry) scale of the entries of the set bits, sixteen at most, packed.
inline int pack_inverses(const float* from, std::uint32_t bits, float scale, float* to) {
  const int count = std::popcount(bits);
#ifdef STRAKE_AVX512
  const auto mask = static_cast<__mmask16>(bits);
  const __m512 inverse = _mm512_mul_ps(_mm512_sub_ps(_mm512_set1_ps(1), _mm512_maskz_loadu_ps(mask, from)),
                                       _mm512_set1_ps(scale));
  _mm512_mask_storeu_ps(to, static_cast<__mmask16>(first_bits(count)),
                        _mm512_maskz_compress_ps(mask, inverse));
#else
  for (; bits; bits &= bits - 1) *to++ = (1 - from[std::countr_zero(bits)]) * scale;
#endif
  return count;
}

/// Marks which of n <= 16 numbers are less than the limit, or greater.
inline std::uint32_t below(const float* x, int n, float limit) {
#ifdef STRAKE_AVX512
  const auto mask = static_cast<__mmask16>(first_bits(n));
  return _mm512_mask_cmp_ps_mask(mask, _mm512_maskz_loadu_ps(mask, x), _mm512_set1_ps(limit), _CMP_LT_OQ);
#else
  std::uint32_t bits = 0;
  for (int k = 0; k < n; ++k) bits |= (x[k] < limit ? 1U : 0U) << k;
  return bits;
#endif
}
inline std::uint32_t above(const double* x, int n, double limit) {
#ifdef STRAKE_AVX512
  const std::uint32_t bits = first_bits(n);
  const auto low = static_cast<__mmask8>(bits & 0xffU), high = static_cast<__mmask8>(bits >> width);
  const __m512d least = _mm512_set1_pd(limit);
  return _mm512_mask_cmp_pd_mask(low, _mm512_maskz_loadu_pd(low, x), least, _CMP_GT_OQ) |
         std::uint32_t{
             _mm512_mask_cmp_pd_mask(high, _mm512_maskz_loadu_pd(high, x + width), least, _CMP_GT_OQ)}
             << width;
#else
  std::uint32_t bits = 0;
  for (int k = 0; k < n; ++k) bits |= (x[k] > limit ? 1U : 0U) << k;
  return bits;
#endif
}

#ifdef STRAKE_AVX512
/// Components of eight vectors, one vector of eight lanes each.
template <int dim>
struct Components {
  __m512d along[dim];
};

/// Loads the columns x[dim · j] of n <= 8 particles j. Lanes beyond n get particle `self`.
template <int dim>
inline Components<dim> columns(const double* x, const std::int32_t* j, int n, std::int32_t self) {
  std::int32_t filled[8];
  const std::int32_t* at = j;
  if (n < 8) {
    _mm256_storeu_si256(
        reinterpret_cast<__m256i*>(filled),
        _mm256_mask_loadu_epi32(_mm256_set1_epi32(self), static_cast<__mmask8>(first_bits(n)), j));
    at = filled;
  }
  Components<dim> out;
  if constexpr (dim == 2) {
    const auto pair = [&](int k) { return _mm_loadu_pd(x + 2 * std::int64_t{at[k]}); };
    const auto four = [&](int k) {
      __m512d v = _mm512_castpd128_pd512(pair(k));
      v = _mm512_insertf64x2(v, pair(k + 2), 1);
      v = _mm512_insertf64x2(v, pair(k + 4), 2);
      return _mm512_insertf64x2(v, pair(k + 6), 3);
    };
    const __m512d even = four(0), odd = four(1);  // the unpacks put them back in order
    out.along[0] = _mm512_unpacklo_pd(even, odd);
    out.along[1] = _mm512_unpackhi_pd(even, odd);
  } else {
    const auto one = [&](int k) { return _mm256_maskz_loadu_pd(0b111, x + 3 * std::int64_t{at[k]}); };
    const auto two = [&](int k) { return _mm512_insertf64x4(_mm512_castpd256_pd512(one(k)), one(k + 4), 1); };
    const __m512d v04 = two(0), v15 = two(1), v26 = two(2), v37 = two(3);
    const __m512d xz0 = _mm512_unpacklo_pd(v04, v15), xz2 = _mm512_unpacklo_pd(v26, v37);
    const __m512d y0 = _mm512_unpackhi_pd(v04, v15), y2 = _mm512_unpackhi_pd(v26, v37);
    const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
    const __m512i second = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
    out.along[0] = _mm512_permutex2var_pd(xz0, first, xz2);
    out.along[1] = _mm512_permutex2var_pd(y0, first, y2);
    out.along[2] = _mm512_permutex2var_pd(xz0, second, xz2);
  }
  return out;
}
#endif

/// Loads the columns x[dim · j] of n <= 8 particles j, component by component. Lanes beyond n get particle
/// `self`.
template <int dim>
inline void gather(const double* x, const std::int32_t* j, int n, std::int32_t self, Double8 (&out)[dim]) {
#ifdef STRAKE_AVX512
  const Components<dim> found = columns<dim>(x, j, n, self);
  for (int d = 0; d < dim; ++d) out[d] = reinterpret_cast<const Double8&>(found.along[d]);
#else
  for (int k = 0; k < width; ++k)
    for (int d = 0; d < dim; ++d) out[d][k] = x[dim * std::int64_t{k < n ? j[k] : self} + d];
#endif
}
/// The first n <= 8 doubles; zero beyond.
inline Double8 load(const double* from, int n) {
#ifdef STRAKE_AVX512
  return reinterpret_cast<Double8>(_mm512_maskz_loadu_pd(static_cast<__mmask8>(first_bits(n)), from));
#else
  Double8 out{};
  for (int k = 0; k < n; ++k) out[k] = from[k];
  return out;
#endif
}
/// The first n <= 8 floats; zero beyond.
inline Float8 load(const float* from, int n) {
#ifdef STRAKE_AVX512
  return reinterpret_cast<Float8>(_mm256_maskz_loadu_ps(static_cast<__mmask8>(first_bits(n)), from));
#else
  Float8 out{};
  for (int k = 0; k < n; ++k) out[k] = from[k];
  return out;
#endif
}
/// Converts to the nearest numbers of single precision, and back.
inline Float8 narrowed(const Double8& x) {
#ifdef STRAKE_AVX512
  return reinterpret_cast<Float8>(_mm512_cvtpd_ps(reinterpret_cast<__m512d>(x)));
#else
  return __builtin_convertvector(x, Float8);
#endif
}
inline Double8 widened(const Float8& x) {
#ifdef STRAKE_AVX512
  return reinterpret_cast<Double8>(_mm512_cvtps_pd(reinterpret_cast<__m256>(x)));
#else
  return __builtin_convertvector(x, Double8);
#endif
}
inline Double4 root(const Double4& x) {
#ifdef STRAKE_AVX512
  return reinterpret_cast<Double4>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(x)));
#else
  return Double4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
#endif
}
/// Writes the first n lanes, all of them where n is larger.
inline void store(const Float8& from, float* to, std::size_t n) {
#ifdef STRAKE_AVX512
  _mm256_mask_storeu_ps(to, static_cast<__mmask8>(first_bits(static_cast<std::int64_t>(n))),
                        reinterpret_cast<__m256>(from));
#else
  for (std::size_t k = 0; k < std::min<std::size_t>(n, width); ++k) to[k] = from[static_cast<int>(k)];
#endif
}

#ifdef STRAKE_AVX512
/// Computes |x_j − x_i|² of eight particles j to the nearest image [m²]; the same bits for i-j and j-i. Lanes
/// beyond n are 0.
template <int dim, bool seams>
inline __m512d squares(const double* x, std::int32_t i, const std::int32_t* j, int n,
                       const Periodic<dim>& periodic) {
  const Components<dim> at = columns<dim>(x, j, n, i);
  __m512d sum = _mm512_setzero_pd();
  for (int d = 0; d < dim; ++d) {
    __m512d r = _mm512_sub_pd(at.along[d], _mm512_set1_pd(x[dim * std::int64_t{i} + d]));
    if constexpr (seams) {
      const __m512d length = _mm512_set1_pd(periodic.length()[d]), half = _mm512_set1_pd(periodic.half(d));
      const __mmask8 up = _mm512_cmp_pd_mask(r, _mm512_sub_pd(_mm512_setzero_pd(), half), _CMP_LT_OQ);
      const __mmask8 down = _mm512_cmp_pd_mask(r, half, _CMP_GT_OQ);
      r = _mm512_mask_sub_pd(_mm512_mask_add_pd(r, up, r, length), down, r, length);
    }
    sum = _mm512_fmadd_pd(r, r, sum);
  }
  return sum;
}
#else
template <int dim, bool seams>
inline double square(const double* x, std::int32_t i, std::int32_t j, const Periodic<dim>& periodic) {
  double sum = 0;
  for (int d = 0; d < dim; ++d) {
    double r = x[dim * std::int64_t{j} + d] - x[dim * std::int64_t{i} + d];
    if constexpr (seams) r = periodic.nearest(r, d);
    sum += r * r;
  }
  return sum;
}
#endif

/// Marks which of n <= 8 particles j have low < |x_j − x_i|² < high.
template <int dim, bool seams>
inline std::uint32_t between(const double* x, std::int32_t i, const std::int32_t* j, int n,
                             const Periodic<dim>& periodic, double low, double high) {
#ifdef STRAKE_AVX512
  const __m512d sum = squares<dim, seams>(x, i, j, n, periodic);
  const __mmask8 above = _mm512_cmp_pd_mask(sum, _mm512_set1_pd(low), _CMP_GT_OQ);
  return _mm512_mask_cmp_pd_mask(above, sum, _mm512_set1_pd(high), _CMP_LT_OQ);
#else
  std::uint32_t bits = 0;
  for (int k = 0; k < n; ++k) {
    const double sum = square<dim, seams>(x, i, j[k], periodic);
    bits |= (sum > low && sum < high ? 1U : 0U) << k;
  }
  return bits;
#endif
}

/// Computes to[k] = 1/|x_j − x_i| of n <= 8 particles j.
template <int dim, bool seams>
inline void inverse_lengths(const double* x, std::int32_t i, const std::int32_t* j, int n,
                            const Periodic<dim>& periodic, double* to) {
#ifdef STRAKE_AVX512
  const __m512d inverse =
      _mm512_div_pd(_mm512_set1_pd(1), _mm512_sqrt_pd(squares<dim, seams>(x, i, j, n, periodic)));
  _mm512_mask_storeu_pd(to, static_cast<__mmask8>(first_bits(n)), inverse);
#else
  for (int k = 0; k < n; ++k) to[k] = 1.0 / std::sqrt(square<dim, seams>(x, i, j[k], periodic));
#endif
}

/// Computes to[k] = 1 − 1/√(scale |x_j − x_i|²) of n <= 8 particles j, not above zero.
template <int dim, bool seams>
inline void entries(const double* x, std::int32_t i, const std::int32_t* j, int n,
                    const Periodic<dim>& periodic, double scale, float* to) {
#ifdef STRAKE_AVX512
  const __m512d sum = squares<dim, seams>(x, i, j, n, periodic);
  const __m256 square = _mm512_cvtpd_ps(_mm512_mul_pd(sum, _mm512_set1_pd(scale))), one = _mm256_set1_ps(1);
  const __m256 inverse = _mm256_div_ps(one, _mm256_sqrt_ps(square));
  const __m256 entry = _mm256_min_ps(_mm256_sub_ps(one, inverse), _mm256_setzero_ps());
  _mm256_mask_storeu_ps(to, static_cast<__mmask8>(first_bits(n)), entry);
#else
  for (int k = 0; k < n; ++k) {
    const auto square = static_cast<float>(scale * simd::square<dim, seams>(x, i, j[k], periodic));
    to[k] = std::min(1 - 1 / std::sqrt(square), 0.0F);
  }
#endif
}

}  // namespace strake::fluid::simd
