// SPDX-License-Identifier: Apache-2.0
// The batch kernel against an independent tracer in 50 digits, on random systems.
//
// The bound of a ray's error is derived for that ray. Its state behind surface k carries the local error
//   |dp| = C eps S / cos i,   |dd| = C eps (1 + kappa S / cos i) / cos t,   C = 64,                                  (1)
// where S is the size of the numbers that make the hit (local coordinates and path), kappa the largest change of the
// surface's slope per mm there, i and t the angles of incidence and refraction: a hit is t = (terms of size S) / (slope
// of the surface along the ray), a direction has the rounding of the normal and of the root that is cos t. C: the
// longest way through transform, meet and refract is some 40 operations, and Newton's method may stop at 64 roundings of
// its terms. Each of the six errors (1) is sent to the end of the system by the long double tracer (its own rounding is
// 2000 times smaller), and the moduli of what they make there are added up.
#include <boost/multiprecision/cpp_dec_float.hpp>

#include <array>
#include <limits>

#include "tests/support/oracle_trace.h"
#include "tests/support/random_system.h"

namespace sagitta::test {
namespace {

using Digits50 = boost::multiprecision::number<boost::multiprecision::cpp_dec_float<50>, boost::multiprecision::et_off>;
using Long = long double;

constexpr double eps = std::numeric_limits<double>::epsilon();

template <class T>
OracleRay<T> start_of(const GlobalRay& ray) {
  return {vec3_cast<T>(ray.p), vec3_cast<T>(ray.d)};
}

struct Bound {
  double position = 0, direction = 0, opl = 0;
};

// Largest change per mm of the unit normal at a local point.
double normal_change(const surface::Shape& shape, const Vec3<Long>& hit) {
  const auto normal = [&](Long x, Long y) {
    const auto g = std::visit([&](const auto& one) { return one.template gradient<Long>(x, y); }, shape);
    return numerics::normalized(Vec3<Long>{-g.x, -g.y, 1});
  };
  const Long h = 1e-6L;
  const Vec3<Long> n = normal(hit.x, hit.y);
  return static_cast<double>((norm(normal(hit.x + h, hit.y) - n) + norm(normal(hit.x, hit.y + h) - n)) / h);
}

// The ends of a ray that is moved a little in one of its six coordinates behind surface k.
Bound error_bound(const std::vector<OracleSurface<Long>>& system, const GlobalRay& given) {
  OracleRay<Long> state = start_of<Long>(given);
  const OracleRay<Long> end = oracle_trace(system, state);
  Bound bound;
  for (int k = 0; k <= static_cast<int>(system.size()) && state.status == Status::ok; ++k) {
    double position_error = 4 * eps * static_cast<double>(norm(state.p)), direction_error = 4 * eps;
    if (k > 0) {
      const OracleSurface<Long>& s = system[static_cast<std::size_t>(k - 1)];
      const OracleRay<Long> before = state;
      oracle_step(s, k, state);
      if (state.status != Status::ok) break;
      const Vec3<Long> v = state.p - s.vertex;
      const Vec3<Long> hit{dot(v, s.ex), dot(v, s.ey), dot(v, s.ez)};
      const auto g = std::visit([&](const auto& one) { return one.template gradient<Long>(hit.x, hit.y); }, *s.shape);
      const Vec3<Long> normal = numerics::normalized(-g.x * s.ex + -g.y * s.ey + s.ez);
      const double cos_i = static_cast<double>(std::abs(dot(normal, before.d))), cos_t = static_cast<double>(std::abs(dot(normal, state.d)));
      const double size = static_cast<double>(norm(before.p - s.vertex) + norm(hit) + std::abs(state.opl - before.opl) + norm(s.vertex));
      position_error = 64 * eps * size / cos_i;
      direction_error = 64 * eps * (1 + normal_change(*s.shape, hit) * size / cos_i) / cos_t;
    }
    for (int i = 0; i < 6; ++i) {
      // a step a thousand times the error, for the derivative; long double has 11 bits more than double
      const Long step = 1000 * (i < 3 ? position_error : direction_error);
      OracleRay<Long> moved = state;
      std::array<Long*, 6> coordinates{&moved.p.x, &moved.p.y, &moved.p.z, &moved.d.x, &moved.d.y, &moved.d.z};
      *coordinates[static_cast<std::size_t>(i)] += step;
      moved.d = numerics::normalized(moved.d);
      const OracleRay<Long> other = oracle_trace(system, moved, k + 1);
      bound.position += static_cast<double>(norm(other.p - end.p)) / 1000;
      bound.direction += static_cast<double>(norm(other.d - end.d)) / 1000;
      bound.opl += static_cast<double>(std::abs(other.opl - end.opl)) / 1000;
    }
    bound.opl += 4 * eps * static_cast<double>(std::abs(state.opl));
  }
  return bound;
}

// Do rays within 1e-9 of the given one end in both ways? Then the two tracers may differ: a threshold runs between them.
bool at_threshold(const std::vector<OracleSurface<Long>>& system, const GlobalRay& given, Uniform& u) {
  const OracleRay<Long> here = oracle_trace(system, start_of<Long>(given));
  for (int i = 0; i < 200; ++i) {
    OracleRay<Long> near = start_of<Long>(given);
    near.p = near.p + Vec3<Long>{u(-1e-9, 1e-9), u(-1e-9, 1e-9), 0};
    const OracleRay<Long> there = oracle_trace(system, near);
    if (there.status != here.status || there.ended_at != here.ended_at) return true;
  }
  return false;
}

// The number of the last surface where a ray that ended was: the one that ended it, if it came there, else the last before it that trace() does not pass by.
int last_met(const scene::Scene& scene, const scene::Wavelength& wavelength, const OracleRay<Digits50>& ray) {
  if (ray.status == Status::ok || ray.status == Status::clipped || ray.status == Status::total_reflection) return ray.ended_at;
  int number = ray.ended_at - 1;
  while (number > 0 && scene.surface(number).does_nothing(wavelength.index[static_cast<std::size_t>(number - 1)], wavelength.index[static_cast<std::size_t>(number)])) --number;
  return number;
}

TEST(Kernel, agrees_with_50_digits_on_random_systems) {
  Uniform u(20260101);
  int arrived = 0, lost = 0, differing = 0, sharp = 0;
  double worst_ratio = 0;
  std::array<int, surface::status_count> of{};
  for (int system_number = 0; system_number < 1000; ++system_number) {
    const prescription::Model model = random_model(u);
    const CompiledScene compiled = checked(scene::compile(model));
    const scene::Scene& scene = compiled.scene;
    const std::vector<GlobalRay> rays = random_rays(u, 4);
    trace::RayBatch batch = batch_of(rays);
    trace::trace(scene, compiled.wavelength(), batch);
    const auto exact_system = oracle_system<Digits50>(model, scene);
    const auto long_system = oracle_system<Long>(model, scene);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      OracleRay<Digits50> exact = oracle_trace(exact_system, start_of<Digits50>(rays[i]));
      ++of[static_cast<std::size_t>(exact.status)];
      if (exact.status != batch.status(i) || exact.ended_at != batch.ended_at(i)) {
        EXPECT_TRUE(at_threshold(long_system, rays[i], u)) << "system " << system_number << " ray " << i << ": "
            << static_cast<int>(exact.status) << " at " << exact.ended_at << ", not " << batch.ended[i];
        ++differing;
        continue;
      }
      // A lost ray too has its last good position, direction and OPL; where it meets nothing, those behind the last surface that is not passed by.
      const GlobalRay ours = global_ray(scene, batch, i);
      if (const int met = last_met(scene, compiled.wavelength(), exact); met < exact.ended_at - 1) {
        const Status status = exact.status;
        exact = oracle_trace({exact_system.begin(), exact_system.begin() + met}, start_of<Digits50>(rays[i]));
        exact.status = status;
      }
      const Bound bound = error_bound(long_system, rays[i]);
      const double position = static_cast<double>(norm(vec3_cast<Digits50>(ours.p) - exact.p));
      const double direction = static_cast<double>(norm(vec3_cast<Digits50>(ours.d) - exact.d));
      const double opl = static_cast<double>(abs(Digits50(batch.optical_path_length(i)) - exact.opl));
      // 40 eps: the turn back into the global frame
      EXPECT_LE(position, bound.position + 40 * eps * (20 + norm(ours.p))) << "system " << system_number << " ray " << i;
      EXPECT_LE(direction, bound.direction + 40 * eps) << "system " << system_number << " ray " << i;
      EXPECT_LE(opl, bound.opl + 4 * eps * (20 + std::abs(batch.opl[i]))) << "system " << system_number << " ray " << i;
      worst_ratio = std::max(worst_ratio, position / (bound.position + 40 * eps * (20 + norm(ours.p))));
      sharp += bound.position < 1e-10 && bound.direction < 1e-10 && bound.opl < 1e-10;
      ++(exact.status == Status::ok ? arrived : lost);
    }
  }
  for (std::size_t i = 0; i < of.size(); ++i) RecordProperty(std::string(surface::status_names[i]), of[i]);
  RecordProperty("worst_error_over_bound", std::to_string(worst_ratio));
  EXPECT_EQ(arrived + lost + differing, 4000);
  EXPECT_GE(arrived, 2500);
  EXPECT_GE(lost, 900);
  EXPECT_LE(differing, 2);
  EXPECT_GE(sharp, 3900);  // the bound is no excuse: nearly always below 1e-10
  EXPECT_GE(of[static_cast<std::size_t>(Status::missed)], 80);
  EXPECT_GE(of[static_cast<std::size_t>(Status::clipped)], 700);
  EXPECT_GE(of[static_cast<std::size_t>(Status::total_reflection)], 15);
}

// Wilder: radii from 1 mm, tilts to 180 degrees, rays from everywhere. Statuses are compared, not digits.
TEST(Kernel, statuses_agree_with_long_double_on_wild_systems) {
  Uniform u(77);
  int differing = 0, count = 0;
  std::array<int, surface::status_count> of{};
  for (int system_number = 0; system_number < 3000; ++system_number) {
    prescription::Model model = random_model(u);
    for (auto& surface : model.surfaces) {
      if (u() < 0.2) surface.shape = conic_shape(std::copysign(std::pow(10, u(0, 3)), u(-1, 1)), u(-20, 5));
      if (u() < 0.1) surface.tilt_deg = {u(-180, 180), u(-180, 180), u(-180, 180)};
    }
    const CompiledScene compiled = checked(scene::compile(model));
    std::vector<GlobalRay> rays = random_rays(u, 10);
    for (GlobalRay& ray : rays)
      if (u() < 0.5) ray.d = numerics::normalized(Vec3<double>{u(-1, 1), u(-1, 1), u(-1, 1)});
    trace::RayBatch batch = batch_of(rays);
    trace::trace(compiled.scene, compiled.wavelength(), batch);
    const auto system = oracle_system<Long>(model, compiled.scene);
    EXPECT_EQ(count_statuses(batch).total(), 10);
    for (std::size_t i = 0; i < rays.size(); ++i, ++count) {
      for (const auto* column : {&batch.x, &batch.y, &batch.z, &batch.l, &batch.m, &batch.n, &batch.opl})
        EXPECT_TRUE(std::isfinite((*column)[i])) << "system " << system_number << " ray " << i;
      EXPECT_NEAR(norm(batch.direction(i)), 1, 16 * eps * static_cast<double>(model.surfaces.size()));
      ++of[static_cast<std::size_t>(batch.status(i))];
      const OracleRay<Long> expected = oracle_trace(system, start_of<Long>(rays[i]));
      if (expected.status == batch.status(i) && expected.ended_at == batch.ended_at(i)) continue;
      ++differing;
      EXPECT_TRUE(at_threshold(system, rays[i], u)) << "system " << system_number << " ray " << i << ": "
          << static_cast<int>(expected.status) << " at " << expected.ended_at << ", not " << batch.ended[i];
    }
  }
  EXPECT_EQ(count, 30000);
  EXPECT_LE(differing, 30);
  EXPECT_GE(of[0], 9000);
  EXPECT_GE(of[1], 8000);
  EXPECT_GE(of[2], 5000);
  EXPECT_GE(of[3], 1000);
  EXPECT_GE(of[5], 300);
}

}  // namespace
}  // namespace sagitta::test
