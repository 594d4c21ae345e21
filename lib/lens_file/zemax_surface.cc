// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/zemax_surface_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "lib/lens_file/numbers.h"
#include "lib/surface/conic.h"
#include "lib/surface/xy_polynomial.h"

namespace sagitta::lens_file {
namespace {

constexpr Real um_per_mm = 1000;
constexpr double most_of_a_term = 1e18;

class Reader {
 public:
  Reader(const ZemaxSurface& given, Real unit_mm, Report& report) : given_(given), unit_(unit_mm), report_(report), parm_(given.parm), xdat_(given.xdat) {}

  Real unit() const { return unit_; }
  std::string grid_file() const { return grid_file_of(given_, unit_, report_); }
  double radius() const { return radius_of(given_.curvature.value / unit_, given_.curvature.rounding / unit_); }
  double conic() const { return static_cast<double>(given_.conic.value); }
  // A length in mm.
  double length(Real value) const { return static_cast<double>(value * unit_); }

  // A parameter, which is then used; 0 where the file has none.
  PlacedNumber parm(int i) { return take(parm_, i); }
  PlacedNumber xdat(int i) { return take(xdat_, i); }
  // A radius as a parameter: 0 is a plane.
  double radius_parm(int i) {
    const Real radius = parm(i).value;
    return radius == 0 ? std::numeric_limits<double>::infinity() : length(radius);
  }
  double conic_parm(int i) {
    const PlacedNumber given = parm(i);
    const double k = static_cast<double>(given.value);
    if (!surface::conic_constants.contains(k))
      report_.broken(given.place, fmt::format("PARM {} of {}: a conic constant lies from {:g} to {:g}", i, given_.type, surface::conic_constants.low, surface::conic_constants.high));
    return k;
  }
  // Coefficients of powers, from PARM `first` on.
  Indexed powers(int first, int last, int first_power, int step) {
    Indexed found;
    for (int i = first, k = first_power; i <= last; ++i, k += step)
      if (const double a = kept(parm(i).value * power(unit_, 1 - k)); a != 0) found[k] = a;
    return found;
  }
  // Terms of an extra-data surface: XDAT 1 is their number, XDAT 2 the radius of normalisation, XDAT 3, ... are their coefficients, in lens units.
  struct Terms {
    double normalization_radius = 1;
    Indexed coefficients;
  };
  Terms terms(int most, Real per_mm) {
    Terms found;
    const PlacedNumber count = xdat(1), radius = xdat(2);
    if (!(count.value >= 0 && count.value <= most))
      report_.broken(place_of(count), fmt::format("XDAT 1 of {}: {} terms, where there may be 0 to {}", given_.type, number_text(static_cast<double>(count.value)), most));
    for (int j = 1; j <= most && j <= count.value; ++j)
      if (const PlacedNumber c = xdat(j + 2); c.value != 0) {
        found.coefficients[j] = kept(c.value * unit_ * per_mm);
        if (!(std::abs(found.coefficients[j]) <= most_of_a_term)) report_.broken(c.place, fmt::format("XDAT {} of {}: the coefficient is larger than a sag can be", j + 2, given_.type));
      }
    if (!found.coefficients.empty() && !(radius.value >= 1e-12L && radius.value <= 1e12L))
      report_.broken(place_of(radius), fmt::format("XDAT 2 of {}: the radius of normalisation is {}", given_.type, number_text(static_cast<double>(radius.value))), "it is positive");
    else
      found.normalization_radius = length(radius.value);
    return found;
  }

  // PARM 0 of Zernike terms: 1 where they count everywhere, as here; 0 where they are left out beyond the radius of normalisation. Older files have none.
  void extrapolate(const Terms& terms) {
    const PlacedNumber extrapolates = parm(0);
    if (extrapolates.place.line == 0 || extrapolates.value == 1 || terms.coefficients.empty()) return;
    if (extrapolates.value != 0) return leave_out(extrapolates, fmt::format("PARM 0 of {} is neither 0 nor 1", given_.type));
    const bool is_clipped = given_.clip && given_.clip->operand != "OBSC" && given_.clip->most > 0;
    const double reach = length(is_clipped ? given_.clip->most : given_.semi_diameter ? given_.semi_diameter->value : 0), radius = terms.normalization_radius;
    if (reach > 0 && reach <= radius) return;
    report_.warning(extrapolates.place, fmt::format("PARM 0 of {}: the terms end at the radius of normalisation, {} mm, and go on here; {}", given_.type, number_text(radius),
                                                    reach > 0 ? fmt::format("the surface reaches to {} mm", number_text(reach)) : "how far the surface reaches is not known"),
                    "an aperture (CLAP) of at most that radius keeps rays off what differs");
  }

  void leave_out(const PlacedNumber& number, const std::string& what) {
    if (number.value != 0) report_.left_out(number.place, what);
  }
  void leave_out_the_rest() {
    for (const auto& [operand, rest] : {std::pair{"PARM", &parm_}, std::pair{"XDAT", &xdat_}})
      for (const auto& [i, number] : *rest) leave_out(number, fmt::format("{} {} of a surface of type {} is not known", operand, i, prescription::excerpt(given_.type)));
  }

 private:
  Place place_of(const PlacedNumber& number) const { return number.place.line > 0 ? number.place : given_.place; }
  static PlacedNumber take(std::map<int, PlacedNumber>& from, int i) {
    const auto node = from.extract(i);
    return node.empty() ? PlacedNumber{} : node.mapped();
  }

  const ZemaxSurface& given_;
  Real unit_;
  Report& report_;
  std::map<int, PlacedNumber> parm_, xdat_;
};

Form conic(Reader& from) {
  if (std::isinf(from.radius())) return {};
  Form form{"conic", {{"radius_mm", from.radius()}}};
  if (from.conic() != 0) form.items.push_back({"conic_constant", from.conic()});
  return form;
}

// A conic with something on top; alone where that is nothing.
Form on_conic(Reader& from, const char* kind, std::vector<Item> more, bool is_nothing) {
  Form form = conic(from);
  if (is_nothing) return form;
  form.kind = kind;
  if (form.items.empty()) form.items.push_back({"radius_mm", from.radius()});
  form.items.insert(form.items.end(), more.begin(), more.end());
  return form;
}

Form even_asphere(Reader& from) {
  const Indexed a = from.powers(1, 8, 2, 2);
  return on_conic(from, "asphere", {{"coefficients", a}}, a.empty());
}

Form odd_asphere(Reader& from) {
  from.leave_out(from.parm(1), "PARM 1 of ODDASPHE, a term in r (a cone), is not a shape here");
  const Indexed a = from.powers(2, 8, 2, 1);
  return on_conic(from, "asphere", {{"coefficients", a}}, a.empty());
}

Form toroid(Reader& from) {
  Form form{"toroid", {{"radius_rotation_mm", from.radius_parm(1)}, {"radius_mm", from.radius()}}};
  if (from.conic() != 0) form.items.push_back({"conic_constant", from.conic()});
  if (const Indexed a = from.powers(2, 8, 2, 2); !a.empty()) form.items.push_back({"coefficients", a});
  from.xdat(1), from.xdat(2);  // of Zernike terms, which are left out where there are any
  return form;
}

Form biconic(Reader& from) {
  Form form{"biconic", {{"radius_x_mm", from.radius_parm(1)}, {"radius_y_mm", from.radius()}}};
  if (const double k = from.conic_parm(2); k != 0) form.items.push_back({"conic_constant_x", k});
  if (from.conic() != 0) form.items.push_back({"conic_constant_y", from.conic()});
  return form;
}

Form xy_polynomial(Reader& from) {
  constexpr int degree = surface::XyPolynomial::highest_degree;
  const Reader::Terms terms = from.terms(degree * (degree + 3) / 2, 1);
  return on_conic(from, "xy_polynomial", {{"normalization_radius_mm", terms.normalization_radius}, {"coefficients", terms.coefficients}}, terms.coefficients.empty());
}

Form zernike(Reader& from, const char* indexing, int most) {
  const Reader::Terms terms = from.terms(most, um_per_mm);
  from.extrapolate(terms);
  return on_conic(from, "zernike", {{"normalization_radius_mm", terms.normalization_radius}, {"indexing", indexing}, {"coefficients_um", terms.coefficients}},
                  terms.coefficients.empty());
}
Form standard_zernike(Reader& from) { return zernike(from, "noll", 231); }
Form fringe_zernike(Reader& from) { return zernike(from, "fringe", 37); }

// Even powers (PARM 1 to 8) and Zernike terms, whose decenter PARM 9 and 10 are, may be beneath the heights.
Form grid(Reader& from) {
  from.leave_out(from.parm(0), "PARM 0 of GRID_SAG: linear interpolation between the nodes is not one here");
  for (int i = 1; i <= 8; ++i) from.leave_out(from.parm(i), fmt::format("PARM {} of GRID_SAG: a power of r beneath a grid is not a shape here", i));
  for (const int i : {9, 10}) from.parm(i);
  for (const int i : {1, 2}) from.xdat(i);  // as of TOROIDAL
  const std::string file = from.grid_file();
  if (file.empty()) return conic(from);
  Form form{"grid", {{"points", file}}};
  const Form base = conic(from);
  form.items.insert(form.items.end(), base.items.begin(), base.items.end());
  return form;
}

// n = n0 + sum b_k r^k + sum a_i z^i; PARM 1 is the step of OpticStudio's integration, which is no property of the lens.
Form gradient(Reader& from, int r_count, int z_count) {
  from.parm(1);
  Form form{"polynomial", {{"index", static_cast<double>(from.parm(2).value)}}};
  const auto coefficients = [&](int first, int count, int step) {
    Indexed found;
    for (int i = 0; i < count; ++i)
      if (const double a = kept(from.parm(first + i).value * power(from.unit(), -step * (i + 1))); a != 0) found[step * (i + 1)] = a;
    return found;
  };
  const Indexed r = coefficients(3, r_count, 2), z = coefficients(3 + r_count, z_count, 1);
  if (!z.empty()) form.items.push_back({"z_coefficients", z});
  if (!r.empty()) form.items.push_back({"r_coefficients", r});
  return form;
}
Form gradient_1(Reader& from) { return gradient(from, 1, 0); }
Form gradient_3(Reader& from) { return gradient(from, 3, 3); }

struct Type {
  std::string_view name;
  Form (*shape)(Reader&);
  Form (*gradient)(Reader&) = nullptr;
};
constexpr std::array types{Type{"STANDARD", conic}, Type{"EVENASPH", even_asphere}, Type{"ODDASPHE", odd_asphere}, Type{"TOROIDAL", toroid}, Type{"BICONICX", biconic},
                           Type{"XPOLYNOM", xy_polynomial}, Type{"SZERNSAG", standard_zernike}, Type{"FZERNSAG", fringe_zernike}, Type{"GRID_SAG", grid}, Type{"GRINSUR1", conic, gradient_1},
                           Type{"GRINSUR3", conic, gradient_3}};

void clip(const ZemaxSurface& given, Real unit, Report& report, Surface& surface) {
  if (!given.clip) return;
  const auto& [operand, least, most, at] = *given.clip;
  if (given.clip_is_off_centre) return report.left_out(at, operand + ": an aperture off the vertex (OBDC) is not one here");
  if (least == 0 && most == 0) return report.warning(at, operand + ": an aperture of no extent, which is taken as none");
  if (!(least >= 0 && most > least)) return report.broken(at, operand + ": its radii are not 0 <= least < largest");
  if (operand == "OBSC") {
    if (least > 0) return report.left_out(at, "OBSC: an obscuration that leaves its middle free is not one here");
    surface.inner_semi_diameter = static_cast<double>(most * unit);
    return;
  }
  surface.inner_semi_diameter = static_cast<double>(least * unit);
  if (most < largest_number) surface.semi_diameter = static_cast<double>(most * unit);
}

}  // namespace

Surface surface_of(const ZemaxSurface& given, Real unit_mm, Report& report) {
  Surface surface;
  surface.place = given.place;
  surface.name = given.comment;
  surface.stop = given.stop;
  surface.curvature = given.curvature.value / unit_mm;
  surface.thickness = given.thickness.value * unit_mm;
  surface.medium = given.medium;
  if (given.curvature.value != 0 && !(std::abs(surface.curvature) >= 1e-30L))
    report.broken(given.curvature.place, fmt::format("a curvature of {} is none", number_text(static_cast<double>(given.curvature.value))), "write 0");
  if (!surface::conic_constants.contains(static_cast<double>(given.conic.value)))
    report.broken(given.conic.place, fmt::format("a conic constant lies from {:g} to {:g}", surface::conic_constants.low, surface::conic_constants.high));
  Reader reader(given, unit_mm, report);
  const auto type = std::find_if(types.begin(), types.end(), [&](const Type& one) { return one.name == given.type; });
  if (type == types.end()) {
    report.left_out(given.type_place, fmt::format("a surface of type {} is not known; its conic (CURV, CONI) stands for it", prescription::excerpt(given.type)));
    surface.shape = conic(reader);
  } else {
    surface.shape = type->shape(reader);
    if (given.grid && type->shape != grid) report.left_out(given.grid->place.value_or(given.place), fmt::format("heights on a grid (GDAT, GARR) of a surface of type {}", given.type));
    if (type->gradient) {
      if (given.medium.kind == Medium::Kind::mirror) report.left_out(given.medium.place, "GLAS: a mirror that a gradient-index medium follows");
      else if (given.medium.kind != Medium::Kind::air) report.warning(given.medium.place, "GLAS of a gradient-index medium is left out: the index is that of the gradient");
      surface.medium = {Medium::Kind::gradient, {}, 1, 0, type->gradient(reader), given.type_place};
      const double index = std::get<double>(surface.medium.gradient.items.front().value);
      if (!(index >= medium::least_index && index <= medium::largest_index))
        report.broken(given.type_place, fmt::format("{}: n0 (PARM 2) is {}, where an index lies from {} to {}", given.type, number_text(index), medium::least_index, medium::largest_index));
    }
    reader.leave_out_the_rest();
  }
  clip(given, unit_mm, report, surface);
  return surface;
}

Move move_of(const ZemaxSurface& given, Real unit_mm, Report& report) {
  Reader reader(given, unit_mm, report);
  const auto parm = [&](int i) { return reader.parm(i).value; };
  Move move;
  move.decenter = {parm(1) * unit_mm, parm(2) * unit_mm, 0};
  move.tilt_deg = {parm(3), parm(4), parm(5)};
  move.tilts_first = parm(6) != 0;
  reader.leave_out_the_rest();
  return move;
}

}  // namespace sagitta::lens_file
