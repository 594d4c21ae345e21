// SPDX-License-Identifier: Apache-2.0
// Several doubles that a processor's vector holds, as one number: templates of a number type work on them as on one
// double, each lane with the bits that a double would have. Comparisons give a Mask; select() is ?: for both.
//
// Lanes<n> for n of 2, 4 and 8 are the vectors of SSE2, AVX2 and AVX-512. Templates that work on them must be drawn into a
// function made for that instruction set (numerics/instruction_set.h): the compiler takes the vectors apart in a function
// made for any machine, which has none of their size. So the operators below are made for theirs, each of the three types by the
// same text.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace sagitta::numerics {

template <int n>
struct Mask;
template <int n>
struct Lanes;

// One bit a lane: its sign.
#if defined(__x86_64__)
inline unsigned sign_bits(__m128d a) { return static_cast<unsigned>(_mm_movemask_pd(a)); }
[[gnu::target("arch=x86-64-v3")]] inline unsigned sign_bits(__m256d a) { return static_cast<unsigned>(_mm256_movemask_pd(a)); }
[[gnu::target("arch=x86-64-v4")]] inline unsigned sign_bits(__m512d a) {
  return static_cast<unsigned>(_mm512_movepi64_mask(_mm512_castpd_si512(a)));
}
#endif

#define SAGITTA_LANES(n, made_for)                                                                                     \
  template <>                                                                                                          \
  struct alignas(n * sizeof(double)) Mask<n> {                                                                         \
    using Bits [[gnu::vector_size(n * sizeof(double))]] = std::int64_t;                                                \
    using Doubles [[gnu::vector_size(n * sizeof(double))]] = double;                                                   \
    Bits bits; /* -1 where true */                                                                                     \
                                                                                                                       \
    made_for friend inline Mask operator&(const Mask& a, const Mask& b) { return {a.bits & b.bits}; }                  \
    made_for friend inline Mask operator|(const Mask& a, const Mask& b) { return {a.bits | b.bits}; }                  \
    made_for friend inline Mask operator!(const Mask& a) { return {~a.bits}; }                                         \
    made_for friend inline bool all(const Mask& a) { return sign_bits((Doubles)a.bits) == (1u << n) - 1; }             \
  };                                                                                                                   \
                                                                                                                       \
  template <>                                                                                                          \
  struct alignas(n * sizeof(double)) Lanes<n> {                                                                        \
    using Vector [[gnu::vector_size(n * sizeof(double))]] = double;                                                    \
    using Integers [[gnu::vector_size(n * sizeof(std::int32_t))]] = std::int32_t;                                      \
    Vector of;                                                                                                         \
                                                                                                                       \
    Lanes() = default;                                                                                                 \
    made_for inline Lanes(double all) : of(all - Vector{}) {} /* (x - 0 is x, -0 too) */                               \
    made_for inline explicit Lanes(const Vector& given) : of(given) {}                                                 \
                                                                                                                       \
    made_for friend inline Lanes operator+(const Lanes& a, const Lanes& b) { return Lanes(a.of + b.of); }              \
    made_for friend inline Lanes operator-(const Lanes& a, const Lanes& b) { return Lanes(a.of - b.of); }              \
    made_for friend inline Lanes operator-(const Lanes& a) { return Lanes(-a.of); }                                    \
    made_for friend inline Lanes operator*(const Lanes& a, const Lanes& b) { return Lanes(a.of * b.of); }              \
    made_for friend inline Lanes operator/(const Lanes& a, const Lanes& b) { return Lanes(a.of / b.of); }              \
    made_for friend inline Mask<n> operator<(const Lanes& a, const Lanes& b) { return {a.of < b.of}; }                 \
    made_for friend inline Mask<n> operator<=(const Lanes& a, const Lanes& b) { return {a.of <= b.of}; }               \
    made_for friend inline Mask<n> operator>(const Lanes& a, const Lanes& b) { return {a.of > b.of}; }                 \
    made_for friend inline Mask<n> operator>=(const Lanes& a, const Lanes& b) { return {a.of >= b.of}; }               \
    made_for friend inline Mask<n> operator==(const Lanes& a, const Lanes& b) { return {a.of == b.of}; }               \
    made_for friend inline Lanes sqrt(const Lanes& a) {                                                                \
      Vector root;                                                                                                     \
      for (int i = 0; i < n; ++i) root[i] = std::sqrt(a.of[i]); /* becomes one instruction */                          \
      return Lanes(root);                                                                                              \
    }                                                                                                                  \
    made_for friend inline Lanes abs(const Lanes& a) {                                                                 \
      using Bits = typename Mask<n>::Bits;                                                                             \
      return Lanes((Vector)((Bits)a.of & (Bits{} + std::numeric_limits<std::int64_t>::max())));                        \
    }                                                                                                                  \
    made_for friend inline Lanes either(const Mask<n>& condition, const Lanes& a, const Lanes& b) {                    \
      return Lanes(condition.bits ? a.of : b.of);                                                                      \
    }                                                                                                                  \
    made_for friend inline Lanes negated(const Mask<n>& condition, const Lanes& a) {                                   \
      using Bits = typename Mask<n>::Bits;                                                                             \
      return Lanes((Vector)((Bits)a.of ^ (condition.bits & (Bits{} + std::numeric_limits<std::int64_t>::min()))));     \
    }                                                                                                                  \
                                                                                                                       \
    /* From and to the next n numbers in memory. */                                                                    \
    made_for static inline Lanes load(const double* from) {                                                            \
      Lanes result;                                                                                                    \
      std::memcpy(&result.of, from, sizeof result.of);                                                                 \
      return result;                                                                                                   \
    }                                                                                                                  \
    made_for static inline Lanes load(const std::int32_t* from) {                                                      \
      Integers integers;                                                                                               \
      std::memcpy(&integers, from, sizeof integers);                                                                   \
      return Lanes(__builtin_convertvector(integers, Vector));                                                         \
    }                                                                                                                  \
    made_for inline void store(double* to) const { std::memcpy(to, &of, sizeof of); }                                  \
    made_for inline void store(std::int32_t* to) const {                                                               \
      const Integers integers = __builtin_convertvector(of, Integers);                                                 \
      std::memcpy(to, &integers, sizeof integers);                                                                     \
    }                                                                                                                  \
  };

SAGITTA_LANES(2, )
#if defined(__x86_64__)
SAGITTA_LANES(4, [[gnu::target("arch=x86-64-v3")]])
SAGITTA_LANES(8, [[gnu::target("arch=x86-64-v4")]])
#endif
#undef SAGITTA_LANES

// Two of them as one number: two chains of operations that do not wait for each other.
template <class M>
struct MaskTwice {
  M first, second;

  friend MaskTwice operator&(const MaskTwice& a, const MaskTwice& b) { return {a.first & b.first, a.second & b.second}; }
  friend MaskTwice operator|(const MaskTwice& a, const MaskTwice& b) { return {a.first | b.first, a.second | b.second}; }
  friend MaskTwice operator!(const MaskTwice& a) { return {!a.first, !a.second}; }
  friend bool all(const MaskTwice& a) { return all(a.first) & all(a.second); }
};
template <int n>
struct TwiceLanes {
  using Half = Lanes<n>;
  using Masks = MaskTwice<Mask<n>>;
  Half first, second;

  TwiceLanes() = default;
  TwiceLanes(double all) : first(all), second(all) {}
  TwiceLanes(const Half& a, const Half& b) : first(a), second(b) {}

  friend TwiceLanes operator+(const TwiceLanes& a, const TwiceLanes& b) { return {a.first + b.first, a.second + b.second}; }
  friend TwiceLanes operator-(const TwiceLanes& a, const TwiceLanes& b) { return {a.first - b.first, a.second - b.second}; }
  friend TwiceLanes operator-(const TwiceLanes& a) { return {-a.first, -a.second}; }
  friend TwiceLanes operator*(const TwiceLanes& a, const TwiceLanes& b) { return {a.first * b.first, a.second * b.second}; }
  friend TwiceLanes operator/(const TwiceLanes& a, const TwiceLanes& b) { return {a.first / b.first, a.second / b.second}; }
  friend Masks operator<(const TwiceLanes& a, const TwiceLanes& b) { return {a.first < b.first, a.second < b.second}; }
  friend Masks operator<=(const TwiceLanes& a, const TwiceLanes& b) { return {a.first <= b.first, a.second <= b.second}; }
  friend Masks operator>(const TwiceLanes& a, const TwiceLanes& b) { return {a.first > b.first, a.second > b.second}; }
  friend Masks operator>=(const TwiceLanes& a, const TwiceLanes& b) { return {a.first >= b.first, a.second >= b.second}; }
  friend Masks operator==(const TwiceLanes& a, const TwiceLanes& b) { return {a.first == b.first, a.second == b.second}; }
  friend TwiceLanes sqrt(const TwiceLanes& a) { return {sqrt(a.first), sqrt(a.second)}; }
  friend TwiceLanes abs(const TwiceLanes& a) { return {abs(a.first), abs(a.second)}; }
  friend TwiceLanes either(const Masks& condition, const TwiceLanes& a, const TwiceLanes& b) {
    return {either(condition.first, a.first, b.first), either(condition.second, a.second, b.second)};
  }
  friend TwiceLanes negated(const Masks& condition, const TwiceLanes& a) {
    return {negated(condition.first, a.first), negated(condition.second, a.second)};
  }
  template <class Number>
  static TwiceLanes load(const Number* from) { return {Half::load(from), Half::load(from + n)}; }
  template <class Number>
  void store(Number* to) const { first.store(to), second.store(to + n); }
};

// a where the condition holds, else b: of one number, and of each lane. negate_where: -a where it holds, else a.
template <class T, class Condition>
T select(const Condition& condition, const T& a, const T& b) {
  if constexpr (std::is_convertible_v<Condition, bool>) return condition ? a : b;
  else return either(condition, a, b);
}
template <class T, class Condition>
T negate_where(const Condition& condition, const T& a) {
  if constexpr (std::is_convertible_v<Condition, bool>) return condition ? T(-a) : a;
  else return negated(condition, a);
}
inline bool all(bool condition) { return condition; }

}  // namespace sagitta::numerics

template <int n>
struct std::numeric_limits<sagitta::numerics::Lanes<n>> : std::numeric_limits<double> {};
template <int n>
struct std::numeric_limits<sagitta::numerics::TwiceLanes<n>> : std::numeric_limits<double> {};
