// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "lib/scene/compile.h"
#include "lib/surface/block.h"
#include "lib/trace/gradient_step.h"
#include "lib/trace/launch.h"
#include "lib/trace/pattern.h"
#include "lib/trace/step.h"
#include "lib/trace/trace.h"

namespace sagitta::analysis {
namespace {

using numerics::Counted, numerics::Operations, numerics::Vec3;
using trace::Deflection, trace::StepKind;

// The way of one ray through one surface.
struct Passage {
  int number = 0;
  const scene::Surface* surface = nullptr;
  double index_before = 1, index_after = 1;
  bool is_passed_by = false, is_shift = true;
  bool is_reached = false;            // by the ray
  Vec3<double> position{}, direction{};  // of the ray before, in the frame of the surface before
  std::optional<double> gradient_steps{};
  const scene::Wavelength* wavelength = nullptr;
  gradient_index::Tolerance tolerance{};

  bool is_in_gradient() const { return wavelength->has_gradient_at(number); }

  Deflection deflection() const { return trace::deflection_at(*surface, index_before, index_after); }
};

// An ordinary ray, before the chief ray: along the axis iterations end at once.
trace::RayBatch sample_ray(const scene::Scene& open) {
  const std::vector<trace::PupilPoint> points{{0.5, 0.5}, {0, 0.7}, {-0.5, 0}, {0, -0.9}, {0, 0}};
  const scene::Wavelength& wavelength = open.wavelengths.front();
  trace::RayBatch first;
  for (const trace::PupilPoint& point : points)
    for (const scene::Field& field : open.fields) {
      const trace::RayBatch launched = trace::launch(open, field, wavelength, {&point, 1});
      trace::RayBatch traced = launched;
      trace::trace(open, wavelength, traced);
      if (traced.ended[0] == 0) return launched;
      if (first.size() == 0) first = launched;
    }
  return first;
}

// Of some rays of every field at the first wavelength, in the gap before a surface.
std::optional<double> mean_gradient_steps(const scene::Scene& open, int number) {
  const scene::Wavelength& wavelength = open.wavelengths.front();
  const scene::GradientGap* gap = wavelength.gradient(number - 1);
  if (!gap) return std::nullopt;
  int count = 0, steps = 0;
  for (const scene::Field& field : open.fields) {
    trace::RayBatch rays = trace::launch(open, field, wavelength, trace::pupil_points({trace::PatternKind::hexapolar}, 60), false);
    for (int before = 1; before < number; ++before) trace_surface(open, wavelength, before, rays);
    const scene::Surface& surface = open.surface(number);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (rays.ended[i] != 0) continue;
      steps += trace::travel(surface, *gap, open.tolerance, surface.local_from_previous * rays.position(i), surface.local_from_previous.rotation * rays.direction(i)).steps;
      ++count;
    }
  }
  return count > 0 ? std::optional(static_cast<double>(steps) / count) : std::nullopt;
}

std::vector<Passage> passages_of(const scene::Scene& scene) {
  scene::Scene open = scene;
  for (scene::Surface& surface : open.surfaces) surface.inner_semi_diameter = 0, surface.semi_diameter = std::numeric_limits<double>::infinity();
  trace::RayBatch ray = sample_ray(open);
  std::vector<Passage> passages;
  bool has_passed = false, is_shift = true;
  for (int number = 1; number <= scene.surface_count(); ++number) {
    const scene::Surface& surface = scene.surface(number);
    const auto gap = static_cast<std::size_t>(number);
    Passage at{.number = number, .surface = &surface};
    at.is_passed_by = true;
    for (const scene::Wavelength& wavelength : scene.wavelengths) {
      const double before = wavelength.index[gap - 1], after = wavelength.index[gap];
      at.is_passed_by = at.is_passed_by && surface.does_nothing(before, after);
      if (at.index_before == at.index_after) at.index_before = before, at.index_after = after;
    }
    is_shift = at.is_shift = surface.centred && (!has_passed || is_shift);
    has_passed = at.is_passed_by;
    at.is_reached = ray.ended[0] == 0;
    at.position = ray.position(0), at.direction = ray.direction(0);
    at.wavelength = &scene.wavelengths.front(), at.tolerance = scene.tolerance;
    at.gradient_steps = mean_gradient_steps(open, number);
    trace_surface(open, open.wavelengths.front(), number, ray);
    passages.push_back(at);
  }
  return passages;
}

// A way to take a ray through a surface: what is done, or what might have been.
struct Way {
  const surface::Shape& shape;
  StepKind kind;
  bool is_shift;
};
Way way_of(const Passage& at, bool has_opl) { return {at.surface->shape, {at.deflection(), has_opl, at.surface->has_apertures()}, at.is_shift}; }

// As trace/kernel.cc does it.
Operations operations_of(const Passage& at, const Way& way) {
  const auto varying = [](const Vec3<double>& v) { return Vec3<Counted>{Counted::varying(v.x), Counted::varying(v.y), Counted::varying(v.z)}; };
  const trace::StepSetting setting = trace::StepSetting::of(*at.surface, at.number, at.index_before, at.index_after);
  const double shift = way.is_shift ? at.surface->local_from_previous.translation.z : -0.0;
  if (at.is_in_gradient()) {
    const trace::Ray<Counted> ray{varying(at.position), varying(at.direction), Counted::varying(0), 0};
    return Counted::operations_of([&] { step_in_gradient(*at.surface, at.number, *at.wavelength, at.tolerance, entered(at.surface->local_from_previous, ray)); });
  }
  return Counted::operations_of([&] {
    trace::Ray<Counted> ray{varying(at.position), varying(at.direction), Counted::varying(0), 0};
    if (!way.is_shift) ray = entered(at.surface->local_from_previous, ray);
    std::visit([&]<class S>(const S& shape) {
      const auto go_on = [&]<bool has_unit_normals>(const surface::Crossing<Counted>& crossing) {
        with_kind(way.kind, [&]<StepKind kind>() { trace::step<kind, has_unit_normals>(setting, ray, crossing); });
      };
      if constexpr (surface::has_closed_form<S>) {
        shift_along_z(shift, ray);
        go_on.template operator()<surface::has_unit_normals<S>>(shape.meet(ray.position, ray.direction));
      } else {
        const auto met = shape.meet(Vec3<Counted>{ray.position.x, ray.position.y, ray.position.z + Counted(shift)}, ray.direction);
        shift_along_z(shift, ray);
        go_on.template operator()<false>(trace::crossing_by_slopes<Counted>(met.path, met.point, -met.normal.x, -met.normal.y, ray.direction, met.status));
      }
    }, way.shape);
  });
}

// Of a plane that is passed by, only whether the ray is parallel to it.
Operations operations_of_passing_by(const Passage& at) {
  const Vec3<double>& d = at.direction;
  const Vec3<Counted> axis{0, 0, 1}, direction{Counted::varying(d.x), Counted::varying(d.y), Counted::varying(d.z)};
  return Counted::operations_of([&] { dot(axis, direction); });
}

std::string kernel_of(const Passage& at) {
  const std::string shape = kernel_name(at.surface->shape);
  if (at.gradient_steps) return fmt::format("{} in a gradient: {:.1f} steps", shape, *at.gradient_steps);
  return at.is_in_gradient() ? shape + ", ray by ray" : shape;
}

constexpr std::size_t bytes_of_columns(bool has_opl) { return (has_opl ? 7 : 6) * sizeof(double) + sizeof(std::int32_t); }

std::size_t bytes_per_ray(const Passage& at, bool has_opl) {
  if (at.is_passed_by) return 3 * sizeof(double) + sizeof(std::int32_t);
  std::size_t bytes = 2 * bytes_of_columns(has_opl);
  if (!at.is_shift) bytes += 2 * bytes_of_columns(false);
  const bool by_blocks = std::visit([]<class S>(const S&) { return !surface::has_closed_form<S>; }, at.surface->shape);
  constexpr std::size_t line = sizeof(surface::BlockOfLines) / surface::block_capacity;
  constexpr std::size_t crossing = sizeof(surface::BlockOfCrossings) / surface::block_capacity;
  if (by_blocks) bytes += bytes_of_columns(false) + 2 * line + 2 * crossing;
  return bytes;
}

std::string counted(int count, const char* one, const char* many) { return fmt::format("{} {}", count, count == 1 ? one : many); }

// "12 additions and multiplications, 1 root a ray"
std::string text_of(const Operations& operations) {
  std::string text;
  const auto say = [&](int count, const char* one, const char* many) {
    if (count != 0) text += (text.empty() ? "" : ", ") + counted(count, one, many);
  };
  say(operations.sums_and_products, "addition or multiplication", "additions and multiplications");
  say(operations.divisions, "division", "divisions");
  say(operations.roots, "root", "roots");
  say(operations.logarithms, "logarithm", "logarithms");
  return text.empty() ? "" : text + " a ray";
}

// "surface 4", "surfaces 1-3, 5"
std::string text_of(const std::vector<int>& numbers) {
  std::string text = numbers.size() == 1 ? "surface " : "surfaces ";
  for (std::size_t first = 0, last = 0; first < numbers.size(); first = last + 1) {
    for (last = first; last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1;) ++last;
    text += (first == 0 ? "" : ", ") + std::to_string(numbers[first]) + (last > first ? "-" + std::to_string(numbers[last]) : "");
  }
  return text;
}

// The same polynomial of the order that was given, in `coefficients`.
surface::Zernike with_zero_terms(const surface::Zernike& zernike, std::vector<double>& coefficients) {
  using numerics::Polynomial;
  coefficients.assign(Polynomial::count(zernike.given_order), 0);
  for (int i = 0; i <= zernike.order; ++i)
    for (int j = 0; i + j <= zernike.order; ++j)
      coefficients[Polynomial::place(zernike.given_order, i, j)] = zernike.polynomial.coefficients[Polynomial::place(zernike.order, i, j)];
  surface::Zernike result = zernike;
  result.polynomial = {zernike.given_order, coefficients.data()};
  return result;
}

class LeftOut {
 public:
  LeftOut(const scene::CompileResult& compiled, const JobRequest& request, const std::vector<Passage>& passages)
      : compiled_(compiled), request_(request), passages_(passages),
        result_count_(static_cast<int>(compiled.scene->fields.size() * compiled.scene->wavelengths.size())) {}

  std::vector<Omission> all() && {
    outputs();
    optical_paths();
    aiming();
    shapes();
    surfaces();
    if (const int count = compiled_.dispersive_gaps; count > 0)
      add("dispersion of the media in " + counted(count, "gap", "gaps"),
          "only " + counted(static_cast<int>(compiled_.scene->wavelengths.size()), "wavelength is traced", "wavelengths are traced"),
          "formulas and tables: what is kept are the indices there");
    for (const scene::CloudPart& part : compiled_.parts)
      if (part.used < part.points)
        add(fmt::format("{} of the {} points of surface {}", part.points - part.used, part.points, part.surface), "they lie outside the beam",
            "their triangles and patches");
    return std::move(found_);
  }

 private:
  void add(std::string what, std::string why, std::string saves) { found_.push_back({std::move(what), std::move(why), std::move(saves)}); }

  void outputs() {
    const std::string results = counted(result_count_, "field and wavelength", "fields and wavelengths");
    if (!request_.want_wavefront) {
      const int size = request_.wavefront.size;
      add("wavefronts: their rays, chief rays, reference spheres and exit pupils", "only spots are asked for",
          fmt::format("a grid of {} x {} rays for {}", size, size, results));
      add("wavefront.exr, wavefront.png", "only spots are asked for", counted(result_count_, "part", "parts") + " of the EXR file");
    }
    if (!request_.want_spot) {
      add("spots: their rays and pixels", "only wavefronts are asked for",
          fmt::format("{} rays for {}", trace::PupilStream(request_.pattern, request_.ray_count).size(), results));
      add("spot.exr, spot.png", "only wavefronts are asked for", counted(result_count_, "part", "parts") + " of the EXR file");
    }
  }

  void optical_paths() {
    if (!request_.want_spot) return;
    over_surfaces([&](const Passage& at) { return !at.is_passed_by; },
                  [&](const Passage& at) { return operations_of(at, way_of(at, true)) - operations_of(at, way_of(at, false)); },
                  [&](const std::vector<int>& numbers, const std::string& saves) {
                    const std::string bytes = fmt::format("{} bytes a ray", numbers.size() * 2 * sizeof(double));
                    add(request_.want_wavefront ? "optical path lengths of the spots' rays" : "optical path lengths",
                        request_.want_wavefront ? "spots do not need them" : "only spots are asked for", saves.empty() ? bytes : saves + ", " + bytes);
                  });
  }

  // The least that aiming would take: the way to the stop, once more.
  void aiming() {
    const scene::Scene& scene = *compiled_.scene;
    if (scene.pupil.is_of_stop) return;
    Operations sum;
    for (const Passage& at : passages_)
      if (at.number <= scene.stop && at.is_reached) sum = sum + (at.is_passed_by ? operations_of_passing_by(at) : operations_of(at, way_of(at, false)));
    add(fmt::format("aiming at the stop, surface {}", scene.stop), "pupil points are those of the paraxial entrance pupil", text_of(sum) + ", or a multiple");
  }

  // Kernels for more than the surface is.
  void shapes() {
    const bool has_opl = request_.want_wavefront;
    const auto saved_from = [&](const Passage& at, const surface::Shape& other) {
      const Way way = way_of(at, has_opl);
      return operations_of(at, Way{other, way.kind, way.is_shift}) - operations_of(at, way);
    };
    const auto names_of = [&](const Passage& at) {
      const auto given = compiled_.given.find(at.number);
      if (given == compiled_.given.end()) return std::pair<std::string, std::string>();
      return std::pair(kernel_name(given->second), kernel_name(at.surface->shape));
    };
    std::set<std::pair<std::string, std::string>> pairs;
    for (const Passage& at : passages_)
      if (!at.is_passed_by && compiled_.given.contains(at.number)) pairs.insert(names_of(at));
    for (const auto& names : pairs)
      over_surfaces([&](const Passage& at) { return !at.is_passed_by && names_of(at) == names; },
                    [&](const Passage& at) { return saved_from(at, compiled_.given.at(at.number)); },
                    [&](const std::vector<int>& numbers, const std::string& saves) {
                      add(fmt::format("kernel '{}' for {}", names.first, text_of(numbers)), fmt::format("'{}' makes the same surface", names.second), saves);
                    });
    for (const Passage& at : passages_) {
      const auto* zernike = std::get_if<surface::Zernike>(&at.surface->shape);
      if (!zernike || zernike->order == zernike->given_order) continue;
      std::string saves = "steps of the recurrence";
      if (zernike->is_polynomial && zernike->given_order <= numerics::highest_zernike_polynomial) {
        std::vector<double> coefficients;
        saves = at.is_reached ? text_of(saved_from(at, with_zero_terms(*zernike, coefficients))) : "";
      }
      add(fmt::format("Zernike terms of surface {} from order {} to {}", at.number, zernike->order + 1, zernike->given_order), "they are zero", saves);
    }
  }

  void surfaces() {
    const bool has_opl = request_.want_wavefront;
    const auto spared = [&](const auto& change) {
      return [&, change](const Passage& at) {
        Way more = way_of(at, has_opl);
        change(more);
        return operations_of(at, more) - operations_of(at, way_of(at, has_opl));
      };
    };
    const auto with = [&](const char* of, const char* why) {
      return [this, of, why](const std::vector<int>& numbers, const std::string& saves) { add(of + text_of(numbers), why, saves); };
    };
    over_surfaces([](const Passage& at) { return at.is_passed_by; },
                  [&](const Passage& at) { return operations_of(at, way_of(at, has_opl)) - operations_of_passing_by(at); },
                  with("tracing ", "planes in one medium that stop no ray"));
    over_surfaces([](const Passage& at) { return !at.is_passed_by && at.is_shift; }, spared([](Way& way) { way.is_shift = false; }),
                  with("turns into the frames of ", "they are only shifted along z from the frames before"));
    over_surfaces([](const Passage& at) { return !at.is_passed_by && !at.surface->has_apertures(); },
                  spared([](Way& way) { way.kind.has_apertures = true; }), with("aperture tests of ", "they have no semi-diameter"));
    const auto refract = [](Way& way) { way.kind.deflection = Deflection::refract; };
    over_surfaces([](const Passage& at) { return !at.is_passed_by && !at.surface->image && at.deflection() == Deflection::none; },
                  spared(refract), with("refraction at ", "the index is the same on both sides"));
    over_surfaces([](const Passage& at) { return at.surface->image; }, spared(refract), with("medium and refraction behind ", "rays end at the image surface"));
  }

  // tell(numbers, saves): of the surfaces for which this is so, what they spare all together.
  template <class IsSo, class Spared, class Tell>
  void over_surfaces(const IsSo& is_so, const Spared& spared, const Tell& tell) {
    std::vector<int> numbers;
    Operations sum;
    for (const Passage& at : passages_) {
      if (at.is_in_gradient() || !is_so(at)) continue;  // ray by ray nothing is left out
      numbers.push_back(at.number);
      if (at.is_reached) sum = sum + spared(at);
    }
    if (!numbers.empty()) tell(numbers, text_of(sum));
  }

  const scene::CompileResult& compiled_;
  const JobRequest& request_;
  const std::vector<Passage>& passages_;
  int result_count_;
  std::vector<Omission> found_;
};

AimPlan aim_plan(const scene::Scene& scene) {
  AimPlan plan{scene.stop};
  const std::vector<trace::PupilPoint> pupil = trace::pupil_points({trace::PatternKind::hexapolar}, 1000);
  const double per_field = 1 / static_cast<double>(scene.fields.size());
  for (const scene::Field& field : scene.fields) {
    const trace::Launcher launcher(scene, field, scene.wavelengths.front());
    plan.passes_per_ray += per_field * static_cast<double>(launcher.at_entrance_pupil(pupil).passes) / static_cast<double>(pupil.size());
    plan.passes_before += per_field * static_cast<double>(launcher.aim()->passes_before());
  }
  return plan;
}

}  // namespace

Plan plan_of(const scene::CompileResult& compiled, const JobRequest& request) {
  const std::vector<Passage> passages = passages_of(*compiled.scene);
  Plan plan;
  plan.has_opl = request.want_wavefront;
  for (const Passage& at : passages) {
    SurfacePlan one{at.number, at.is_passed_by ? "none: passed by" : kernel_of(at), {}, at.gradient_steps, bytes_per_ray(at, plan.has_opl),
                    at.is_passed_by ? 0 : data_bytes(at.surface->shape)};
    if (at.is_reached) one.operations = at.is_passed_by ? operations_of_passing_by(at) : operations_of(at, way_of(at, plan.has_opl));
    plan.surfaces.push_back(std::move(one));
  }
  if (compiled.scene->pupil.is_of_stop) plan.aim = aim_plan(*compiled.scene);
  plan.left_out = LeftOut(compiled, request, passages).all();
  return plan;
}

}  // namespace sagitta::analysis
