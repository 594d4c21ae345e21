// SPDX-License-Identifier: Apache-2.0
#include "lib/surface/zernike.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/multiprecision/cpp_dec_float.hpp>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "lib/numerics/arena.h"

namespace sagitta::surface {
namespace {

using numerics::ZernikeIndexing;
using numerics::ZernikeTerm;
using Real50 = boost::multiprecision::cpp_dec_float_50;

// What Zernike::from asks of parameters.
struct Given {
  double radius = INFINITY, K = 0, r0 = 1;
  std::string indexing = "osa";
  std::vector<std::pair<int, double>> coefficients{};
  double number(std::string_view key) const { return key == "radius_mm" ? radius : key == "conic_constant" ? K : r0; }
  const std::string& text(std::string_view) const { return indexing; }
  const std::vector<std::pair<int, double>>& list(std::string_view) const { return coefficients; }
};

Zernike make(const Given& given, numerics::Arena& arena) { return Zernike::from(given, arena); }

// The textbook's power series in 50 digits: independent of the recurrences.
Real50 radial_by_series(int order, int m, const Real50& rho) {
  Real50 sum = 0;
  for (int s = 0; s <= (order - m) / 2; ++s) {
    Real50 term = s % 2 == 0 ? 1 : -1;
    for (int i = 2; i <= order - s; ++i) term *= i;
    for (int i = 2; i <= s; ++i) term /= i;
    for (int i = 2; i <= (order + m) / 2 - s; ++i) term /= i;
    for (int i = 2; i <= (order - m) / 2 - s; ++i) term /= i;
    sum += term * pow(rho, order - 2 * s);
  }
  return sum;
}

// A38: c_n0 = integral of z N R_n^0 over the disc/pi; with u = rho^2 that is an integral over u from 0 to 1, by 30 Gauss points. Bound: 30 terms
// of at most 600 um times sqrt 9, each with a few roundings, cancel.
TEST(ZernikeBasis, conics_have_their_coefficients) {
  struct {
    double radius, K, exact_um[5];
  } const cases[] = {{7.77, -.18, {295.763165469668581, 172.597323913374786, 1.4517377258374059, .0239840199308884336, .000492254376246365735}},
                {7.8, -.25, {294.030605872988268, 171.40861484599897, 1.30051872398716335, .0193807932927644515, .000358803206027452385}},
                {7.72, -.26, {297.120021990227406, 173.222298318957577, 1.32434613389991331, .0198870690856348752, .000370996787047327356}}};
  for (const auto& [radius, K, exact_um] : cases) {
    const Conic conic{1 / radius, K};
    for (int order = 0; order <= 8; order += 2) {
      const auto integrand = [&](double u) {
        const double rho = std::sqrt(u);
        return 1e3 * conic.sag(3 * rho, 0.0) * numerics::zernike_value<double>(ZernikeIndexing::osa, {order, 0}, rho, 0.0);
      };
      EXPECT_NEAR((boost::math::quadrature::gauss<double, 30>::integrate(integrand, 0.0, 1.0)), exact_um[order / 2], 8e-12) << radius << " " << order;
    }
  }
}

// A22. zernike_value with the fringe norm (1) is R cos(m theta); along +x it is R.
TEST(ZernikeBasis, radial_polynomials_of_order_40_are_right_to_1e_12) {
  const auto R = [](int order, int m, double rho) {
    return numerics::zernike_value<double>(ZernikeIndexing::fringe, {order, m}, rho, 0.0);
  };
  const std::pair<double, double> spherical[] = {{.3, .15047524183158114198}, {.5, -.04835838106737355701625347137451171875},
      {.7, .16159966087243646406}, {.9, .081672041590832961662575306196029914082}, {.95, .21559885904881353266},
      {.99, .09347507764170056877941417550460396681889}};
  for (const auto& [rho, exact] : spherical) EXPECT_NEAR(R(40, 0, rho), exact, 1e-12) << rho;
  EXPECT_NEAR(R(40, 2, .7), .1650956655414075094, 1e-12);
  EXPECT_NEAR(R(40, 20, .7), .067775691603843781127, 1e-12);
  EXPECT_NEAR(R(40, 38, .95), -.41294764990448726153, 1e-12);
  EXPECT_NEAR(R(40, 40, .95), std::pow(.95, 40), 1e-14);
  EXPECT_NEAR(R(39, 1, .7), .16451103124457989123, 1e-12);
  EXPECT_NEAR(R(40, 0, 1), 1, 1e-12);
  EXPECT_NEAR(R(40, 0, 0), 1, 1e-14);
}

TEST(ZernikeBasis, terms_up_to_order_30_agree_with_the_power_series_in_50_digits) {
  int compared = 0;
  for (int order = 0; order <= 30; ++order)
    for (int m = order % 2; m <= order; m += 2)
      for (const double rho : {0.1, 0.6, 0.97, 1.0}) {
        const double got = numerics::zernike_value<double>(ZernikeIndexing::fringe, {order, m}, rho, 0.0);
        EXPECT_NEAR(got, static_cast<double>(radial_by_series(order, m, Real50(rho))), 2e-13) << order << ' ' << m;
        ++compared;
      }
  EXPECT_EQ(compared, 4 * 256);
}

TEST(ZernikeBasis, indexings_name_the_standard_terms) {
  using numerics::fringe_term;
  using numerics::noll_term;
  using numerics::osa_term;
  EXPECT_EQ(osa_term(0), (ZernikeTerm{0, 0}));
  EXPECT_EQ(osa_term(3), (ZernikeTerm{2, -2}));
  EXPECT_EQ(osa_term(4), (ZernikeTerm{2, 0}));
  EXPECT_EQ(osa_term(12), (ZernikeTerm{4, 0}));
  EXPECT_EQ(osa_term(35), (ZernikeTerm{7, 7}));
  // Noll 1976, table I
  const ZernikeTerm noll[] = {{0, 0}, {1, 1}, {1, -1}, {2, 0}, {2, -2}, {2, 2}, {3, -1}, {3, 1}, {3, -3}, {3, 3}, {4, 0},
                              {4, 2}, {4, -2}, {4, 4}, {4, -4}};
  for (int j = 1; j <= 15; ++j) EXPECT_EQ(noll_term(j), noll[j - 1]) << j;
  EXPECT_EQ(noll_term(22), (ZernikeTerm{6, 0}));
  const ZernikeTerm fringe[] = {{0, 0}, {1, 1}, {1, -1}, {2, 0}, {2, 2}, {2, -2}, {3, 1}, {3, -1}, {4, 0}, {3, 3}, {3, -3},
                                {4, 2}, {4, -2}, {5, 1}, {5, -1}, {6, 0}};
  for (int j = 1; j <= 16; ++j) EXPECT_EQ(fringe_term(j), fringe[j - 1]) << j;
  EXPECT_EQ(fringe_term(36), (ZernikeTerm{10, 0}));
  EXPECT_EQ(fringe_term(37), (ZernikeTerm{12, 0}));
}

// Every pair (n, m) of the first orders appears once: no index is lost or doubled.
TEST(ZernikeBasis, osa_and_noll_list_the_same_terms_order_by_order) {
  for (int order = 0; order <= 20; ++order) {
    std::vector<int> from_osa, from_noll;
    for (int i = order * (order + 1) / 2; i < (order + 1) * (order + 2) / 2; ++i) {
      EXPECT_EQ(numerics::osa_term(i).n, order);
      EXPECT_EQ(numerics::noll_term(i + 1).n, order);
      from_osa.push_back(numerics::osa_term(i).m);
      from_noll.push_back(numerics::noll_term(i + 1).m);
    }
    std::sort(from_noll.begin(), from_noll.end());
    EXPECT_EQ(from_osa, from_noll);
  }
}

TEST(ZernikeSurface, value_is_the_sum_of_its_terms) {
  numerics::Arena arena;
  Given given{.radius = 7.72, .K = -0.26, .r0 = 3};
  for (int j = 0; j < 45; ++j) given.coefficients.push_back({j, std::sin(j + 1.0)});
  const Zernike surface = make(given, arena);
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, -0.5}, {-2.1, 1.9}, {3.5, 0.4}}) {
    double sum = Conic{1 / 7.72, -0.26}.sag(x, y);
    for (const auto& [j, um] : given.coefficients)
      sum += 1e-3 * um * numerics::zernike_value<double>(ZernikeIndexing::osa, numerics::osa_term(j), x / 3, y / 3);
    EXPECT_NEAR(surface.sag(x, y), sum, 1e-15 * 200);  // 45 terms of at most 1e-3 * 10, each within a few eps, and the base
  }
}

TEST(ZernikeSurface, gradient_agrees_with_50_digit_differences) {
  numerics::Arena arena;
  Given given{.radius = 7.72, .K = -0.26, .r0 = 3};
  for (int j = 0; j < 861; ++j) given.coefficients.push_back({j, 0.01 * std::sin(j + 1.0)});  // order 40
  const Zernike surface = make(given, arena);
  const Real50 h("1e-15");
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, -0.5}, {-2.0, 1.9}, {2.9, 0.0}}) {
    const Real50 X(x), Y(y);
    const auto difference_x = static_cast<double>((surface.sag<Real50>(X + h, Y) - surface.sag<Real50>(X - h, Y)) / (2 * h));
    const auto difference_y = static_cast<double>((surface.sag<Real50>(X, Y + h) - surface.sag<Real50>(X, Y - h)) / (2 * h));
    // derivatives grow like order^2 times the terms; 861 terms of 1e-5 mm, order 40, /3 mm: 5 mm/mm, eps of it times 40
    EXPECT_NEAR(surface.gradient(x, y).x, difference_x, 5e-14);
    EXPECT_NEAR(surface.gradient(x, y).y, difference_y, 5e-14);
  }
}

TEST(ZernikeSurface, without_terms_it_is_the_conic) {
  numerics::Arena arena;
  const Zernike surface = make({.radius = 7.72, .K = -0.26, .r0 = 3}, arena);
  const Vec3<double> p{1, 0.5, -2}, d = normalized(Vec3<double>{0.1, 0.05, 1});
  // one Newton step of a few roundings of the distance (2.3 mm) may be left
  EXPECT_NEAR(surface.meet(p, d).path, surface.base.meet(p, d).path, 4 * 2.3e-16 * 2.3);
}

// Z_4 (osa) = sqrt(3) (2 rho^2 - 1): a defocus term on a plane is the paraboloid of the same curvature, moved.
TEST(ZernikeSurface, defocus_on_a_plane_is_a_paraboloid) {
  numerics::Arena arena;
  const double r0 = 3, um = 100, c = 4 * std::sqrt(3.0) * um * 1e-3 / (r0 * r0);
  const Zernike surface = make({.r0 = r0, .coefficients = {{4, um}}}, arena);
  const Conic paraboloid{c, -1};
  const Vec3<double> p{1, -2, -4}, d = normalized(Vec3<double>{0.2, 0.3, 1});
  const double lift = std::sqrt(3.0) * um * 1e-3;  // the vertex lies at -lift
  const Vec3<double> p_from_vertex{p.x, p.y, p.z + lift};
  EXPECT_NEAR(surface.meet(p, d).path, paraboloid.meet(p_from_vertex, d).path, 1e-14);
  EXPECT_NEAR(surface.vertex_curvature(), c, 1e-16);
}

TEST(ZernikeSurface, vertex_curvatures_take_in_the_terms_of_their_sections) {
  numerics::Arena arena;
  Given given{.radius = -50, .K = 2, .r0 = 2.5};
  for (int j = 0; j < 66; ++j) given.coefficients.push_back({j, 0.3 * std::cos(2.0 * j)});
  const Zernike surface = make(given, arena);
  const Real50 h("1e-12");
  const Real50 second = (surface.sag<Real50>(0, h) - 2 * surface.sag<Real50>(0, 0) + surface.sag<Real50>(0, -h)) / (h * h);
  EXPECT_NEAR(surface.vertex_curvature(), static_cast<double>(second), 1e-13);
  const Real50 second_x = (surface.sag<Real50>(h, 0) - 2 * surface.sag<Real50>(0, 0) + surface.sag<Real50>(-h, 0)) / (h * h);
  EXPECT_NEAR(surface.vertex_curvature_x(), static_cast<double>(second_x), 1e-13);
}

TEST(ZernikeSurface, wild_surface_ends_in_a_hit_on_it_or_in_a_status) {
  numerics::Arena arena;
  // 0.5 mm of a high order on a cornea: slopes beyond 45 degrees, folds along tilted rays
  const Zernike surface = make({.radius = 7.72, .K = -0.26, .r0 = 3, .coefficients = {{230, 150}, {24, 200}}}, arena);
  int hits = 0, lost = 0;
  for (int i = -40; i <= 40; ++i)
    for (int k = -40; k <= 40; ++k) {
      const Vec3<double> p{0.07 * i, 0.07 * k, -3}, d = normalized(Vec3<double>{0.3, -0.01 * k, 1});
      const auto crossing = surface.meet(p, d);
      if (crossing.status != Status::ok) {
        ++lost;
        EXPECT_TRUE(std::isnan(crossing.path));
        continue;
      }
      ++hits;
      const Vec3<double> hit = p + crossing.path * d;
      const auto slope = surface.gradient(hit.x, hit.y);
      // on the surface within the rounding of its terms, times the slope
      EXPECT_NEAR(hit.z, surface.sag(hit.x, hit.y), 1e-13 * (1 + std::abs(slope.x) + std::abs(slope.y)));
    }
  EXPECT_EQ(hits + lost, 81 * 81);
  EXPECT_GT(hits, 4000);
}

// Beside the equator of the base conic the slope grows without bound: a step of Newton's method that is short only because
// of that has not found a hit. Conics moved along z by up to 0.3 mm, and lines that meet the base beside its rim.
// A ray along z leaves (x, y) where it is, so its last step may be long: the slopes are those behind it. Their rounding: some 30 operations on terms
// of the size of the slope, 0.3, and of the sum of the terms' slopes, less.
TEST(ZernikeSurface, slopes_are_right_to_rounding_for_rays_near_the_axis) {
  using Fifty = boost::multiprecision::number<boost::multiprecision::cpp_dec_float<50>, boost::multiprecision::et_off>;
  numerics::Arena arena;
  const Zernike surface = make({7.72, -.26, 3, "osa", {{3, .31}, {5, -2.13}, {7, -.35}, {12, .13}, {17, .02}}}, arena);
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> u(-2, 2);
  for (const double tilt : {0.0, 1e-12, 1e-9, 1e-6, 1e-3, .1})
    for (int i = 0; i < 200; ++i) {
      const Vec3<double> p{u(engine), u(engine), -1}, d = numerics::normalized(Vec3<double>{tilt * u(engine), tilt * u(engine), 1});
      const auto crossing = surface.meet(p, d);
      const auto exact = surface.meet(numerics::vec3_cast<Fifty>(p), numerics::vec3_cast<Fifty>(d));
      ASSERT_EQ(crossing.status, Status::ok);
      EXPECT_NEAR(crossing.normal.x / crossing.normal.z, static_cast<double>(Fifty(exact.normal.x / exact.normal.z)), 30 * .3 * 1.2e-16) << tilt;
      EXPECT_NEAR(crossing.normal.y / crossing.normal.z, static_cast<double>(Fifty(exact.normal.y / exact.normal.z)), 30 * .3 * 1.2e-16) << tilt;
    }
}

TEST(ZernikeSurface, a_line_that_passes_the_rim_of_the_base_conic_finds_no_hit) {
  std::mt19937_64 engine(1);
  const auto u = [&](double low, double high) { return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53; };
  int hits = 0, lost = 0;
  for (int i = 0; i < 20000; ++i) {
    numerics::Arena arena;
    const double radius = u(5, 20), K = u(-0.5, 2), angle = u(0, 6.3), r = radius / std::sqrt(1 + K) * (1 - u(0, 1e-4));
    const Zernike surface = make({.radius = radius, .K = K, .r0 = 4, .coefficients = {{0, u(-300, 300)}}}, arena);
    const Vec3<double> at{r * std::cos(angle), r * std::sin(angle), Conic{1 / radius, K}.sag(r, 0.0)};
    const Vec3<double> d = normalized(Vec3<double>{0.8 * std::cos(angle) + u(-0.3, 0.3), 0.8 * std::sin(angle) + u(-0.3, 0.3), -u(0.1, 1)});
    const auto crossing = surface.meet(at - 3.0 * d, d);
    if (crossing.status != Status::ok) {
      ++lost;
      continue;
    }
    ++hits;
    EXPECT_TRUE(std::isfinite(crossing.along));
    const Vec3<double> hit = at + (crossing.path - 3) * d;
    const auto h = surface.height(hit.x, hit.y);
    if (!std::isfinite(h.dz_dx + h.dz_dy)) continue;  // rounding of the hit itself took it over the rim
    // within 64 roundings of the path of some 20 mm, times the slope
    EXPECT_NEAR(hit.z, h.z, 64 * 20 * 2.2e-16 * (1 + std::abs(h.dz_dx) + std::abs(h.dz_dy))) << i;
  }
  EXPECT_EQ(hits + lost, 20000);
  EXPECT_GT(hits, 5000);
  EXPECT_GT(lost, 5000);
}

// The polynomial of a term against the recurrence, over the disc and a little beyond. Bound: the polynomial's terms at
// |rho| = 1 add up to less than 2^14 times the highest coefficient up to order 12 (R_12^0: 8989; binomials of u^k included),
// each with 2 N roundings.
TEST(Polynomial, of_each_zernike_term_is_the_term) {
  for (int index = 0; index < 91; ++index) {
    const ZernikeTerm term = numerics::osa_term(index);
    std::vector<long double> expanded(numerics::Polynomial::count(12));
    numerics::add_zernike_term<long double>(term, 1.0L, 12, expanded);
    const std::vector<double> coefficients(expanded.begin(), expanded.end());
    const numerics::Polynomial polynomial{12, coefficients.data()};
    for (const double x : {-0.7, 0.0, 0.31, 0.99})
      for (const double y : {-0.71, 0.0, 0.13, 0.4}) {
        const auto p = polynomial.evaluate<Real50>(x, y);
        const auto of_term = [&](const Real50& at_x, const Real50& at_y) {
          return Real50(numerics::zernike_value<Real50>(ZernikeIndexing::fringe, term, at_x, at_y));  // norm 1
        };
        // coefficients are whole numbers: in 50 digits only rounding of the recurrence's doubles is left
        EXPECT_LE(abs(p.value - of_term(x, y)), 1e-13) << index;
        const Real50 h = 1e-12;
        EXPECT_LE(abs(p.along_x - (of_term(x + h, y) - of_term(x - h, y)) / (2 * h)), 1e-11) << index;
        EXPECT_LE(abs(p.along_y - (of_term(x, y + h) - of_term(x, y - h)) / (2 * h)), 1e-11) << index;
        EXPECT_LE(abs(polynomial.evaluate<double>(x, y).value - p.value), 0x1p14 * 24 * 0x1p-53) << index;
      }
  }
}

}  // namespace
}  // namespace sagitta::surface
