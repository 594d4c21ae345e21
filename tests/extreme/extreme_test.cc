// SPDX-License-Identifier: Apache-2.0
// The corpus of extreme systems (extreme_case.h says how a case is written): every ray in double by the tracer and by the textbook, in 50
// digits by the tracer's templates, and in 100 digits by the textbook. Ours must be within the case's tolerance of the exact
// answer, and the naive way beyond it wherever the case says that it fails. One line a case; `tools/test` shows them.
#include <fmt/core.h>

#include <optional>

#include "lib/analysis/wavefront.h"
#include "lib/study/fifty_digits_internal.h"
#include "lib/study/through_internal.h"
#include "lib/trace/launch_rays.h"
#include "tests/extreme/extreme_case.h"
#include "tests/extreme/textbook.h"

namespace sagitta::test {
namespace {

using study::FiftyDigits;

// What a ray is where it is looked at.
struct Seen {
  Status status = Status::ok;
  Vec3<Exact> position, direction;
  Exact opl = 0;
  std::optional<Exact> opd_waves;
};

template <class T>
Exact exact_of(const T& value) {
  return Exact(value);
}
template <class T>
Vec3<Exact> exact_of(const Vec3<T>& v) {
  return {Exact(v.x), Exact(v.y), Exact(v.z)};
}

class Bench {
 public:
  explicit Bench(const ExtremeCase& extreme) : case_(extreme) {
    const auto read = prescription::read_prescription(extreme.file.string());
    for (const auto& finding : read.findings.all()) EXPECT_EQ(finding.severity, prescription::Severity::note) << format(finding);
    if (!read.model) return;
    model_ = *read.model;
    auto compiled = scene::compile(*read.model);
    for (const auto& finding : compiled.findings.all()) EXPECT_NE(finding.severity, prescription::Severity::error) << format(finding);
    if (compiled.scene) scene_ = std::move(*compiled.scene);
    surface_ = extreme.surface > 0 ? extreme.surface : scene_.surface_count();
    if (!extreme.pupil.empty()) reference_ = analysis::reference_sphere(scene_, scene_.primary, scene_.fields[extreme.field]);
  }
  bool is_ready() const { return scene_.surface_count() > 0; }
  bool is_in_textbook() const {
    return scene_.primary.gradients.empty() && std::all_of(scene_.surfaces.begin(), scene_.surfaces.end(), [](const auto& surface) { return test::is_in_textbook(surface.shape); });
  }

  std::vector<Seen> ours() const {
    trace::RayBatch rays = case_.rays.empty() ? trace::launch(scene_, field(), scene_.primary.index.front(), case_.pupil) : batch_of(case_.rays);
    if (surface_ == scene_.surface_count()) {
      trace::trace(scene_, scene_.primary, rays);
    } else {
      trace::SurfaceBySurface tracer(scene_, scene_.primary, std::move(rays));
      for (int number = 1; number < surface_; ++number) tracer.next();
      rays = tracer.next();
    }
    std::vector<Seen> seen;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      seen.push_back({rays.status(i), exact_of(rays.position(i)), exact_of(rays.direction(i)), Exact(rays.opl[i]), {}});
      if (has_opd()) seen.back().opd_waves = Exact(optical_path_difference(reference_.sphere, rays.position(i), rays.direction(i), rays.opl[i])) * per_wave();
    }
    return seen;
  }

  // The tracer's templates in 50 digits, of the same surfaces' doubles.
  std::vector<Seen> templates() const {
    return seen_by<FiftyDigits>([&](const Vec3<FiftyDigits>& position, const Vec3<FiftyDigits>& direction, const FiftyDigits& opl) {
      study::Path<FiftyDigits> ray{position, direction, 0, opl};
      for (int number = 1; number <= surface_ && ray.ended == 0; ++number)
        ray = scene_.primary.has_gradient_at(number)
                  ? study::through_gradient(scene_.surface(number), number, scene_.primary, ray).behind
                  : study::through(scene_.surface(number), number, before(number), behind(number), ray, [&](const auto& p, const auto& d) {
                      return std::visit([&](const auto& shape) -> surface::Crossing<FiftyDigits> { return shape.meet(p, d); }, scene_.surface(number).shape);
                    });
      return TextbookRay<FiftyDigits>{ray.position, ray.direction, ray.opl, static_cast<Status>(ray.ended % 8), ray.ended / 8};
    });
  }
  // The textbook's rays.
  template <class T>
  std::vector<Seen> textbook() const {
    return seen_by<T>([&](const Vec3<T>& position, const Vec3<T>& direction, const T& opl) {
      TextbookRay<T> ray{position, direction, opl};
      for (int number = 1; number <= surface_; ++number)
        textbook_step(scene_.surface(number), model_.surfaces[static_cast<std::size_t>(number - 1)].shape, number, before(number), behind(number), ray);
      return ray;
    });
  }

 private:
  const scene::Field& field() const { return scene_.fields[case_.field]; }
  double before(int number) const { return scene_.primary.index[static_cast<std::size_t>(number - 1)]; }
  double behind(int number) const { return scene_.primary.index[static_cast<std::size_t>(number)]; }
  bool has_opd() const { return !case_.pupil.empty() && reference_.reason.empty() && surface_ == scene_.surface_count(); }
  Exact per_wave() const { return Exact(1e3) / Exact(scene_.primary.wavelength_um); }

  template <class T, class Go>
  std::vector<Seen> seen_by(const Go& go) const {
    std::vector<TextbookRay<T>> rays;
    for (const GlobalRay& ray : case_.rays) rays.push_back(go(vec3_cast<T>(ray.p), is_naive<T> ? vec3_cast<T>(ray.d) : normalized(vec3_cast<T>(ray.d)), T(0)));
    std::vector<trace::PupilPoint> pupil = case_.pupil;
    if (!pupil.empty()) pupil.push_back({0, 0});  // the chief ray
    if (is_naive<T>) launch_naively<T>(pupil, [&](std::size_t, const auto&... of) { rays.push_back(go(of...)); });
    else trace::launch_rays<T>(scene_, field(), scene_.primary.index.front(), pupil, [&](std::size_t, const auto&... of) { rays.push_back(go(of...)); });
    std::vector<Seen> seen;
    for (std::size_t i = 0; i < case_.ray_count(); ++i) {
      const TextbookRay<T>& ray = rays[i];
      seen.push_back({ray.status, exact_of(ray.position), exact_of(ray.direction), exact_of(ray.opl), {}});
      if (has_opd()) seen.back().opd_waves = opd(ray, rays.back()) * per_wave();
    }
    return seen;
  }
  // From the object point itself; parallel light from the entrance pupil.
  template <class T, class Put>
  void launch_naively(const std::vector<trace::PupilPoint>& pupil, const Put& put) const {
    const T z(scene_.pupil.z), semi_diameter(scene_.pupil.semi_diameter);
    for (const auto& point : pupil) {
      const Vec3<T> in_pupil{T(point.x) * semi_diameter, T(point.y) * semi_diameter, z};
      const Vec3<T> object = scene_.object.at_infinity() ? Vec3<T>{} : trace::object_point<T>(scene_, field());
      const Vec3<T> d = scene_.object.at_infinity() ? normalized(Vec3<T>{T(field().x), T(field().y), T(1)}) : normalized(in_pupil - object);
      if (scene_.object.at_infinity()) put(0, in_pupil, d, T(scene_.primary.index.front() * dot(in_pupil, d)));
      else put(0, object, d, T(0));
    }
  }
  // To the reference sphere: in 100 digits by the analysis' formula, else by its quadratic and the difference of two whole paths.
  template <class T>
  Exact opd(const TextbookRay<T>& ray, const TextbookRay<T>& chief) const {
    const auto sphere = analysis::sphere_about(scene_, scene_.primary, reference_.exit_pupil_z, chief.position, chief.direction, chief.opl);
    if constexpr (!is_naive<T>) return Exact(optical_path_difference(sphere, ray.position, ray.direction, ray.opl));
    const auto path_to_sphere = [&](const TextbookRay<T>& of) {
      const Vec3<T> p = of.position - sphere.centre;
      const T b = dot(p, of.direction), root = std::sqrt(static_cast<double>(b * b - (dot(p, p) - sphere.radius * sphere.radius)));
      return of.opl + sphere.index * (sphere.radius < T(0) ? T(-b - root) : T(-b + root));
    };
    return Exact(path_to_sphere(chief) - path_to_sphere(ray));
  }

  const ExtremeCase& case_;
  prescription::Model model_;
  scene::Scene scene_;
  int surface_ = 0;
  analysis::ReferenceResult reference_;
};

// One number of a ray.
struct Quantity {
  const char *name, *group;
  Exact (*of)(const Seen&);
};
const Quantity quantities[]{{"x_mm", "position_mm", [](const Seen& ray) { return ray.position.x; }},
                            {"y_mm", "position_mm", [](const Seen& ray) { return ray.position.y; }},
                            {"z_mm", "position_mm", [](const Seen& ray) { return ray.position.z; }},
                            {"l", "direction", [](const Seen& ray) { return ray.direction.x; }},
                            {"m", "direction", [](const Seen& ray) { return ray.direction.y; }},
                            {"n", "direction", [](const Seen& ray) { return ray.direction.z; }},
                            {"opl_mm", "opl_mm", [](const Seen& ray) { return ray.opl; }},
                            {"opd_waves", "opd_waves", [](const Seen& ray) { return ray.opd_waves.value_or(Exact(NAN)); }}};

// How far an answer is from the exact one, at its worst, in units of the tolerance.
struct Distance {
  double error = 0, ratio = 0;  // NaN is infinite
  const Quantity* quantity = &quantities[2];
  std::size_t ray = 0;
  std::string other_status;  // of the first ray that ends otherwise
};

// `exact` may lack what only its case's closed forms tell.
Distance distance(const ExtremeCase& extreme, const std::vector<Seen>& seen, const std::vector<Seen>* exact) {
  Distance worst;
  const auto add = [&](const Quantity& quantity, std::size_t i, const Exact& difference) {
    const double tolerance = extreme.tolerance_of(quantity.name, quantity.group);
    if (std::isnan(tolerance)) return;
    double error = std::abs(static_cast<double>(difference));
    if (std::isnan(error)) error = INFINITY;
    const double ratio = error == 0 ? 0 : error / tolerance;
    if (!(ratio > worst.ratio)) return;
    worst.error = error, worst.ratio = ratio, worst.quantity = &quantity;
    if (worst.other_status.empty()) worst.ray = i;
  };
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].status != extreme.status[i]) {
      if (worst.other_status.empty()) worst.ray = i, worst.other_status = surface::status_names[static_cast<std::size_t>(seen[i].status)];
      continue;
    }
    if (seen[i].status != Status::ok) continue;
    for (const Quantity& quantity : quantities) {
      if (exact) add(quantity, i, quantity.of(seen[i]) - quantity.of((*exact)[i]));
      if (const auto closed = extreme.exact.find(quantity.name); closed != extreme.exact.end()) add(quantity, i, quantity.of(seen[i]) - closed->second[i]);
    }
  }
  return worst;
}

bool is_within(const Distance& distance) { return distance.other_status.empty() && distance.ratio <= 1; }

std::string text_of(const Exact& value) { return fmt::format("{:.10g}", static_cast<double>(value)); }

class Extreme : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(Extreme, NaiveArithmeticFailsWhereItIsSaidToAndOursHolds) {
  const ExtremeCase extreme = read_case(GetParam());
  const Bench bench(extreme);
  ASSERT_TRUE(bench.is_ready());
  ASSERT_EQ(bench.is_in_textbook(), extreme.has_naive());
  const std::vector<Seen> ours = bench.ours(), templates = bench.templates();
  const std::vector<Seen> exact = extreme.has_naive() ? bench.textbook<Exact>() : templates;
  const Distance our_distance = distance(extreme, ours, &exact), exact_distance = distance(extreme, exact, nullptr), template_distance = distance(extreme, templates, &exact);
  const auto complaint = [&](const Distance& of) {
    return fmt::format("{}: ray {}, {} off by {:.3g}, {:.3g} times the tolerance; {}", extreme.extreme, of.ray + 1, of.quantity->name, of.error, of.ratio,
                       of.other_status.empty() ? "status right" : "status " + of.other_status);
  };
  EXPECT_TRUE(is_within(exact_distance)) << "100 digits against the closed form: " << complaint(exact_distance);
  EXPECT_TRUE(is_within(template_distance)) << "50 digits: " << complaint(template_distance);
  EXPECT_TRUE(is_within(our_distance)) << "ours: " << complaint(our_distance);
  const std::vector<Seen> naive = extreme.has_naive() ? bench.textbook<double>() : std::vector<Seen>{};
  const Distance naive_distance = distance(extreme, naive, &exact);
  if (extreme.has_naive()) {
    EXPECT_EQ(is_within(naive_distance), !extreme.naive_fails()) << "naive: " << complaint(naive_distance);
  }

  // one line: where the naive way is worst
  const Distance& shown = naive.empty() ? our_distance : naive_distance;
  const auto told = [&](const std::vector<Seen>& seen) -> std::string {
    if (seen.empty()) return "-";
    const Seen& ray = seen[shown.ray];
    const bool differs = !shown.other_status.empty() || exact[shown.ray].status != Status::ok;
    return differs ? std::string(surface::status_names[static_cast<std::size_t>(ray.status)]) : text_of(shown.quantity->of(ray));
  };
  const bool is_status = !shown.other_status.empty() || exact[shown.ray].status != Status::ok;
  const auto error = [&](const std::vector<Seen>& seen) -> std::string {
    if (is_status || seen.empty()) return "";
    return fmt::format("{:.1e}", std::abs(static_cast<double>(shown.quantity->of(seen[shown.ray]) - shown.quantity->of(exact[shown.ray]))));
  };
  fmt::print("extreme | {} | {} | {} | {} | {} | {} | {} | {} |\n", extreme.extreme, is_status ? "status" : shown.quantity->name, told(naive), told(ours), told(exact), error(naive), error(ours),
             is_status ? "" : fmt::format("{:.1e}", extreme.tolerance_of(shown.quantity->name, shown.quantity->group)));
}

INSTANTIATE_TEST_SUITE_P(Corpus, Extreme, testing::ValuesIn(extreme_files()), [](const auto& of) {
  std::string name = of.param.stem().string();
  std::replace_if(name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
});

TEST(Extreme, CorpusHoldsAtLeastSixtySystems) { EXPECT_GE(extreme_files().size(), 60u); }

}  // namespace
}  // namespace sagitta::test
