// SPDX-License-Identifier: Apache-2.0
#include "lib/study/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>
#include <variant>

#include "lib/numerics/parallel.h"
#include "lib/study/fifty_digits_internal.h"
#include "lib/study/through_internal.h"

namespace sagitta::study {
namespace {

using surface::is_analytic;

// An analytic shape with a roughness on its sag.
template <class S>
struct Rough {
  const S& shape;
  const Roughness& roughness;

  template <class T>
  surface::Height<T> height(const T& x, const T& y) const {
    using std::abs;
    const T sag = shape.sag(x, y);
    const surface::Gradient<T> slope = shape.gradient(x, y);
    const surface::Height<T> rough = roughness.height(x, y);
    return {sag + rough.z, slope.x + rough.dz_dx, slope.y + rough.dz_dy, abs(sag) + rough.magnitude};
  }
};

template <class T>
surface::Crossing<T> meet(const surface::Shape& shape, const Roughness* roughness, const Vec3<T>& p, const Vec3<T>& d) {
  return std::visit([&]<class S>(const S& of) -> surface::Crossing<T> {
    if constexpr (is_analytic<S>) {
      const surface::Crossing<T> bare = of.meet(p, d);
      if (!roughness || bare.status != Status::ok) return bare;
      return surface::meet_from(bare.path, bare.point, bare.along > T(0), Rough<S>{of, *roughness}, d);
    } else {
      return surface::no_crossing<T>(Status::not_converged);  // never asked: true_rays() has refused it
    }
  }, shape);
}

template <class T>
TrueRay stored(const Path<T>& ray) {
  const auto rounded = [](const Vec3<T>& v) {
    return Vec3<long double>{static_cast<long double>(v.x), static_cast<long double>(v.y), static_cast<long double>(v.z)};
  };
  return {rounded(ray.position), rounded(ray.direction), ray.ended};
}

template <class T>
void trace_exactly(const scene::Scene& scene, const scene::Wavelength& wavelength, const TrueRaysRequest& request, const trace::RayBatch& launched,
                   std::size_t i, TrueRays& rays) {
  Path<T> ray{numerics::vec3_cast<T>(launched.position(i)), numerics::normalized(numerics::vec3_cast<T>(launched.direction(i))), launched.ended[i]};
  for (int number = 1; number <= scene.surface_count(); ++number) {
    const bool is_studied = number == request.surface_number;
    const auto gap = static_cast<std::size_t>(number);
    if (wavelength.has_gradient_at(number)) {
      if (ray.ended == 0) ray = through_gradient(scene.surface(number), number, wavelength, ray).behind;
      continue;
    }
    ray = through(scene.surface(number), number, wavelength.index[gap - 1], wavelength.index[gap], ray, [&](const Vec3<T>& p, const Vec3<T>& d) {
      return meet(scene.surface(number).shape, is_studied ? request.roughness : nullptr, p, d);
    });
    if (is_studied) rays.at_surface[i] = stored(ray);
  }
  rays.at_image[i] = stored(ray);
}

}  // namespace

TrueRaysResult true_rays(const scene::Scene& scene, const scene::Wavelength& wavelength, const scene::Field& field,
                         std::span<const trace::PupilPoint> pupil, const TrueRaysRequest& request) {
  if (!(request.surface_number >= 1 && request.surface_number <= scene.surface_count()))
    return {{}, fmt::format("there is no surface {}: the system has 1 to {}", request.surface_number, scene.surface_count())};
  for (int number = 1; number <= scene.surface_count(); ++number)
    if (!std::visit([]<class S>(const S&) { return is_analytic<S>; }, scene.surface(number).shape))
      return {{}, fmt::format("surface {} is made of points ({}), which have no exact rays: it must be a plane, a conic or a zernike surface", number,
                              surface::kernel_name(scene.surface(number).shape))};
  if (wavelength.has_gradient_at(request.surface_number))
    return {{}, fmt::format("a gradient-index medium begins or ends at surface {}, and only surfaces between media of one index can be studied", request.surface_number)};
  const trace::RayBatch launched = trace::launch(scene, field, wavelength, pupil, false);
  TrueRays rays{std::vector<TrueRay>(launched.size()), std::vector<TrueRay>(launched.size())};
  constexpr std::size_t block_size = 64;
  numerics::share_blocks((launched.size() + block_size - 1) / block_size, request.thread_count, [&] {
    return [&](std::size_t block) {
      for (std::size_t i = block * block_size; i < std::min(launched.size(), (block + 1) * block_size); ++i) {
        if (request.digits == Digits::fifty) trace_exactly<FiftyDigits>(scene, wavelength, request, launched, i, rays);
        else trace_exactly<long double>(scene, wavelength, request, launched, i, rays);
      }
    };
  });
  return {std::move(rays), {}};
}

}  // namespace sagitta::study
