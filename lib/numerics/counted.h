// SPDX-License-Identifier: Apache-2.0
// A double that counts what is done with it: templates of a number type tell with it how many operations they take.
//
// What is counted are +, -, *, /, sqrt and log in which a number takes part that varies from ray to ray. Constants among
// themselves (a number made from a double is one) are worked out once for many rays; signs, comparisons and choices cost
// next to nothing beside the rest, and are not counted.
#pragma once

#include <cmath>
#include <limits>

namespace sagitta::numerics {

struct Operations {
  int sums_and_products = 0, divisions = 0, roots = 0, logarithms = 0;

  friend Operations operator+(const Operations& a, const Operations& b) {
    return {a.sums_and_products + b.sums_and_products, a.divisions + b.divisions, a.roots + b.roots, a.logarithms + b.logarithms};
  }
  friend Operations operator-(const Operations& a, const Operations& b) {
    return {a.sums_and_products - b.sums_and_products, a.divisions - b.divisions, a.roots - b.roots, a.logarithms - b.logarithms};
  }
  friend Operations operator*(int times, const Operations& a) {
    return {times * a.sums_and_products, times * a.divisions, times * a.roots, times * a.logarithms};
  }
  friend bool operator==(const Operations&, const Operations&) = default;
};

class Counted {
 public:
  constexpr Counted(double constant = 0) : value_(constant) {}
  static Counted varying(double value) { return {value, true}; }
  explicit operator double() const { return value_; }

  // What is done on this thread meanwhile.
  template <class Work>
  static Operations operations_of(const Work& work) {
    const Operations before = done_;
    work();
    return done_ - before;
  }

  friend Counted operator+(Counted a, Counted b) { return {a.value_ + b.value_, count(&Operations::sums_and_products, a, b)}; }
  friend Counted operator-(Counted a, Counted b) { return {a.value_ - b.value_, count(&Operations::sums_and_products, a, b)}; }
  friend Counted operator*(Counted a, Counted b) { return {a.value_ * b.value_, count(&Operations::sums_and_products, a, b)}; }
  friend Counted operator/(Counted a, Counted b) { return {a.value_ / b.value_, count(&Operations::divisions, a, b)}; }
  friend Counted sqrt(Counted a) { return {std::sqrt(a.value_), count(&Operations::roots, a, a)}; }
  friend Counted log(Counted a) { return {std::log(a.value_), count(&Operations::logarithms, a, a)}; }
  friend Counted operator-(Counted a) { return {-a.value_, a.varies_}; }
  friend Counted abs(Counted a) { return {std::abs(a.value_), a.varies_}; }
  Counted& operator+=(Counted b) { return *this = *this + b; }
  Counted& operator-=(Counted b) { return *this = *this - b; }
  Counted& operator*=(Counted b) { return *this = *this * b; }
  friend bool operator==(Counted a, Counted b) { return a.value_ == b.value_; }
  friend auto operator<=>(Counted a, Counted b) { return a.value_ <=> b.value_; }

 private:
  constexpr Counted(double value, bool varies) : value_(value), varies_(varies) {}
  static bool count(int Operations::*kind, Counted a, Counted b) {
    const bool varies = a.varies_ || b.varies_;
    done_.*kind += varies;
    return varies;
  }

  static inline thread_local Operations done_;
  double value_;
  bool varies_ = false;
};

}  // namespace sagitta::numerics

template <>
struct std::numeric_limits<sagitta::numerics::Counted> : std::numeric_limits<double> {};
