// SPDX-License-Identifier: Apache-2.0
// Vectors of three numbers of any arithmetic type T (double, a 50-digit type, a dual number).
// No optics here: positions, directions and normals are all Vec3.
#pragma once

#include <cmath>

namespace sagitta::numerics {

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(const T& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

template <class T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
T norm(const Vec3<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

template <class T>
Vec3<T> normalized(const Vec3<T>& a) {
  return (T(1) / norm(a)) * a;
}

// Angle between two directions in radians. atan2 of the cross product keeps full precision at small angles, where
// acos of the dot product has a floor of 1e-8.
template <class T>
T angle_between(const Vec3<T>& a, const Vec3<T>& b) {
  using std::atan2;
  return atan2(norm(cross(a, b)), dot(a, b));
}

// The same vector in another number type.
template <class To, class From>
constexpr Vec3<To> vec3_cast(const Vec3<From>& a) {
  return {To(a.x), To(a.y), To(a.z)};
}

}  // namespace sagitta::numerics
