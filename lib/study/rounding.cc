// SPDX-License-Identifier: Apache-2.0
#include "lib/study/rounding.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "lib/analysis/wavefront.h"
#include "lib/numerics/parallel.h"
#include "lib/study/exact_steps_internal.h"
#include "lib/study/rounding_bound_internal.h"
#include "lib/trace/launch_rays.h"
#include "lib/trace/pattern.h"
#include "lib/trace/trace.h"

namespace sagitta::study {
namespace {

using analysis::ReferenceSphere;

const surface::Facets* facets_in(const surface::Shape& shape) {
  return std::visit([]<class S>(const S& of) -> const surface::Facets* {
    if constexpr (std::is_same_v<S, surface::Facets>) return &of;
    else if constexpr (requires { of.facets; }) return &of.facets;
    else return nullptr;
  }, shape);
}

// The tracer's rays: launched, then behind every surface.
std::vector<trace::RayBatch> tracer_states(const View& view, trace::RayBatch launched) {
  std::vector<trace::RayBatch> states{launched};
  trace::SurfaceBySurface tracer(view.scene, view.wavelength, std::move(launched));
  for (int number = 1; number <= view.surface_count(); ++number) states.push_back(tracer.next());
  return states;
}

// Where rays are aimed, the points of the entrance pupil that were found for them are numbers as those of the scene are.
std::vector<ExactRay> launch_exactly(const View& view, const scene::Field& field, const trace::Launcher& launcher, std::span<const trace::PupilPoint> pupil) {
  const trace::AimedPupil aimed = launcher.at_entrance_pupil(pupil);
  std::vector<ExactRay> rays(pupil.size());
  trace::launch_rays<Exact>(view.scene, field, view.wavelength.index.front(), aimed.points, [&](std::size_t i, const Vec3<Exact>& position, const Vec3<Exact>& direction, const Exact& opl) {
    rays[i] = {position, direction, aimed.found[i] ? 0 : launcher.ending_of_lost(), opl};
  });
  return rays;
}

// One ray in both ways.
struct Track {
  std::int32_t ended = 0, exact_ended = 0;
  std::vector<Differences> errors, own;  // [0] the launch, [k] surface k, as far as the ray comes
  std::vector<RoundingBound> bounds;     // of own; [0] of surface 1
  std::vector<ExactRay> in_image;        // X_k, where both arrive
  ExactRay exact_in_image;
  double rim_distance = std::numeric_limits<double>::infinity();  // of a ray that ends in one way only, from the aperture that ends it
};

// How far the exact ray is from the edge of an aperture where one of the two ended, clipped.
double distance_from_rim(const View& view, const std::vector<ExactRay>& exact, std::int32_t ended, std::int32_t exact_ended) {
  const std::int32_t clipped_as = ended % 8 == static_cast<int>(Status::clipped) ? ended : exact_ended;
  if (clipped_as % 8 != static_cast<int>(Status::clipped)) return std::numeric_limits<double>::infinity();
  const int number = clipped_as / 8;
  const ExactRay& there = exact[static_cast<std::size_t>(number)];
  const Exact radius = sqrt(Exact(there.position.x * there.position.x + there.position.y * there.position.y));
  const scene::Surface& surface = view.scene.surface(number);
  return std::min(size_of(Exact(radius - Exact(surface.semi_diameter))), size_of(Exact(radius - Exact(surface.inner_semi_diameter))));
}

Track track(const View& view, const std::vector<trace::RayBatch>& states, const ExactRay& launched, std::size_t i) {
  const int last = view.surface_count();
  std::vector<ExactRay> exact{launched};
  for (int number = 1; number <= last; ++number) exact.push_back(view.step(number, exact.back()));
  Track result;
  result.ended = states.back().ended[i];
  result.exact_ended = exact.back().ended;
  result.exact_in_image = exact.back();
  if (result.ended != result.exact_ended) {
    result.rim_distance = distance_from_rim(view, exact, result.ended, result.exact_ended);
    return result;
  }
  if (launched.ended != 0) return result;  // it could not be aimed
  const int comes_to = result.ended == 0 ? last : result.ended / 8 - 1;
  ExactRay from = as_exact(states[0], i);  // where the tracer itself goes on from
  int from_number = 0;
  result.errors.push_back(differences(from, launched));
  result.own.push_back(result.errors.back());
  if (result.ended == 0) result.in_image.push_back(view.to_image(0, from));
  for (int number = 1; number <= comes_to; ++number) {
    const ExactRay here = as_exact(states[static_cast<std::size_t>(number)], i);
    const ExactStep expected = view.look_past(from_number, number, from);
    result.errors.push_back(differences(here, exact[static_cast<std::size_t>(number)]));
    result.own.push_back(differences(here, expected.behind));
    result.bounds.push_back(rounding_bound(view, from_number, number, from, expected));
    const bool is_passed_by = view.is_dummy(number);
    if (!is_passed_by) from = here, from_number = number;
    if (result.ended == 0) result.in_image.push_back(is_passed_by ? result.in_image.back() : view.to_image(number, here));
  }
  return result;
}

// The rays of one field and wavelength, the chief ray apart: a central obscuration does not stop it.
struct Bundle {
  std::size_t field, wavelength;
  std::vector<trace::PupilPoint> pupil;
  std::vector<trace::RayBatch> states;
  std::vector<Track> tracks;
  std::vector<ReferenceSphere<Exact>> spheres;  // of X_k
  ReferenceSphere<Exact> exact_sphere;
  analysis::ReferenceResult reference;          // the tracer's own
};

void know_reference(const scene::Scene& scene, Bundle& bundle) {
  const scene::Wavelength& wavelength = scene.wavelengths[bundle.wavelength];
  const scene::Field& field = scene.fields[bundle.field];
  bundle.reference = analysis::reference_sphere(scene, wavelength, field);
  if (!bundle.reference.reason.empty()) return;
  const scene::Scene open = analysis::without_obscurations(scene);
  const View view{open, wavelength};
  const std::vector<trace::PupilPoint> centre{{0, 0}};
  const trace::Launcher launcher(open, field, wavelength);
  const Track chief = track(view, tracer_states(view, launcher(centre)), launch_exactly(view, field, launcher, centre).front(), 0);
  if (chief.ended != 0 || chief.exact_ended != 0) {
    bundle.reference.reason = "the exact chief ray ends otherwise than the tracer's";
    return;
  }
  const auto sphere = [&](const ExactRay& ray) {
    return analysis::sphere_about(scene, wavelength, bundle.reference.exit_pupil_z, ray.position, ray.direction, ray.opl);
  };
  for (const ExactRay& ray : chief.in_image) bundle.spheres.push_back(sphere(ray));
  bundle.exact_sphere = sphere(chief.exact_in_image);
}

Exact opd_of(const ReferenceSphere<Exact>& sphere, const ExactRay& ray) { return optical_path_difference(sphere, ray.position, ray.direction, ray.opl); }

// Where a surface lost most.
struct Worst {
  double loss = -1;
  std::size_t wavelength = 0;
  ExactRay before;
};

struct Factor {
  const char* cause;
  double factor;
};

// What the facet under a point does to rounding.
struct AtFacet {
  double angle_sine = 1;  // of its smallest angle
  bool is_on_edge = false;
};

AtFacet at_facet(const surface::Facets& facets, const Vec3<Exact>& point) {
  const double x = static_cast<double>(point.x), y = static_cast<double>(point.y);
  const std::uint32_t f = facets.facet_at(x, y);
  if (f == surface::no_facet) return {1, true};  // beyond the rim by rounding
  AtFacet result;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto corner = [&](std::size_t k) { return facets.mesh->vertices[facets.mesh->corners[f][k % 3]]; };
    const Vec3<double> a = corner(i + 1) - corner(i), b = corner(i + 2) - corner(i);
    const double from_edge = std::abs(a.x * (y - corner(i).y) - a.y * (x - corner(i).x)) / std::hypot(a.x, a.y);
    result.angle_sine = std::min(result.angle_sine, norm(cross(a, b)) / (norm(a) * norm(b)));
    result.is_on_edge = result.is_on_edge || from_edge <= 16 * 0x1p-52 * (facets.mesh->extent + norm(facets.mesh->centre));
  }
  return result;
}

// The sum of the sizes of a radial interpolant's terms; 0 of other shapes.
double radial_terms(const surface::Shape& shape, const Vec3<Exact>& point) {
  return std::visit([&]<class S>(const S& of) {
    double sum = 0;
    if constexpr (requires { of.radial(0.0, 0.0); }) {
      const std::uint32_t f = of.facets.facet_at(static_cast<double>(point.x), static_cast<double>(point.y));
      if (f == surface::no_facet) return 0.0;
      const auto& patch = of.patches[f];
      for (std::uint32_t k = patch.first; k < patch.first + patch.node_count; ++k) {
        const auto& node = of.facets.mesh->vertices[of.nodes[k]];
        const double dx = static_cast<double>(point.x) - node.x, dy = static_cast<double>(point.y) - node.y;
        sum += std::abs(of.weights[k] * of.radial(dx * dx + dy * dy, of.shape_squared).phi);
      }
    }
    return sum;
  }, shape);
}

// By which geometry enlarges rounding at one ray's crossing.
std::string cause_at(const View& view, int number, const ExactRay& before, double scale) {
  const scene::Surface& surface = view.scene.surface(number);
  const ExactStep step = view.look(number, before);
  const surface::Crossing<Exact>& crossing = step.crossing;
  if (crossing.status != Status::ok) return "";
  const Exact length = norm(crossing.normal);
  const double cosine = size_of(Exact(crossing.along / length)), steep = static_cast<double>(Exact(length / crossing.normal.z));
  const double cosine_behind = step.behind.ended == 0 ? size_of(Exact(dot(step.behind.direction, crossing.normal) / length)) : 0;
  const surface::Facets* facets = facets_in(surface.shape);
  const AtFacet at = facets ? at_facet(*facets, crossing.point) : AtFacet{};
  if (view.wavelength.gradient(number - 1)) return "the tolerance in a gradient, and many operations";
  if (at.is_on_edge && !std::holds_alternative<surface::Patches>(surface.shape)) return "edge of a facet";
  const double mu = view.index_before(number) / view.index_behind(number);
  std::vector<Factor> factors{{"near-grazing incidence", 1 / cosine},
                              {"near the critical angle", cosine_behind > 0 ? 1 / cosine_behind : 1},
                              {"steep surface", std::abs(steep)},
                              {"long distance", size_of(crossing.path) / scale},
                              {"strong curvature", std::abs(surface.vertex_curvature) * scale},
                              {"ill-conditioned facet", 1 / at.angle_sine},
                              {"radial functions that cancel", radial_terms(surface.shape, crossing.point) / scale},
                              {"index ratio near 1", mu != 1 && std::abs(mu - 1) < 1e-3 ? 1.5 : 1}};
  const auto largest = std::max_element(factors.begin(), factors.end(), [](const Factor& a, const Factor& b) { return a.factor < b.factor; });
  return largest->factor > 1.25 ? largest->cause : "many operations";
}

class Gatherer {
 public:
  Gatherer(const scene::Scene& scene, const RoundingRequest& request) : scene_(scene), request_(request) {
    result_.surfaces.resize(static_cast<std::size_t>(scene.surface_count()) + 1);
    worst_.resize(result_.surfaces.size());
    result_.scale_mm = scene.pupil.semi_diameter;
    for (int number = 2; number <= scene.surface_count(); ++number)
      result_.scale_mm = std::max(result_.scale_mm, norm(scene.surface(number).local_from_previous.translation));
  }

  void add(const Bundle& bundle) {
    FieldRounding field{bundle.field, bundle.wavelength, static_cast<std::int64_t>(bundle.tracks.size()), 0, {}, {}, 0, bundle.reference.reason};
    for (std::size_t i = 0; i < bundle.tracks.size(); ++i) {
      const Track& one = bundle.tracks[i];
      ++result_.rays;
      if (one.ended != one.exact_ended) disagree(bundle, i);
      else add_errors(bundle, i);
      if (one.ended == 0 && one.exact_ended == 0) add_in_image(bundle, i, field);
    }
    result_.fields.push_back(std::move(field));
  }

  Rounding finish() {
    for (std::size_t k = 1; k < result_.surfaces.size(); ++k) {
      SurfaceRounding& surface = result_.surfaces[k];
      const double units = loss(surface.own_position_mm.worst(), surface.own_direction_rad.worst(), surface.own_opl_mm.worst()) / 0x1p-52;
      surface.digits_lost = units > 1 ? std::log10(units) : 0;
      if (surface.digits_lost >= 1)
        surface.cause = cause_at(View{scene_, scene_.wavelengths[worst_[k].wavelength]}, static_cast<int>(k), worst_[k].before, result_.scale_mm);
    }
    return std::move(result_);
  }

 private:
  // Of the scale, or of a direction's length.
  double loss(double position, double direction, double opl) const { return std::max({position / result_.scale_mm, direction, opl / result_.scale_mm}); }
  void disagree(const Bundle& bundle, std::size_t i) {
    const Track& one = bundle.tracks[i];
    result_.disagreements.push_back({bundle.field, bundle.wavelength, bundle.pupil[i].x, bundle.pupil[i].y, static_cast<Status>(one.ended % 8),
                                     static_cast<Status>(one.exact_ended % 8), one.ended / 8, one.exact_ended / 8, one.rim_distance <= request_.position_tolerance_mm});
  }
  void add_errors(const Bundle& bundle, std::size_t i) {
    const Track& one = bundle.tracks[i];
    const View view{scene_, scene_.wavelengths[bundle.wavelength]};
    std::size_t from = 0;
    for (std::size_t k = 0; k < one.errors.size(); ++k) {
      SurfaceRounding& surface = result_.surfaces[k];
      surface.position_mm.add(one.errors[k].position), surface.direction_rad.add(one.errors[k].direction), surface.opl_mm.add(one.errors[k].opl);
      surface.own_position_mm.add(one.own[k].position), surface.own_direction_rad.add(one.own[k].direction), surface.own_opl_mm.add(one.own[k].opl);
      if (k == 0) continue;
      const int number = static_cast<int>(k);
      surface.is_estimate = surface.is_estimate || view.wavelength.has_gradient_at(number);
      compare_with_bound(one.own[k], one.bounds[k - 1], surface);
      const double lost = loss(one.own[k].position, one.own[k].direction, one.own[k].opl);
      if (lost > worst_[k].loss) {
        ExactRay before = as_exact(bundle.states[from], i);
        for (std::size_t passed = from + 1; passed < k; ++passed) before = view.step(static_cast<int>(passed), before);
        worst_[k] = {lost, bundle.wavelength, before};
      }
      if (!view.is_dummy(number)) from = k;
    }
  }
  static void compare_with_bound(const Differences& own, const RoundingBound& bound, SurfaceRounding& surface) {
    if (!(bound.position + bound.direction + bound.opl < std::numeric_limits<double>::infinity())) {
      ++surface.without_bound;
      return;
    }
    surface.bound_position_mm.add(bound.position), surface.bound_direction_rad.add(bound.direction), surface.bound_opl_mm.add(bound.opl);
    const auto ratio = [](double error, double most) { return error > 0 ? error / most : 0; };
    surface.of_bound = std::max({surface.of_bound, ratio(own.position, bound.position), ratio(own.direction, bound.direction), ratio(own.opl, bound.opl)});
  }
  void add_in_image(const Bundle& bundle, std::size_t i, FieldRounding& field) {
    const Track& one = bundle.tracks[i];
    ++field.arrived;
    field.position_mm.add(one.errors.back().position);
    const bool has_wavefront = bundle.reference.reason.empty();
    const Exact per_wave = Exact(1e3) / Exact(scene_.wavelengths[bundle.wavelength].wavelength_um), exact_opd = has_wavefront ? opd_of(bundle.exact_sphere, one.exact_in_image) : Exact(0);
    const ExactRay* before = &one.exact_in_image;
    Exact opd_before = exact_opd;
    const trace::RayBatch& image = bundle.states.back();
    const double opd = has_wavefront ? optical_path_difference(bundle.reference.sphere, image.position(i), image.direction(i), image.opl[i]) : 0;
    const bool misses = std::isnan(opd) && std::isnan(static_cast<double>(exact_opd));  // the reference sphere
    if (misses) ++field.without_opd;
    else if (has_wavefront) field.opd_waves.add(size_of(Exact((Exact(opd) - exact_opd) * per_wave)));
    for (std::size_t k = 0; k < one.in_image.size(); ++k) {
      if (one.in_image[k].ended != 0) return;  // a ray on the edge of ending: its share has no size
      result_.surfaces[k].share_mm.add(size_of(one.in_image[k].position - before->position));
      before = &one.in_image[k];
      if (!has_wavefront || misses) continue;
      const Exact opd_here = opd_of(bundle.spheres[k], one.in_image[k]);
      result_.surfaces[k].share_waves.add(size_of(Exact((opd_here - opd_before) * per_wave)));
      opd_before = opd_here;
    }
    if (has_wavefront && !misses) result_.opd_formula_waves.add(size_of(Exact((Exact(opd) - opd_before) * per_wave)));
  }

  const scene::Scene& scene_;
  const RoundingRequest& request_;
  Rounding result_;
  std::vector<Worst> worst_;
};

}  // namespace

Rounding rounding_of(const scene::Scene& scene, const RoundingRequest& request) {
  Gatherer gatherer(scene, request);
  for (std::size_t field = 0; field < scene.fields.size(); ++field)
    for (std::size_t wavelength = 0; wavelength < scene.wavelengths.size(); ++wavelength) {
      const View view{scene, scene.wavelengths[wavelength]};
      Bundle bundle{field, wavelength, trace::pupil_points({trace::PatternKind::hexapolar}, request.rays), {}, {}, {}, {}, {}};
      const trace::Launcher launcher(scene, scene.fields[field], view.wavelength);
      bundle.states = tracer_states(view, launcher(bundle.pupil));
      const std::vector<ExactRay> launched = launch_exactly(view, scene.fields[field], launcher, bundle.pupil);
      bundle.tracks.resize(bundle.pupil.size());
      numerics::share_blocks(bundle.tracks.size(), request.thread_count, [&] { return [&](std::size_t i) { bundle.tracks[i] = track(view, bundle.states, launched[i], i); }; });
      know_reference(scene, bundle);
      gatherer.add(bundle);
    }
  return gatherer.finish();
}

}  // namespace sagitta::study
