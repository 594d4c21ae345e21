// SPDX-License-Identifier: Apache-2.0
// What must hold of every ray through every system of wild_system.h. Tolerances are not measured: they follow from the ray's own bound at that
// surface, as `sagitta verify` reports it (study/rounding_bound_internal.h); wild_laws.h says how.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lib/numerics/parallel.h"
#include "lib/study/rounding.h"
#include "tests/extreme/wild_gradient_laws.h"
#include "tests/extreme/wild_system.h"

namespace sagitta::test {

// Something that has a worst, and the system that it came from.
struct Worst {
  double value = 0;
  std::string where;
  void add(double candidate, const std::string& there) {
    if (candidate > value) value = candidate, where = there;
  }
};

struct Found {
  std::map<std::string, std::int64_t> counts;
  std::map<std::string, Worst> worst;
  std::vector<std::string> complaints;  // each with its seed

  void add(const Found& other) {
    for (const auto& [name, count] : other.counts) counts[name] += count;
    for (const auto& [name, one] : other.worst) worst[name].add(one.value, one.where);
    complaints.insert(complaints.end(), other.complaints.begin(), other.complaints.end());
  }
};

// One system through all of the laws.
class Examination {
 public:
  explicit Examination(std::uint64_t seed, bool with_verify) : seed_(seed), generator_(seed), wild_(generator_.system()), u_(seed) {
    const Folder folder;
    for (const auto& [name, text] : wild_.points) folder.file(name, text);
    const auto read = prescription::read_prescription(folder.file("system.yaml", wild_.yaml));
    for (const auto& finding : read.findings.all())
      if (finding.severity != prescription::Severity::note) complain("the reader says " + format(finding));  // a note: of nodes without data
    if (!read.model) return;
    model_ = *read.model;
    scene::CompileResult compiled = scene::compile(model_);
    count("systems");
    if (!compiled.scene) {
      count("refused");
      return;
    }
    scene_ = std::move(*compiled.scene);
    trace_rays();
    if (!scene_.primary.gradients.empty()) same_bits_alone();
    mirrored_in_x();
    turned_by_90_degrees();
    if (with_verify) verified();
  }
  Found take() { return std::move(found_); }
  const std::string& yaml() const { return wild_.yaml; }

 private:
  void count(const std::string& what, std::int64_t by = 1) { found_.counts[what] += by; }
  void complain(const std::string& what) { found_.complaints.push_back(fmt::format("seed {}: {}", seed_, what)); }
  // `of_most`: of what is allowed.
  void hold(const char* law, double of_most, const std::string& where) {
    count(law);
    found_.worst[law].add(of_most, where);
    if (!(of_most <= 1)) complain(fmt::format("{}: {:.3g} times what is allowed, {}", law, of_most, where));
  }

  trace::RayBatch launched() {
    std::vector<trace::PupilPoint> pupil{{0, 0}};
    for (int i = 0; i < 1; ++i) {
      const double r = std::sqrt(u_()), azimuth = u_(0, 6.3);
      pupil.push_back({r * std::cos(azimuth), r * std::sin(azimuth)});
    }
    std::vector<GlobalRay> rays = generator_.rays(wild_, 3);
    for (const scene::Field& field : scene_.fields) {
      const trace::RayBatch of_field = trace::launch(scene_, field, scene_.primary.index.front(), pupil);
      for (std::size_t i = 0; i < of_field.size(); ++i) rays.push_back({of_field.position(i), of_field.direction(i)});
    }
    return batch_of(rays);
  }

  static bool is_finite(const trace::RayBatch& rays) {
    for (const auto* column : {&rays.x, &rays.y, &rays.z, &rays.l, &rays.m, &rays.n, &rays.opl})
      for (const double value : *column)
        if (!std::isfinite(value)) return false;
    return true;
  }

  void trace_rays() {
    start_ = launched();
    if (!is_finite(start_)) return complain("a launched ray is not finite");
    const std::size_t ray_count = start_.size();
    count("rays", static_cast<std::int64_t>(ray_count));
    std::vector<trace::RayBatch> states{start_};
    trace::SurfaceBySurface tracer(scene_, scene_.primary, start_);
    for (int number = 1; number <= scene_.surface_count(); ++number) states.push_back(tracer.next());
    for (const trace::RayBatch& state : states)
      if (!is_finite(state)) complain("a number is not finite");
    image_ = start_;
    trace::trace(scene_, scene_.primary, image_);
    if (image_.x != states.back().x || image_.n != states.back().n || image_.opl != states.back().opl || image_.ended != states.back().ended) complain("trace() is not surface by surface");
    adds_up(states);
    const View view{scene_, scene_.primary};
    for (std::size_t i = 0; i < ray_count; ++i) follow(view, states, i);
  }

  // Each ray for itself, and on several threads.
  void same_bits_alone() {
    trace::RayBatch threads = start_;
    trace::trace(scene_, scene_.primary, threads, 3);
    for (std::size_t i = 0; i < start_.size(); ++i) {
      trace::RayBatch one(1);
      one.set(0, start_.position(i), start_.direction(i), start_.opl[i]);
      trace::trace(scene_, scene_.primary, one);
      count("the same bits alone");
      for (const auto& [batch, k] : {std::pair<const trace::RayBatch&, std::size_t>{one, 0}, {threads, i}})
        if (batch.ended[k] != image_.ended[i] || batch.position(k) != image_.position(i) || batch.direction(k) != image_.direction(i) || batch.opl[k] != image_.opl[i])
          complain(fmt::format("ray {} is another one alone or on several threads", i + 1));
    }
  }

  // No ray is lost in silence, none comes back, and none ends at a surface that there is not.
  void adds_up(const std::vector<trace::RayBatch>& states) {
    const trace::StatusCounts counts = count_statuses(states.back());
    std::int64_t lost = 0;
    for (const auto& [ended, how_many] : counts.endings) {
      lost += how_many;
      if (ended / 8 < 1 || ended / 8 > scene_.surface_count() || ended % 8 >= surface::status_count || ended % 8 == 0) complain(fmt::format("no such ending: {}", ended));
    }
    if (counts[Status::ok] + lost != static_cast<std::int64_t>(start_.size()) || counts.total() != static_cast<std::int64_t>(start_.size())) complain("counts do not add up");
    for (std::size_t k = 1; k < states.size(); ++k)
      for (std::size_t i = 0; i < start_.size(); ++i)
        if (states[k - 1].ended[i] != 0 && states[k].ended[i] != states[k - 1].ended[i]) complain("a ray that ended goes on");
    for (int status = 0; status < surface::status_count; ++status) count(std::string(surface::status_names[static_cast<std::size_t>(status)]), counts[static_cast<Status>(status)]);
  }

  void follow(const View& view, const std::vector<trace::RayBatch>& states, std::size_t i) {
    ExactRay from = study::as_exact(states[0], i);
    int from_number = 0, passed = 0;
    for (int number = 1; number <= scene_.surface_count(); ++number) {
      const trace::RayBatch& state = states[static_cast<std::size_t>(number)];
      if (state.ended[i] != 0 && state.ended_at(i) < number) break;
      const std::string where = fmt::format("seed {}, ray {}, surface {}, {}", seed_, i + 1, number, kernel_name(scene_.surface(number).shape));
      const ExactStep exact = view.look_past(from_number, number, from);
      const ExactRay here = study::as_exact(state, i);
      if (is_another_crossing(view, number, exact)) {
        count("another crossing in gradients");
        break;
      }
      if (here.ended != exact.behind.ended) {
        ends_differently(view, from_number, number, from, exact, here.ended, where);
        break;
      }
      if (here.ended != 0) {
        const Equation equation(scene_.surface(number).shape, model_.surfaces[static_cast<std::size_t>(number - 1)].shape);
        if (scene_.primary.has_gradient_at(number)) count(fmt::format("ended at a gradient, {}", surface::status_names[static_cast<std::size_t>(here.ended % 8)]));
        const bool is_missed = here.ended % 8 == static_cast<int>(Status::missed);
        if (equation.conic() && !scene_.primary.has_gradient_at(number)) {
          count("conics that end a ray");
          if (is_missed != (textbook_meet(*equation.conic(), exact.start, exact.direction).status == Status::missed)) complain("missed by the tracer or by the textbook alone: " + where);
        }
        break;
      }
      const RoundingBound bound = rounding_bound(view, from_number, number, from, exact);
      const bool is_in_gradient = scene_.primary.gradient(number - 1) != nullptr;
      count(is_in_gradient ? "passages in gradients" : "passages"), ++passed;
      if (bound.position + bound.direction + bound.opl < std::numeric_limits<double>::infinity())
        laws({view, model_.surfaces[static_cast<std::size_t>(number - 1)].shape, from_number, number, from, exact, here, bound, wild_.scale}, states[static_cast<std::size_t>(from_number)], i, where);
      else count(is_in_gradient ? "passages in gradients of which nothing is known" : "passages of which nothing is known");
      if (!view.is_dummy(number)) from = here, from_number = number;
    }
    if (passed >= 3) count("rays through 3 surfaces or more");
    if (passed >= 8) count("rays through 8 surfaces or more");
  }

  void laws(const Passage& at, const trace::RayBatch& start, std::size_t i, const std::string& where) {
    count("at " + kind_of(at));
    hold("within its bound", own_error(at), where);
    hold("on the surface and the ray", off_surface(at), where);
    hold("Snell and coplanarity", snell(at), where);
    if (const auto slope = fermat(at)) hold("Fermat", *slope, where);
    if (at.is_in_gradient()) {
      hold("within its bound, in gradients", own_error(at), where);
      if (const auto back = reversed_in_gradient(at)) hold("sent back in gradients", *back, where);
    }
    if (at.view.wavelength.has_gradient_at(at.number)) return;  // what follows is of surfaces between two indices
    if (const auto back = reversed(at)) hold("sent back", *back, where);
    if (const auto other = turned(at, start, i, u_(0, 6.3))) hold("turned about the axis", *other, where);
    const double unit = 2 * unit_roundoff * (wild_.scale + size_of(at.before.position) + size_of(at.exact.crossing.path));
    found_.worst["digits lost, " + kind_of(at)].add(std::log10(std::max({1.0, size_of(at.behind.position - at.exact.behind.position) / unit, size_of(at.behind.direction - at.exact.behind.direction) / (2 * unit_roundoff)})), where);
  }
  static std::string kind_of(const Passage& at) {
    const std::string name = kernel_name(at.surface().shape);
    return name.substr(0, name.find(" of "));
  }

  // One that ends in one way only is on the edge of ending: there are lines as near as rounding that end as it does.
  void ends_differently(const View& view, int from, int number, const ExactRay& ray, const ExactStep& exact, std::int32_t ended, const std::string& where) {
    const bool is_at_gradient = scene_.primary.has_gradient_at(number);
    count(is_at_gradient ? "end differently at gradients" : "end differently");
    double carried = size_of(ray.position) + size_of(exact.start);
    for (int passed = from + 1; passed <= number; ++passed) carried += norm(scene_.surface(passed).local_from_previous.translation);
    // 2026-11-23, seeds 61044 and 95739: aspheres of power 40 that are met 1e75 mm away, from where nothing is left of where a ray is
    if (64 * unit_roundoff * carried > wild_.scale) return count("end differently after a place whose rounding is larger than the system");
    // 2026-11-23, seed 41373: a thousand times the distances that there were a ray in a gradient is given up (gradient_index/travel.h), at the end of a step of its own
    if (scene_.primary.gradient(number - 1) && size_of(exact.crossing.point) > 500 * size_of(exact.start)) return count("left the neighbourhood in gradients");
    // seed 72825: what is no index is seen at the ends of steps, too
    if (const double n = static_cast<double>(exact.index_before); scene_.primary.gradient(number - 1) && !gradient_index::is_squared_index(n * n)) return count("no index in gradients");
    const auto bound = rounding_bound(view, from, number, ray, exact);
    double near = 64 * unit_roundoff * carried;
    if (bound.position < std::numeric_limits<double>::infinity()) near = std::max(near, bound.position);
    if (is_at_gradient) near = std::max(near, 1e3 * scene_.tolerance.mm);
    for (int attempt = 0; attempt < (scene_.primary.gradient(number - 1) ? 8 : 64); ++attempt) {
      ExactRay other = ray;
      const auto any = [&](double size) {
        const double x = u_(-size, size), y = u_(-size, size), z = u_(-size, size);
        return Vec3<Exact>{Exact(x), Exact(y), Exact(z)};
      };
      other.position = other.position + any(near);
      other.direction = normalized(other.direction + any(64 * unit_roundoff));
      if (view.look_past(from, number, other).behind.ended == ended) return;
    }
    const Status status = static_cast<Status>(ended % 8);
    if (status == Status::not_converged || static_cast<Status>(exact.behind.ended % 8) == Status::not_converged) return count(is_at_gradient ? "given up by one of the two in gradients" : "given up by one of the two");
    complain(fmt::format("ends as {}, exactly as {}: {}", surface::status_names[static_cast<std::size_t>(ended % 8)], surface::status_names[static_cast<std::size_t>(exact.behind.ended % 8)], where));
  }

  // Term j of an xy_polynomial, counted by degree and in it by falling power of x.
  static bool is_odd_in_x(int j) {
    int power = 1;
    for (int degree = 1; --j > 0;) power = power > 0 ? power - 1 : ++degree;
    return power % 2 != 0;
  }
  // x -> -x turns only signs, in every operation: the same bits.
  void mirrored_in_x() {
    if (!wild_.points.empty()) return;
    prescription::Model flipped = model_;
    for (prescription::Surface& surface : flipped.surfaces) {
      if (surface.gradient && surface.gradient->kind == "quadratic") surface.gradient->parameters.numbers["x_per_mm"] *= -1;
      surface.decenter_mm.x *= -1, surface.tilt_deg.y *= -1, surface.tilt_deg.z *= -1;
      for (auto& [index, um] : surface.shape.parameters.indexed["coefficients_um"]) {
        const int m = numerics::zernike_term(numerics::ZernikeIndexing::osa, index).m;  // cos m(pi - t) = (-1)^m cos m t, sin m(pi - t) = -(-1)^m sin m t
        um *= ((m < 0) != (m % 2 != 0)) ? -1 : 1;
      }
      if (surface.shape.kind == "xy_polynomial")
        for (auto& [index, mm] : surface.shape.parameters.indexed["coefficients"]) mm *= is_odd_in_x(index) ? -1 : 1;
    }
    const scene::CompileResult other = scene::compile(flipped);
    if (!other.scene) return complain("the mirrored system is refused");
    trace::RayBatch rays = start_;
    for (std::size_t i = 0; i < rays.size(); ++i) rays.x[i] *= -1, rays.l[i] *= -1;
    trace::trace(*other.scene, other.scene->primary, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      count("mirrored in x");
      const bool same = rays.ended[i] == image_.ended[i] && rays.opl[i] == image_.opl[i] && rays.position(i) == Vec3<double>{-image_.x[i], image_.y[i], image_.z[i]} &&
                        rays.direction(i) == Vec3<double>{-image_.l[i], image_.m[i], image_.n[i]};
      if (!same) complain(fmt::format("mirrored in x, ray {} is another one", i + 1));
    }
  }

  // (x, y) -> (-y, x): sums of two products change their order, and signs: the same bits. In local frames, which turn likewise.
  void turned_by_90_degrees() {
    const bool is_of_revolution = std::all_of(scene_.surfaces.begin(), scene_.surfaces.end(), [](const scene::Surface& surface) {
      return std::visit([]<class S>(const S&) { return surface::has_closed_form<S>; }, surface.shape);
    });
    if (!is_of_revolution || !scene_.primary.gradients.empty()) return;
    const numerics::Rotation<double> turn{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
    scene::Scene other = scene_;
    for (scene::Surface& surface : other.surfaces) surface.local_from_previous = {turn * (surface.local_from_previous.rotation * turn.transposed()), turn * surface.local_from_previous.translation};
    trace::RayBatch rays = start_;
    for (std::size_t i = 0; i < rays.size(); ++i) rays.set(i, turn * start_.position(i), turn * start_.direction(i), start_.opl[i]);
    trace::trace(other, other.primary, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      count("turned by 90 degrees");
      if (rays.ended[i] != image_.ended[i] || rays.opl[i] != image_.opl[i] || rays.position(i) != turn * image_.position(i) || rays.direction(i) != turn * image_.direction(i))
        complain(fmt::format("turned by 90 degrees, ray {} is another one", i + 1));
    }
  }

  // `sagitta verify` itself says so.
  void verified() {
    const study::Rounding rounding = study::rounding_of(scene_, {.rays = 1, .thread_count = 1});
    for (std::size_t k = 1; k < rounding.surfaces.size(); ++k)
      if (rounding.surfaces[k].bound_position_mm.count() > 0) hold("verify", rounding.surfaces[k].of_bound, fmt::format("seed {}, surface {}", seed_, k));
  }

  std::uint64_t seed_;
  WildGenerator generator_;
  WildSystem wild_;
  Uniform u_;
  prescription::Model model_;
  scene::Scene scene_;
  trace::RayBatch start_, image_;
  Found found_;
};

// The systems of a range of seeds, shared among all threads; every eighth by verify too, which takes as long as the rest. The same for any number of threads.
inline Found search_systems(std::uint64_t first, std::uint64_t count) {
  std::vector<Found> of(count);
  numerics::share_blocks(count, 0, [&] { return [&](std::size_t i) { of[i] = Examination(first + i, i % 8 == 0).take(); }; });
  Found all;
  for (const Found& one : of) all.add(one);
  return all;
}

// Those with gradient-index media among them.
inline Found search_gradients(std::uint64_t first, std::uint64_t count) {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t seed = first; seed < first + count; ++seed)
    if (WildGradients(seed).has_some()) seeds.push_back(seed);
  std::vector<Found> of(seeds.size());
  numerics::share_blocks(seeds.size(), 0, [&] { return [&](std::size_t i) { of[i] = Examination(seeds[i], true).take(); }; });
  Found all;
  for (const Found& one : of) all.add(one);
  return all;
}

}  // namespace sagitta::test
