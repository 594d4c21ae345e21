// SPDX-License-Identifier: Apache-2.0
#include "lib/analysis/wavefront.h"

#include <fmt/format.h>

#include <cmath>

#include "tests/support/reference_opd.h"

namespace sagitta::test {
namespace {

using analysis::Wavefront;
using analysis::WavefrontRequest;
using analysis::WavefrontResult;
using surface::Status;

WavefrontResult measured(const CompiledScene& compiled, std::size_t field = 0, const WavefrontRequest& request = {}, std::size_t wavelength = 0) {
  return wavefront(compiled.scene, compiled.scene.wavelengths[wavelength], compiled.scene.fields[field], request);
}

CompiledScene shipped(const std::string& name) {
  const auto read = prescription::read_prescription(SAGITTA_SOURCE_DIR "/systems/" + name);
  EXPECT_TRUE(read.model) << name;
  return checked(scene::compile(*read.model));
}

// The sample at pupil point (i, j)/31.
std::size_t pixel(int i, int j, int size = 64) { return static_cast<std::size_t>((size - 1 - (j + size / 2)) * size + i + size / 2); }

double largest(const Wavefront& wavefront) {
  double result = 0;
  for (const double opd : wavefront.opd_waves)
    if (!std::isnan(opd)) result = std::max(result, std::abs(opd));
  return result;
}

// ZOSPy's simple lens in OpticStudio (S4 of references.md): 8 printed decimals, Zemax's "standard" terms are Noll's.
TEST(Wavefront, simple_lens_has_the_zernikes_of_opticstudio) {
  const CompiledScene compiled = checked(compile_text("sagitta: 1\nwavelengths_nm: [543]\naperture: {stop_diameter_mm: 2}\nsurfaces:\n  - {stop: true, thickness_mm: 0}\n"
                                                      "  - {conic: {radius_mm: 20}, thickness_mm: 1, medium: {index: 1.5}}\n  - {conic: {radius_mm: -20}, thickness_mm: 19.792}\n  - {}\n"));
  const WavefrontResult result = measured(compiled, 0, {.zernike_terms = 37, .indexing = numerics::ZernikeIndexing::noll});
  ASSERT_TRUE(result.wavefront && result.wavefront->zernike);
  const auto waves = [&](std::size_t index) { return result.wavefront->zernike->coefficients[index - 1] / 0.543; };
  EXPECT_NEAR(waves(1), -0.01473686, 1e-8);
  EXPECT_NEAR(waves(4), 0.00031809, 1e-8);
  EXPECT_NEAR(waves(11), 0.00684048, 1e-8);
  EXPECT_NEAR(waves(22), 3.01e-6, 1e-8);
  for (const std::size_t index : {2, 3, 5, 6, 7, 8, 9, 10}) EXPECT_NEAR(waves(index), 0, 1e-12);
  EXPECT_NEAR(result.wavefront->peak_to_valley_waves, 0.02350529, 1e-8);
  EXPECT_NEAR(result.wavefront->rms_waves, 0.00676187, 1e-8);
  EXPECT_NEAR(result.wavefront->reference_radius, -20.46997, 1e-5);  // S2
}

// The formula without cancellation against the contract's words: eyes with a curved retina, finite object, mirrors, a
// tilted image. Two paths of up to 4e4 mm in long double on top of double rays: 4 eps of 100 mm is 1e-13 mm, 2e-10
// waves; of the telescope's 4e4 mm, 1e-7 waves.
TEST(Wavefront, agrees_with_paths_taken_whole_to_the_sphere) {
  struct Case {
    CompiledScene compiled;
    double tolerance;
  };
  std::vector<Case> cases;
  for (const char* name : {"navarro-eye.yaml", "double-gauss.yaml", "cooke-triplet.yaml", "cornea-zernike.yaml"}) cases.push_back({shipped(name), 2e-9});
  cases.push_back({shipped("ritchey-chretien.yaml"), 2e-7});
  cases.push_back({scene_of("  - {stop: true, conic: {radius_mm: 40}, thickness_mm: 6, medium: {index: 1.6}}\n  - {conic: {radius_mm: -60}, thickness_mm: 80, tilt_deg: [1, 2, 0]}\n"
                            "  - {conic: {radius_mm: 200}, tilt_deg: [10, -5, 20], decenter_mm: [0.1, 0.2, 0.3]}\n",
                            "object_na: 0.05", "object: {distance_mm: 120, medium: {index: 1.2}}\nfields: {object_heights_mm: [[0, 0], [2, -5]]}\n"), 2e-9});
  int compared = 0;
  for (const Case& one : cases) {
    const scene::Scene& scene = one.compiled.scene;
    for (std::size_t field = 0; field < scene.fields.size(); ++field) {
      const WavefrontResult result = measured(one.compiled, field);
      ASSERT_TRUE(result.wavefront) << result.reason;
      const double exit_pupil = first_order(scene, scene.wavelengths[0], 1).exit_pupil.z;
      for (const auto& [i, j] : {std::pair{0, 31}, {31, 0}, {-31, 0}, {0, -31}, {20, -15}, {-7, 12}, {1, 0}}) {
        const double expected = reference_opd(scene, scene.wavelengths[0], scene.fields[field], exit_pupil, {i / 31.0, j / 31.0});
        const double got = result.wavefront->opd_waves[pixel(i, j)];
        EXPECT_EQ(std::isnan(got), std::isnan(expected));
        if (std::isnan(expected)) continue;
        EXPECT_NEAR(got, expected, one.tolerance + 1e-12 * std::abs(expected));
        ++compared;
      }
    }
  }
  EXPECT_GE(compared, 100);
}

TEST(Wavefront, grid_has_the_chief_ray_at_its_middle_index_and_the_rim_at_its_last) {
  const CompiledScene compiled = shipped("navarro-eye.yaml");
  const WavefrontResult result = measured(compiled);
  ASSERT_TRUE(result.wavefront);
  int inside = 0;
  for (int i = -32; i < 32; ++i)
    for (int j = -32; j < 32; ++j) {
      const std::size_t at = pixel(i, j);
      const bool in_disc = i * i + j * j <= 31 * 31;
      EXPECT_EQ(result.wavefront->mask[at], in_disc ? 0 : analysis::outside_pupil) << i << ' ' << j;
      EXPECT_EQ(std::isnan(result.wavefront->opd_waves[at]), !in_disc);
      inside += in_disc;
    }
  EXPECT_EQ(result.rays.total(), inside);
  EXPECT_EQ(result.rays[Status::ok], inside);
  EXPECT_EQ(result.wavefront->opd_waves[pixel(0, 0)], 0);
  // off axis the map is symmetric in x, not in y, and row 0 is the largest y
  const WavefrontResult oblique = measured(compiled, 2);
  EXPECT_NEAR(oblique.wavefront->opd_waves[pixel(12, 20)], oblique.wavefront->opd_waves[pixel(-12, 20)], 1e-9);
  const double above = reference_opd(compiled.scene, compiled.scene.wavelengths[0], compiled.scene.fields[2], first_order(compiled.scene, compiled.scene.wavelengths[0], 1).exit_pupil.z, {0, 1});
  EXPECT_NEAR(oblique.wavefront->opd_waves[32], above, 1e-9);
  EXPECT_GT(std::abs(above - oblique.wavefront->opd_waves[pixel(0, -31)]), 0.1);
}

// A36: the image of A1 is perfect, 50 mm behind the surface; an image surface dz behind it sees OPD = n' dz (1 - cos U'),
// positive like the OSA defocus of a myopic eye. The next order is dz^2 sin^2 U'/(2 R) = 4e-10 mm.
TEST(Wavefront, an_image_before_the_image_surface_has_positive_opd_at_the_rim) {
  for (const double dz : {1e-3, -1e-3}) {
    const CompiledScene compiled = scene_of(fmt::format("  - {{stop: true, conic: {{radius_mm: -25, conic_constant: -2.25}}, thickness_mm: {:.17g}}}\n  - {{}}\n", 50 + dz),
                                            "entrance_pupil_diameter_mm: 20", "object: {medium: {index: 1.5}}\n");
    const WavefrontResult result = measured(compiled);
    ASSERT_TRUE(result.wavefront);
    const double sag = -1.90890230020664453827879131203208535811, U = std::atan(10 / (50 - sag));
    EXPECT_NEAR(result.wavefront->opd_waves[pixel(0, 31)] * 550e-6, dz * (1 - std::cos(U)), 1e-9);
    ASSERT_TRUE(result.wavefront->zernike);
    EXPECT_EQ(result.wavefront->zernike->coefficients[4] > 0, dz > 0);
  }
}

// The Navarro eye is focused for 543 nm: myopic for 458, hyperopic for 632.8. By E3 the refraction changes by -0.774077 and
// +0.414468 D; M = -4 sqrt3 c20/r^2 with the Zernike's own curvature, which includes -the- higher terms of the spherical
// aberration (adds 12 sqrt5 c40/r^2 in the paraxial form).
TEST(Wavefront, defocus_of_a_myopic_eye_is_positive) {
  const CompiledScene compiled = shipped("navarro-eye.yaml");
  const auto refraction = [&](std::size_t w) {
    const WavefrontResult result = measured(compiled, 0, {}, w);
    const auto& c = result.wavefront->zernike->coefficients;
    return -(4 * std::sqrt(3) * c[4] - 12 * std::sqrt(5) * c[12] + 24 * std::sqrt(7) * c[24]) / 4;
  };
  const double at_543 = refraction(0), at_458 = refraction(1), at_633 = refraction(2);
  // to 1 %: the refraction is at the vertex, the OPD at the entrance pupil 3.04 mm behind
  EXPECT_NEAR(at_543, 0, 0.01);
  EXPECT_NEAR(at_458, -0.774077, 0.008);
  EXPECT_NEAR(at_633, 0.414468, 0.006);
}

// A1, A2, A4 and the Cassegrain of A23 are perfect. OPL is good to 4 ulp of the largest partial path: 2.8e-14 mm at
// 100 mm, 1e-12 at 2019 mm; with the rounding of the hit on the image (b of (3)) as much again. In waves of 550 nm.
TEST(Wavefront, perfect_systems_have_none) {
  const double m = 8, k = 0.25, R2 = 2 * m * k * 1000 / (m - 1);
  struct Case {
    CompiledScene compiled;
    double path;
  };
  const Case cases[] = {
      {scene_of("  - {stop: true, conic: {radius_mm: -25, conic_constant: -2.25}, thickness_mm: 50}\n  - {}\n", "entrance_pupil_diameter_mm: 20", "object: {medium: {index: 1.5}}\n"), 75},
      {scene_of("  - {stop: true, conic: {radius_mm: 6.035928143712574850299401197604790419162, conic_constant: -0.5602567320448922514252931263222058876259}, thickness_mm: 24, medium: {index: 1.336}}\n  - {}\n",
                "entrance_pupil_diameter_mm: 16"), 32},
      {scene_of("  - {stop: true, conic: {radius_mm: -45, conic_constant: -0.25}, thickness_mm: -90, medium: mirror}\n  - {}\n", "object_na: 0.3", "object: {distance_mm: 30}\n"), 120},
      {scene_of(fmt::format("  - {{stop: true, conic: {{radius_mm: -2000, conic_constant: -1}}, thickness_mm: -750, medium: mirror}}\n"
                            "  - {{conic: {{radius_mm: {:.17g}, conic_constant: {:.17g}}}, thickness_mm: 2000, medium: mirror}}\n  - {{}}\n", -R2, -std::pow((m + 1) / (m - 1), 2)),
                "entrance_pupil_diameter_mm: 500"), 2019}};
  for (const Case& one : cases) {
    const WavefrontResult result = measured(one.compiled);
    ASSERT_TRUE(result.wavefront) << result.reason;
    EXPECT_LE(largest(*result.wavefront), 16 * 2.2e-16 * one.path / 550e-6) << one.path;
  }
}

// A thin lens of f = 50 with the stop 50 - delta before it: the exit pupil stands 2500/delta before the lens. On
// both sides of 1e8 mm, and at infinity, the map is the same: moving the stop by 2e-6 mm moves the beam of 2 degrees by
// 1e-7 mm on the lens, where OPD changes by less than 10 waves/mm.
TEST(Wavefront, goes_over_into_the_plane_limit_without_a_step) {
  const auto at = [](double delta) {
    return scene_of(fmt::format("  - {{stop: true, thickness_mm: {:.17g}}}\n  - {{conic: {{radius_mm: 50}}, thickness_mm: 0, medium: {{index: 1.5}}}}\n  - {{conic: {{radius_mm: -50}}, thickness_mm: 50}}\n  - {{}}\n", 50 - delta),
                    "entrance_pupil_diameter_mm: 6", "fields: {angles_deg: [[0, 0], [0, 2]]}\n");
  };
  const CompiledScene sphere = at(2.6e-5), plane = at(2.4e-5), telecentric = at(0), beyond = at(-2.6e-5);
  int compared = 0;
  for (std::size_t field = 0; field < 2; ++field) {
    const WavefrontResult a = measured(sphere, field), b = measured(plane, field), c = measured(telecentric, field), d = measured(beyond, field);
    ASSERT_TRUE(a.wavefront && b.wavefront && c.wavefront && d.wavefront);
    EXPECT_LT(std::abs(a.wavefront->reference_radius), 1e8);
    EXPECT_GT(std::abs(b.wavefront->reference_radius), 1e8);
    EXPECT_TRUE(std::isinf(c.wavefront->reference_radius));
    EXPECT_LT(d.wavefront->reference_radius * a.wavefront->reference_radius, 0);  // the sphere turns over
    EXPECT_GT(largest(*a.wavefront), 0.3);
    for (std::size_t i = 0; i < a.wavefront->mask.size(); ++i) {
      if (a.wavefront->mask[i] != 0) continue;
      EXPECT_NEAR(a.wavefront->opd_waves[i], b.wavefront->opd_waves[i], 2e-6);
      EXPECT_NEAR(c.wavefront->opd_waves[i], b.wavefront->opd_waves[i], 2e-5);
      EXPECT_NEAR(d.wavefront->opd_waves[i], a.wavefront->opd_waves[i], 4e-5);
      ++compared;
    }
  }
  EXPECT_GT(compared, 5000);
}

TEST(Wavefront, says_why_there_is_none) {
  const auto reason = [](const CompiledScene& compiled, std::size_t field = 0) {
    const WavefrontResult result = measured(compiled, field);
    EXPECT_FALSE(result.wavefront);
    return result.reason;
  };
  EXPECT_EQ(reason(scene_of("  - {stop: true, thickness_mm: 5}\n  - {}\n")), "the image is afocal");
  // collimated by a lens whose rounding leaves some power
  EXPECT_EQ(reason(scene_of("  - {stop: true, conic: {radius_mm: 37.5003}, thickness_mm: 10, medium: {index: 1.513}}\n  - {}\n", "entrance_pupil_diameter_mm: 2",
                            fmt::format("object: {{distance_mm: {:.17g}}}\n", 37.5003 / 0.513))), "the image is afocal");
  const std::string lens = "  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 4, medium: {index: 1.5}}\n  - {conic: {radius_mm: -50}, thickness_mm: 48, semi_diameter_mm: 1}\n  - {}\n";
  EXPECT_EQ(reason(scene_of(lens, "entrance_pupil_diameter_mm: 4", "fields: {angles_deg: [[0, 30]]}\n")), "the chief ray is lost: clipped at surface 2");
  EXPECT_EQ(reason(scene_of("  - {stop: true, thickness_mm: 4}\n  - {conic: {radius_mm: 2}, thickness_mm: 4, medium: {index: 1.5}}\n  - {}\n", "entrance_pupil_diameter_mm: 1",
                            "fields: {angles_deg: [[0, 50]]}\n")), "the chief ray is lost: missed at surface 2");
  // all but the chief ray are clipped by an obscuration, and the chief ray serves only
  const CompiledScene shadowed = scene_of("  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 100, medium: {index: 1.5}, inner_semi_diameter_mm: 5}\n  - {}\n");
  const WavefrontResult none = measured(shadowed);
  EXPECT_FALSE(none.wavefront);
  EXPECT_EQ(none.reason, "no ray of the pupil grid arrived");
  EXPECT_EQ(none.rays[Status::clipped], none.rays.total());
  EXPECT_GT(none.rays.total(), 3000);
}

TEST(Wavefront, a_chief_ray_clipped_by_an_obscuration_only_still_serves) {
  const CompiledScene open = scene_of("  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 100, medium: {index: 1.5}}\n  - {}\n", "entrance_pupil_diameter_mm: 10");
  const CompiledScene shadowed = scene_of("  - {stop: true, conic: {radius_mm: 50}, thickness_mm: 100, medium: {index: 1.5}, inner_semi_diameter_mm: 2}\n  - {}\n", "entrance_pupil_diameter_mm: 10");
  const WavefrontResult a = measured(open), b = measured(shadowed);
  ASSERT_TRUE(a.wavefront && b.wavefront);
  int clipped = 0;
  for (std::size_t i = 0; i < a.wavefront->mask.size(); ++i) {
    if (b.wavefront->mask[i] == 0) {
      EXPECT_EQ(a.wavefront->opd_waves[i], b.wavefront->opd_waves[i]);
    } else {
      EXPECT_TRUE(std::isnan(b.wavefront->opd_waves[i]));
      clipped += b.wavefront->mask[i] == static_cast<std::uint32_t>(Status::clipped);
    }
  }
  EXPECT_EQ(b.wavefront->mask[pixel(0, 0)], static_cast<std::uint32_t>(Status::clipped));
  EXPECT_EQ(clipped, b.rays[Status::clipped]);
  EXPECT_EQ(b.rays.total(), a.rays.total());
  EXPECT_NEAR(static_cast<double>(clipped) / static_cast<double>(b.rays.total()), 0.16, 0.005);
}

// T16: on an annulus Zernikes are not orthogonal. RMS is that of the samples about their mean, tilt included.
TEST(Wavefront, rms_and_peak_to_valley_are_those_of_the_samples) {
  const CompiledScene compiled = shipped("ritchey-chretien.yaml");
  for (std::size_t field = 0; field < 3; ++field) {
    const WavefrontResult result = measured(compiled, field);
    ASSERT_TRUE(result.wavefront);
    double sum = 0, count = 0, squares = 0, low = INFINITY, high = -INFINITY;
    for (const double opd : result.wavefront->opd_waves)
      if (!std::isnan(opd)) sum += opd, ++count, low = std::min(low, opd), high = std::max(high, opd);
    for (const double opd : result.wavefront->opd_waves)
      if (!std::isnan(opd)) squares += (opd - sum / count) * (opd - sum / count);
    EXPECT_NEAR(result.wavefront->rms_waves, std::sqrt(squares / count), 1e-12 * high);
    EXPECT_DOUBLE_EQ(result.wavefront->peak_to_valley_waves, high - low);
    EXPECT_EQ(count, result.rays[Status::ok]);
  }
}

TEST(Wavefront, mask_holds_the_status_of_each_ray) {
  // the rim of the beam misses the ball, its middle is shadowed, a ring of it is clipped behind
  const CompiledScene compiled = scene_of("  - {stop: true, thickness_mm: 5, inner_semi_diameter_mm: 0.5}\n  - {conic: {radius_mm: 4}, thickness_mm: 4, medium: {index: 1.5}}\n"
                                          "  - {thickness_mm: 4, semi_diameter_mm: 2, medium: {index: 1.5}}\n  - {}\n", "entrance_pupil_diameter_mm: 10");
  const WavefrontResult result = measured(compiled);
  ASSERT_TRUE(result.wavefront) << result.reason;
  const auto code = [&](int i) { return static_cast<Status>(result.wavefront->mask[pixel(i, 0)]); };
  EXPECT_EQ(code(3), Status::clipped);
  EXPECT_EQ(code(4), Status::ok);
  EXPECT_EQ(code(31), Status::missed);
  EXPECT_EQ(code(24), Status::clipped);
  std::array<int, surface::status_count> counted{};
  for (std::size_t i = 0; i < result.wavefront->mask.size(); ++i) {
    if (result.wavefront->mask[i] < counted.size()) ++counted[result.wavefront->mask[i]];
    EXPECT_EQ(std::isnan(result.wavefront->opd_waves[i]), result.wavefront->mask[i] != 0);
  }
  for (std::size_t i = 0; i < counted.size(); ++i) EXPECT_EQ(counted[i], result.rays.of[i]);
}

// The exit pupil 1 mm before a plane that the rays are 5 mm short of focusing on: the rim passes the sphere by.
TEST(Wavefront, a_ray_that_does_not_meet_the_reference_sphere_is_missed) {
  const CompiledScene compiled = scene_of("  - {conic: {radius_mm: 25}, thickness_mm: 0, medium: {index: 1.5}}\n  - {thickness_mm: 44}\n  - {stop: true, thickness_mm: 0.2}\n  - {}\n",
                                          "entrance_pupil_diameter_mm: 10");
  const WavefrontResult result = measured(compiled);
  ASSERT_TRUE(result.wavefront) << result.reason;
  EXPECT_NEAR(std::abs(result.wavefront->reference_radius), 0.2, 1e-12);
  EXPECT_GT(result.rays[Status::missed], 100);
  EXPECT_GT(result.rays[Status::ok], 100);
  EXPECT_EQ(result.rays.endings.size(), 1u);
  EXPECT_EQ(result.rays.endings.begin()->first, trace::ending(4, Status::missed));
}

TEST(Wavefront, has_the_same_bits_for_any_thread_count_and_grids_of_other_sizes_share_points) {
  const CompiledScene compiled = shipped("navarro-eye.yaml");
  const WavefrontResult one = measured(compiled, 1, {.size = 128}), many = measured(compiled, 1, {.size = 128, .thread_count = 8});
  for (std::size_t i = 0; i < one.wavefront->mask.size(); ++i)
    EXPECT_TRUE(one.wavefront->opd_waves[i] == many.wavefront->opd_waves[i] || one.wavefront->mask[i] != 0);
  EXPECT_EQ(one.wavefront->zernike->coefficients, many.wavefront->zernike->coefficients);
  // (i - 64)/63 and (i - 32)/31 meet at 0 and +-1
  const WavefrontResult small = measured(compiled, 1);
  EXPECT_EQ(small.wavefront->opd_waves[pixel(0, 31)], one.wavefront->opd_waves[pixel(0, 63, 128)]);
  EXPECT_EQ(small.wavefront->opd_waves[pixel(-31, 0)], one.wavefront->opd_waves[pixel(-63, 0, 128)]);
}

}  // namespace
}  // namespace sagitta::test
