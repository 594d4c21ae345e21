// SPDX-License-Identifier: Apache-2.0
// What a plan says of a scene: counted operations, and omissions exactly where something is left out.
#include "lib/analysis/plan.h"

#include <gmock/gmock.h>

#include "tests/support/prescriptions.h"

namespace sagitta::test {
namespace {

using analysis::JobRequest, analysis::Omission, analysis::Plan, analysis::SurfacePlan;
using numerics::Counted, numerics::Operations;
using ::testing::HasSubstr;

JobRequest request_for(bool spot, bool wavefront) {
  JobRequest request;
  request.want_spot = spot, request.want_wavefront = wavefront;
  return request;
}
Plan plan_of_text(const std::string& surfaces, const JobRequest& request = {}, const std::string& more = {}) {
  const scene::CompileResult compiled = compile_text(prescription_of(surfaces, "entrance_pupil_diameter_mm: 2", more));
  EXPECT_TRUE(compiled.scene);
  return compiled.scene ? analysis::plan_of(compiled, request) : Plan{};
}

// Those whose `what` begins so.
std::vector<Omission> omissions(const Plan& plan, const std::string& begin) {
  std::vector<Omission> found;
  for (const Omission& one : plan.left_out)
    if (one.what.starts_with(begin)) found.push_back(one);
  return found;
}

// A refracting surface, and a focal plane.
std::string lens(const std::string& shape) { return "  - {stop: true, " + shape + ", thickness_mm: 20, medium: {index: 1.5}}\n  - {}\n"; }
Operations first_of(const Plan& plan) { return plan.surfaces.at(0).operations.value(); }
int all(const Operations& operations) { return operations.sums_and_products + operations.divisions + operations.roots; }

TEST(Counted, counts_what_varies_and_not_what_is_constant) {
  const Counted x = Counted::varying(3), two = 2;
  EXPECT_EQ(Counted::operations_of([&] { two * two + two / two - sqrt(two); }), Operations{});
  EXPECT_EQ(Counted::operations_of([&] { -x, abs(x), static_cast<void>(x < two); }), Operations{});
  EXPECT_EQ(Counted::operations_of([&] { sqrt(x * x + two * x - two) / x; }), (Operations{4, 1, 1, 0}));
  EXPECT_EQ(Counted::operations_of([&] { Counted sum = 1; sum += x, sum *= two, log(sum); }), (Operations{2, 0, 0, 1}));
  EXPECT_EQ(double(sqrt(x * x + two * x + two - 1.0)), 4);
}

// The tables of kernels: a plane has one division; a sphere's refraction needs none, a conic's one. Roots: of the crossing, and
// of the refraction.
TEST(Plan, counts_the_divisions_and_roots_that_the_kernels_are_known_for) {
  const JobRequest spots = request_for(true, false);
  const Operations plane = first_of(plan_of_text(lens("plane: {}"), spots)), sphere = first_of(plan_of_text(lens("conic: {radius_mm: 10}"), spots)),
                   conic = first_of(plan_of_text(lens("conic: {radius_mm: 10, conic_constant: -0.5}"), spots));
  EXPECT_EQ(plane.divisions, 1);
  EXPECT_EQ(plane.roots, 1);
  EXPECT_EQ(sphere.divisions, 1);
  EXPECT_EQ(sphere.roots, 2);
  EXPECT_EQ(conic.divisions, 2);
  EXPECT_EQ(conic.roots, 2);
  EXPECT_LT(plane.sums_and_products, sphere.sums_and_products);
  EXPECT_LT(sphere.sums_and_products, conic.sums_and_products);
}

// A plane in one medium behind a curved surface, by hand: a shift (1), the crossing -z/N, x + t L, y + t M (4 and a
// division), t - t; with OPL one product and one sum more, with an aperture x^2 + y^2 (3).
TEST(Plan, counts_what_can_be_counted_by_hand) {
  const std::string curved = "  - {stop: true, conic: {radius_mm: 10}, thickness_mm: 20}\n";
  const auto image = [&](const std::string& keys, const JobRequest& request) {
    const Plan plan = plan_of_text(curved + "  - {" + keys + "}\n", request);
    return plan.surfaces.at(1).operations.value();
  };
  EXPECT_EQ(image("", request_for(true, false)), (Operations{6, 1, 0, 0}));
  EXPECT_EQ(image("", request_for(true, true)), (Operations{8, 1, 0, 0}));
  EXPECT_EQ(image("semi_diameter_mm: 5", request_for(true, false)), (Operations{9, 1, 0, 0}));
  // a turned frame: 9 products and 6 sums each for position and direction, and 3 sums
  EXPECT_EQ(image("tilt_deg: [1, 0, 0]", request_for(true, false)), (Operations{6 + 33, 1, 0, 0}));
}

TEST(Plan, bytes_are_those_of_columns_and_of_the_surfaces_numbers) {
  const Plan spots = plan_of_text(lens("conic: {radius_mm: 10}"), request_for(true, false));
  EXPECT_EQ(spots.surfaces.at(0).bytes_per_ray, 2u * (6 * 8 + 4));
  EXPECT_EQ(spots.surfaces.at(0).data_bytes, 8u);  // the curvature
  EXPECT_EQ(spots.surfaces.at(1).data_bytes, 0u);
  EXPECT_EQ(plan_of_text(lens("conic: {radius_mm: 10}")).surfaces.at(0).bytes_per_ray, 2u * (7 * 8 + 4));
  const Plan zernike = plan_of_text(lens("zernike: {radius_mm: 10, normalization_radius_mm: 2, indexing: osa, coefficients_um: {12: 1}}"));
  EXPECT_EQ(zernike.surfaces.at(0).kernel, "Zernike polynomial of order 4");
  EXPECT_EQ(zernike.surfaces.at(0).data_bytes, sizeof(surface::Zernike) + 15 * 8);
}

TEST(Plan, only_what_is_asked_for_is_planned) {
  const std::string system = lens("conic: {radius_mm: 10}");
  const Plan spots = plan_of_text(system, request_for(true, false)), wavefronts = plan_of_text(system, request_for(false, true)), both = plan_of_text(system);
  EXPECT_FALSE(spots.has_opl);
  EXPECT_TRUE(wavefronts.has_opl && both.has_opl);
  EXPECT_EQ(first_of(both) - first_of(spots), (Operations{2, 0, 0, 0}));
  EXPECT_EQ(first_of(both), first_of(wavefronts));
  for (const Plan* plan : {&spots, &both}) {
    ASSERT_EQ(omissions(*plan, "optical path lengths").size(), 1u);
    EXPECT_THAT(omissions(*plan, "optical path lengths")[0].saves, HasSubstr("4 additions and multiplications a ray, 32 bytes"));
  }
  EXPECT_TRUE(omissions(wavefronts, "optical path").empty());
  for (const char* what : {"wavefronts", "wavefront.exr"}) {
    EXPECT_EQ(omissions(spots, what).size(), 1u);
    EXPECT_TRUE(omissions(both, what).empty() && omissions(wavefronts, what).empty());
  }
  for (const char* what : {"spots", "spot.exr"}) {
    EXPECT_EQ(omissions(wavefronts, what).size(), 1u);
    EXPECT_TRUE(omissions(both, what).empty() && omissions(spots, what).empty());
  }
}

// What is left out of a scene is said, and not where it is there.
TEST(Plan, says_what_is_left_out_and_nothing_else) {
  struct Case {
    const char* begin;
    std::string without, with;  // surfaces: without the feature, so that something is left out; and with it
    const char* saves;
  };
  const std::string image = "  - {}\n", aperture = "semi_diameter_mm: 3, ";
  const std::string glass = "  - {stop: true, " + aperture + "conic: {radius_mm: 10}, thickness_mm: 20, medium: {index: 1.5}}\n";
  const std::string turned_image = "  - {semi_diameter_mm: 9, decenter_mm: [0, 0.1, 0]}\n";
  const auto surface = [&](const std::string& keys, const std::string& index = "1.5") {
    return "  - {stop: true, " + keys + ", thickness_mm: 20, medium: {index: " + index + "}}\n  - {semi_diameter_mm: 9}\n";
  };
  const auto zernike = [&](const std::string& terms) {
    return surface("zernike: {radius_mm: 10, conic_constant: -0.5, normalization_radius_mm: 2, indexing: osa, coefficients_um: " + terms + "}");
  };
  const std::vector<Case> cases{
      {"aperture tests of surface 2", glass + image, glass + "  - {semi_diameter_mm: 9}\n", "3 additions"},
      {"turns into the frames of surfaces 1-2", glass + image, "  - {stop: true, decenter_mm: [0, 1, 0], thickness_mm: 20, medium: {index: 1.5}}\n" + turned_image, "66 additions"},
      {"tracing surface 2", glass + "  - {thickness_mm: 1, medium: {index: 1.5}}\n" + image, glass + "  - {thickness_mm: 1, medium: {index: 1.6}}\n" + image, "division"},
      {"tracing surface 2", glass + "  - {thickness_mm: 1, medium: {index: 1.5}}\n" + image, glass + "  - {semi_diameter_mm: 3, thickness_mm: 1, medium: {index: 1.5}}\n" + image, "division"},
      {"refraction at surface 1", surface("conic: {radius_mm: 10}", "1"), surface("conic: {radius_mm: 10}"), "1 root"},
      {"kernel 'conic' for surface 1", surface("conic: {radius_mm: 10}"), surface("conic: {radius_mm: 10, conic_constant: -1}"), "1 division"},
      {"kernel 'conic' for surface 1", surface("conic: {radius_mm: .inf}"), surface("plane: {}"), "root"},
      {"kernel 'Zernike polynomial without terms' for surface 1", zernike("{0: 0, 9: 0}"), zernike("{0: 0, 9: 1}"), ""},
      {"Zernike terms of surface 1 from order 3 to 4", zernike("{4: 1, 9: 0, 14: 0}"), zernike("{4: 1, 9: 0, 14: 1}"), "additions"},
      {"Zernike terms of surface 1 from order 3 to 20", zernike("{4: 1, 230: 0}"), zernike("{4: 1, 230: 1}"), "recurrence"},
      {"dispersion of the media in 1 gap", "  - {stop: true, conic: {radius_mm: 10}, thickness_mm: 20, medium: N-BK7}\n  - {medium: N-BK7}\n", glass + "  - {medium: N-BK7}\n", "indices"}};
  for (const Case& one : cases) {
    SCOPED_TRACE(one.begin);
    const Plan without = plan_of_text(one.without, request_for(true, false)), with = plan_of_text(one.with, request_for(true, false));
    const auto found = omissions(without, one.begin);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_THAT(found[0].saves, HasSubstr(one.saves));
    EXPECT_TRUE(omissions(with, one.begin).empty());
  }
  EXPECT_EQ(cases.size(), 11u);
  EXPECT_TRUE(omissions(plan_of_text(zernike("{4: 1, 14: 1}")), "Zernike terms").empty());
}

// Numbers are told, and add up: what an omission saves is what the scene with the feature takes more.
TEST(Plan, what_an_omission_saves_is_the_difference_of_two_plans) {
  const JobRequest spots = request_for(true, false);
  const Plan centred = plan_of_text(lens("conic: {radius_mm: 10}"), spots), turned = plan_of_text(lens("conic: {radius_mm: 10}, tilt_deg: [1, 0, 0]"), spots);
  EXPECT_EQ(first_of(turned) - first_of(centred), (Operations{33, 0, 0, 0}));
  const Plan open = plan_of_text(lens("conic: {radius_mm: 10}"), spots), stopped = plan_of_text(lens("conic: {radius_mm: 10}, semi_diameter_mm: 3"), spots);
  EXPECT_EQ(first_of(stopped) - first_of(open), (Operations{3, 0, 0, 0}));
}

TEST(Plan, a_surface_that_is_passed_by_has_neither_kernel_nor_data) {
  const Plan plan = plan_of_text("  - {stop: true, thickness_mm: 2}\n  - {conic: {radius_mm: 10}, thickness_mm: 20, medium: {index: 1.5}}\n  - {}\n");
  const SurfacePlan& dummy = plan.surfaces.at(0);
  EXPECT_EQ(dummy.kernel, "none: passed by");
  EXPECT_EQ(dummy.operations.value(), (Operations{5, 0, 0, 0}));  // d . axis
  EXPECT_EQ(dummy.bytes_per_ray, 3u * 8 + 4);
  EXPECT_EQ(plan.surfaces.at(1).kernel, "sphere");
}

// Two media of one index at the first wavelength differ at the second: the surface is traced.
TEST(Plan, a_surface_between_media_that_differ_at_one_wavelength_is_not_passed_by) {
  const std::string surfaces = "  - {stop: true, conic: {radius_mm: 10}, thickness_mm: 2, medium: {index: 1.5168}}\n"
                               "  - {thickness_mm: 20, medium: {nd: 1.5168, vd: 64}}\n  - {}\n";
  const auto plan = [&](const std::string& wavelengths) {
    const scene::CompileResult compiled = compile_text("sagitta: 1\nwavelengths_nm: [" + wavelengths + "]\naperture: {entrance_pupil_diameter_mm: 2}\nsurfaces:\n" + surfaces);
    return analysis::plan_of(compiled, {}).surfaces.at(1);
  };
  EXPECT_EQ(plan("587.5618").kernel, "none: passed by");
  EXPECT_EQ(plan("587.5618, 633").kernel, "plane");
  EXPECT_EQ(plan("587.5618, 633").operations.value().roots, 1);
  EXPECT_EQ(plan("587.5618, 633").operations, plan("633").operations);
}

// A ray is found where the chief ray is stopped, and where none comes the plan says so.
TEST(Plan, surfaces_that_no_ray_reaches_have_no_count) {
  const Plan obscured = plan_of_text(lens("conic: {radius_mm: 10}, inner_semi_diameter_mm: 0.5"));
  EXPECT_TRUE(obscured.surfaces.at(1).operations);
  const Plan lost = plan_of_text("  - {stop: true, thickness_mm: 1}\n  - {conic: {radius_mm: 1}, decenter_mm: [0, 5, 0], thickness_mm: 5}\n  - {}\n");
  EXPECT_TRUE(lost.surfaces.at(0).operations);
  EXPECT_FALSE(lost.surfaces.at(2).operations);
}

TEST(Plan, every_shape_has_a_name_a_count_and_its_bytes) {
  std::string points;
  for (int i = -12; i <= 12; ++i)
    for (int j = -12; j <= 12; ++j) points += std::to_string(0.2 * i + 0.013 * (j % 3)) + " " + std::to_string(0.2 * j) + " " + std::to_string(0.01 * (i * i + j * j) / 5) + "\n";
  const Folder folder;
  const std::string file = folder.file("points.xyz", points);
  std::size_t facets = 0;
  for (const auto& [interpolation, kernel] : std::vector<std::pair<std::string, std::string>>{
           {"linear", "flat facets"}, {"c1", "C1 patches"}, {"cubic", "cubic patches"}, {"thin_plate", "thin-plate patches"}, {"multiquadric", "multiquadric patches"}}) {
    const Plan plan = plan_of_text(lens("delaunay: {points: " + file + ", interpolation: " + interpolation + "}"), request_for(true, false));
    const SurfacePlan& one = plan.surfaces.at(0);
    EXPECT_EQ(one.kernel, kernel);
    EXPECT_GT(all(one.operations.value()), 50) << kernel;
    EXPECT_EQ(one.operations->logarithms > 0, interpolation == "thin_plate");
    EXPECT_EQ(one.bytes_per_ray, 2u * 52 + 52 + 2 * 49 + 2 * 52);
    if (interpolation == "linear") facets = one.data_bytes;
    // 25 x 25 points have some 2 x 24 x 24 facets of 64 bytes, 3 numbers of vertices and 4 cells of 4 bytes
    if (interpolation == "linear") EXPECT_NEAR(static_cast<double>(facets), 1152 * (64 + 12 + 16) + 625 * 24, 0.2 * 1152 * 92);
    else EXPECT_GT(one.data_bytes, facets + 1000 * 48) << kernel;
  }
}

}  // namespace
}  // namespace sagitta::test
