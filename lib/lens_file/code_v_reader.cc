// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "lib/lens_file/code_v_solve_internal.h"
#include "lib/lens_file/code_v_surface_internal.h"
#include "lib/lens_file/code_v_text_internal.h"
#include "lib/lens_file/lens_reader.h"
#include "lib/lens_file/lens_text_internal.h"
#include "lib/prescription/keys.h"
#include "lib/surface/conic.h"

namespace sagitta::lens_file {
namespace {

using prescription::ApertureKind;
using prescription::FieldKind;

// Commands that say nothing about where rays go: weights, initials, updates, drawing; variables, couplings and derivatives, whose values stand in
// their own commands; mirror substrates; checks of apertures and polarisation.
constexpr std::array without_optics{"LEN", "GO",  "INI", "WTW", "WTF", "CLS", "CCY", "CCX", "THC", "GLC", "XDC", "YDC", "ZDC", "ADC", "BDC", "CDC", "KC",  "AC",  "BC", "CC",
                                    "DC",  "EC",  "FC",  "GC",  "HC",  "JC",  "DER", "CUM", "THM", "CWL", "CA",  "POL", "DDM", "MFL", "LAB"};

constexpr std::array other_apertures{OtherAperture{"REX", "a rectangular aperture"}, OtherAperture{"REY", "a rectangular aperture"}, OtherAperture{"ELX", "an elliptical aperture"},
                                     OtherAperture{"ELY", "an elliptical aperture"}, OtherAperture{"ADX", "an aperture that is decentered"}, OtherAperture{"ADY", "an aperture that is decentered"}};

constexpr Real infinite_object = 1e10L;  // in the units of the file

class CodeVReader {
 public:
  CodeVReader(const std::string& file, Report& report) : file_(file), report_(report), numbers_(file, report) { lens_.program = "a CODE V sequence"; }

  std::optional<Lens> read(std::string_view text) {
    int last_line = 0;
    for (Statement& statement : code_v_statements(text)) {
      last_line = statement.words.front().line;
      take(statement);
      if (surfaces_.size() > static_cast<std::size_t>(most_surfaces)) {
        report_.broken(surfaces_.back().place, fmt::format("more than {} surfaces", most_surfaces));
        return std::nullopt;
      }
    }
    if (surfaces_.size() < 3 || !has_image_) {
      report_.broken({file_, surfaces_.size() == 1 ? 0 : last_line, 1}, surfaces_.size() == 1 ? "no surface (S): not a CODE V sequence of a lens" : "the file ends before its image surface (SI), or has no surface before it");
      return std::nullopt;
    }
    finish();
    return std::move(lens_);
  }

 private:
  using Handler = void (CodeVReader::*)(const Statement&);
  static constexpr std::size_t any = std::string::npos;
  struct Command {
    std::string_view name;
    Handler take;
    std::size_t most_words;  // behind its name and surface
  };

  void take(Statement& statement) {
    using C = CodeVReader;
    static constexpr std::array of_system{
        Command{"RDM", &C::take_radius_mode, 1}, Command{"TIT", &C::take_title, any}, Command{"DIM", &C::take_unit, 1}, Command{"EPD", &C::take_aperture, 1},
        Command{"FNO", &C::take_aperture, 1}, Command{"NA", &C::take_aperture, 1}, Command{"NAO", &C::take_aperture, 1}, Command{"WL", &C::take_wavelengths, any},
        Command{"REF", &C::take_reference, 1}, Command{"XAN", &C::take_fields, any}, Command{"YAN", &C::take_fields, any}, Command{"XOB", &C::take_fields, any},
        Command{"YOB", &C::take_fields, any}, Command{"XIM", &C::take_fields, any}, Command{"YIM", &C::take_fields, any}, Command{"XRI", &C::take_fields, any},
        Command{"YRI", &C::take_fields, any}, Command{"VUX", &C::take_vignetting, any}, Command{"VLX", &C::take_vignetting, any}, Command{"VUY", &C::take_vignetting, any},
        Command{"VLY", &C::take_vignetting, any}, Command{"TEM", &C::take_environment, 1}, Command{"PRE", &C::take_environment, 1}, Command{"PIM", &C::take_image_solve, 1},
        Command{"PIK", &C::take_pickup, any}};
    static constexpr std::array of_surface{
        Command{"RDY", &C::take_radius, 1}, Command{"CUY", &C::take_curvature, 1}, Command{"THI", &C::take_thickness, 1}, Command{"GLA", &C::take_glass, 1},
        Command{"RMD", &C::take_mode, 1}, Command{"SLB", &C::take_name, 1}, Command{"STO", &C::take_stop, 0}, Command{"SPH", &C::take_sphere, 0}, Command{"CON", &C::take_nothing, 0},
        Command{"ASP", &C::take_nothing, 0}, Command{"K", &C::take_conic, 1}, Command{"A", &C::take_power, 1}, Command{"B", &C::take_power, 1}, Command{"C", &C::take_power, 1},
        Command{"D", &C::take_power, 1}, Command{"E", &C::take_power, 1}, Command{"F", &C::take_power, 1}, Command{"G", &C::take_power, 1}, Command{"H", &C::take_power, 1},
        Command{"J", &C::take_power, 1}, Command{"CUF", &C::take_fresnel, 1}, Command{"CIR", &C::take_circle, any}, Command{"XDE", &C::take_decenter, 1},
        Command{"YDE", &C::take_decenter, 1}, Command{"ZDE", &C::take_decenter, 1}, Command{"ADE", &C::take_decenter, 1}, Command{"BDE", &C::take_decenter, 1},
        Command{"CDE", &C::take_decenter, 1}, Command{"DAR", &C::take_decenter_kind, 0}, Command{"REV", &C::take_decenter_kind, 0}, Command{"BEN", &C::take_decenter_kind, 0}};
    const std::string given = statement.name();
    std::string& name = statement.words.front().text;
    name = command_name(given);
    if (is_in_private_catalog_) {
      is_in_private_catalog_ = name != "END";
      return;
    }
    const auto is_it = [&](const auto& one) { return one.name == name; };
    if (const auto found = std::find_if(of_system.begin(), of_system.end(), is_it); found != of_system.end()) {
      (this->*found->take)(statement);
      return leave_out_more(statement, found->most_words);
    }
    target_ = surfaces_.size() - 1;
    if (const auto found = std::find_if(of_surface.begin(), of_surface.end(), is_it); found != of_surface.end()) {
      if (!take_qualifier(statement)) return;
      if (is_solve(statement)) return take_solve(statement, target(), numbers_, report_);
      (this->*found->take)(statement);
      return leave_out_more(statement, found->most_words);
    }
    if (is_surface_name(name)) {
      take_surface(statement);
      return leave_out_more(statement, 4);
    }
    if (name == "PRV") {
      is_in_private_catalog_ = true;
      return report_.left_out(numbers_.place(statement), "PRV: a private catalogue of glasses", "give its glasses as files NAME.yml beside the prescription");
    }
    if (std::find(without_optics.begin(), without_optics.end(), name) != without_optics.end()) return;
    leave_out(given, name, other_apertures, numbers_.place(statement), report_);
  }

  void leave_out_more(const Statement& statement, std::size_t most) {
    if (statement.words.size() - 1 <= most) return;
    const Word& more = statement.words[most + 1];
    report_.left_out(numbers_.place(more), fmt::format("{}: '{}' is one word more than it takes", statement.name(), prescription::excerpt(more.text)), "the next command begins behind a semicolon or in its own line");
  }

  // A second word S3, SO, SI or S'label' names the surface of the command, and is taken away. False, after saying so, for other qualifiers.
  bool take_qualifier(Statement& statement) {
    if (statement.words.size() < 2 || statement.words[1].quoted) return true;
    const std::string word = upper(statement.words[1].text);
    if (word.starts_with("Z") && word.size() > 1 && word[1] >= '0' && word[1] <= '9') {
      report_.left_out(numbers_.place(statement.words[1]), fmt::format("{}: zoom positions", statement.name()));
      return false;
    }
    if (!names_surface(word)) return true;
    const std::optional<std::size_t> number = surface_named(word, surfaces_, has_image_);
    if (!number || *number >= surfaces_.size()) {
      report_.broken(numbers_.place(statement.words[1]), fmt::format("{}: there is no surface {} here", statement.name(), prescription::excerpt(statement.words[1].text)));
      return false;
    }
    target_ = *number;
    statement.words.erase(statement.words.begin() + 1);
    return true;
  }
  CodeVSurface& target() { return surfaces_[target_]; }
  Real value(const Statement& statement) const { return numbers_.number(statement, 1).value_or(0); }

  // S [radius or curvature [thickness [glass [REFL]]]]
  void take_surface(const Statement& statement) {
    const Place at = numbers_.place(statement);
    const std::string& name = statement.name();
    if (name == "SO" || name == "S0") {
      target_ = 0;
    } else if (name == "SI" && has_image_) {
      target_ = surfaces_.size() - 1;
    } else {
      const std::optional<std::size_t> number = name == "S" || name == "SI" ? surfaces_.size() : surface_named(name, surfaces_, has_image_).value_or(0);
      if (*number == 0 || *number > surfaces_.size()) return report_.broken(at, fmt::format("{} where S{} comes next", prescription::excerpt(name), surfaces_.size()));
      if (*number == surfaces_.size()) {
        if (has_image_) return report_.broken(at, "a surface behind the image surface (SI)");
        surfaces_.emplace_back();
        surfaces_.back().place = at;
        has_image_ = name == "SI";
      }
      target_ = *number;
    }
    if (statement.words.size() > 1) set_radius(statement, statement.words[1], is_radius_mode_);
    if (statement.words.size() > 2) set_thickness(statement, statement.words[2]);
    for (std::size_t i = 3; i < std::min<std::size_t>(statement.words.size(), 5); ++i) set_glass(statement.words[i]);
  }
  void set_radius(const Statement& statement, const Word& word, bool is_radius) {
    const Real given = numbers_.number(word, statement.name()).value_or(0);
    target().radius.reset();
    if (is_radius && given != 0) target().radius = given;
    target().curvature = is_radius ? (given == 0 ? 0 : 1 / given) : given;
    target().curvature_rounding = half_a_digit(word.text);
    target().curvature_place = numbers_.place(word);
    if (given != 0 && !(std::abs(target().curvature) >= 1e-25L && std::abs(target().curvature) <= 1e25L))
      report_.broken(numbers_.place(word), fmt::format("'{}' is no {}", prescription::excerpt(word.text), is_radius ? "radius" : "curvature"));
  }
  void set_thickness(const Statement& statement, const Word& word) {
    target().thickness = numbers_.number(word, statement.name()).value_or(0);
    target().thickness_place = numbers_.place(word);
  }
  void set_glass(const Word& word) {
    const Place at = numbers_.place(word);
    const std::string name = upper(word.text);
    if (!word.quoted && (name == "REFL" || name == "REFR")) {
      target().mirror_place = name == "REFL" ? std::optional(at) : std::nullopt;
      return;
    }
    if (!word.quoted && name == "AIR") return void(target().medium = {});
    if (const std::optional<GlassCode> code = glass_code(word.text)) {
      target().medium = {Medium::Kind::nd_vd, {}, code->nd, code->vd, {}, at};
      if (!has_glass_code_) lens_.remarks.push_back("Glasses given as codes are two-term formulas through nd and Vd here.");
      has_glass_code_ = true;
      return;
    }
    if (parse_real(word.text)) return report_.broken(at, fmt::format("'{}' is neither a glass nor a glass code as 517642 or 517.642", prescription::excerpt(word.text)));
    target().medium = {Medium::Kind::glass, word.text, 1, 0, {}, at};
  }

  void take_radius_mode(const Statement& statement) {
    is_radius_mode_ = statement.words.size() < 2 || !upper(statement.words[1].text).starts_with("N");
    has_radius_mode_ = true;
  }
  void take_title(const Statement& statement) { lens_.title = statement.words.size() == 2 ? statement.words[1].text : statement.rest; }
  void take_unit(const Statement& statement) {
    const char letter = statement.words.size() < 2 ? ' ' : upper(statement.words[1].text).front();
    has_unit_ = true;
    if (letter != 'M' && letter != 'C' && letter != 'I') return report_.broken(numbers_.place(statement), "DIM is not one of M (mm), C (cm), I (inches)");
    unit_ = letter == 'M' ? 1 : letter == 'C' ? 10 : 25.4L;
    if (letter != 'M') lens_.remarks.push_back(fmt::format("Its lengths in {} are converted to mm.", letter == 'C' ? "cm" : "inches"));
  }
  void take_aperture(const Statement& statement) {
    if (!aperture_.words.empty()) return report_.broken(numbers_.place(statement), fmt::format("{}: a second aperture beside {} in line {}", statement.name(), aperture_.name(), aperture_.words[0].line));
    aperture_ = statement;
  }
  void take_wavelengths(const Statement& statement) {
    lens_.wavelengths_nm.clear(), lens_.wavelength_places.clear();
    if (statement.words.size() > static_cast<std::size_t>(most_wavelengths) + 1) return report_.broken(numbers_.place(statement), fmt::format("WL: more than {} wavelengths", most_wavelengths));
    for (std::size_t i = 1; i < statement.words.size(); ++i) {
      const std::optional<Real> nm = numbers_.number(statement.words[i], statement.name());
      if (!nm) continue;
      if (!prescription::wavelengths_nm_range.contains(static_cast<double>(*nm))) report_.broken(numbers_.place(statement.words[i]), "WL: it is no wavelength in nm");
      else lens_.add_wavelength(static_cast<double>(*nm), numbers_.place(statement.words[i]));
    }
  }
  void take_reference(const Statement& statement) {
    reference_ = numbers_.whole(statement, 1, 1, most_wavelengths);
    reference_place_ = numbers_.place(statement);
  }
  void take_fields(const Statement& statement) {
    const char letter = statement.name()[1];  // of XAN, XOB, XIM, XRI
    const FieldKind kind = letter == 'A' ? FieldKind::angles_deg : letter == 'O' ? FieldKind::object_heights_mm : letter == 'I' ? FieldKind::paraxial_image_heights_mm : FieldKind::real_image_heights_mm;
    lens_.fields_place = numbers_.place(statement);
    if (has_fields_ && kind != lens_.field_kind) return report_.broken(lens_.fields_place, fmt::format("{}: fields of another kind before", statement.name()));
    has_fields_ = true, lens_.field_kind = kind;
    std::vector<Real>& values = statement.name()[0] == 'X' ? x_fields_ : y_fields_;
    values = numbers_.list(statement, 1).value_or(std::vector<Real>{});
    if (values.size() > static_cast<std::size_t>(most_fields)) report_.broken(lens_.fields_place, fmt::format("{}: more than {} fields", statement.name(), most_fields));
  }
  void take_vignetting(const Statement& statement) {
    const std::optional<std::vector<Real>> factors = numbers_.list(statement, 1);
    if (factors && std::any_of(factors->begin(), factors->end(), [](Real one) { return one != 0; }))
      report_.left_out(numbers_.place(statement), fmt::format("{}: vignetting factors", statement.name()), "apertures of surfaces clip rays instead");
  }
  void take_environment(const Statement& statement) {
    const Real given = value(statement);
    const bool is_usual = statement.name() == "TEM" ? given >= 20 && given <= 22 : given == 760;
    if (!is_usual) report_.left_out(numbers_.place(statement), fmt::format("{}: a temperature other than 20 to 22 C or a pressure other than 760 mm of mercury", statement.name()), "indices are those of the catalogues");
  }
  void take_image_solve(const Statement& statement) {
    if (statement.words.size() < 2 || !upper(statement.words[1].text).starts_with("N")) lens_.solves_image = numbers_.place(statement);
  }

  void take_pickup(const Statement& statement) { pickups_.push_back(statement); }
  void take_radius(const Statement& statement) {
    if (numbers_.number(statement, 1)) set_radius(statement, statement.words[1], true);
  }
  void take_curvature(const Statement& statement) {
    if (numbers_.number(statement, 1)) set_radius(statement, statement.words[1], false);
  }
  void take_thickness(const Statement& statement) {
    if (numbers_.number(statement, 1)) set_thickness(statement, statement.words[1]);
  }
  void take_glass(const Statement& statement) {
    if (statement.words.size() < 2) return report_.broken(numbers_.place(statement), "GLA: the name of the glass is missing");
    set_glass(statement.words[1]);
  }
  void take_mode(const Statement& statement) {
    const std::string mode = statement.words.size() < 2 ? "" : upper(statement.words[1].text);
    if (mode == "REFL" || mode == "REFR") return set_glass(statement.words[1]);
    report_.left_out(numbers_.place(statement), fmt::format("RMD {}: neither REFR nor REFL", prescription::excerpt(mode)));
  }
  void take_name(const Statement& statement) {
    if (statement.words.size() > 1) target().name = statement.words[1].text;
  }
  void take_stop(const Statement& statement) {
    for (CodeVSurface& one : surfaces_) one.stop = false;
    target().stop = true;
    stop_place_ = numbers_.place(statement);
  }
  void take_sphere(const Statement&) { target().conic = 0, target().powers.clear(); }
  void take_nothing(const Statement&) {}
  void take_conic(const Statement& statement) {
    target().conic = value(statement);
    target().shape_place = numbers_.place(statement);
    if (!surface::conic_constants.contains(static_cast<double>(target().conic)))
      report_.broken(numbers_.place(statement), fmt::format("a conic constant lies from {:g} to {:g}", surface::conic_constants.low, surface::conic_constants.high));
  }
  // A to H, J: r^4, r^6, ..., r^18, r^20
  void take_power(const Statement& statement) {
    const char letter = statement.name()[0];
    const int power_of_r = letter == 'J' ? 20 : 4 + 2 * (letter - 'A');
    target().powers[power_of_r] = value(statement);
    target().shape_place = numbers_.place(statement);
  }
  void take_fresnel(const Statement& statement) {
    if (value(statement) != 0) report_.left_out(numbers_.place(statement), "CUF: a Fresnel surface");
  }
  void take_circle(const Statement& statement) {
    std::string kind;
    for (std::size_t i = 1; i + 1 < statement.words.size(); ++i) {
      const std::string word = upper(statement.words[i].text);
      if (word.starts_with("L'") || word.starts_with("L\"")) continue;  // a label
      if (!kind.empty()) return report_.left_out(numbers_.place(statement.words[i]), fmt::format("CIR: '{}' is one word more than it takes", prescription::excerpt(word)), "the next command begins behind a semicolon or in its own line");
      kind = word;
    }
    if (kind.empty()) kind = "CLR";
    const std::optional<Real> radius = numbers_.number(statement, std::max<std::size_t>(statement.words.size() - 1, 1));
    if (!radius || kind == "EDG") return;  // the edge of the glass, which lies outside what is clear
    if (kind != "CLR" && kind != "OBS") return report_.left_out(numbers_.place(statement), fmt::format("CIR {}: neither a clear aperture nor an obscuration", prescription::excerpt(kind)));
    if (!(*radius > 0)) return report_.broken(numbers_.place(statement), "CIR: the radius is not positive");
    (kind == "OBS" ? target().inner_semi_diameter : target().semi_diameter) = *radius;
    target().circle_place = numbers_.place(statement);
  }
  void take_decenter(const Statement& statement) {
    numerics::Vec3<Real>& to = statement.name()[1] == 'D' && statement.name()[0] >= 'X' ? target().shift : target().tilt;
    const char axis = statement.name()[0];
    (axis == 'X' || axis == 'A' ? to.x : axis == 'Y' || axis == 'B' ? to.y : to.z) = value(statement);
    if (target().decenter_place.line == 0) target().decenter_place = numbers_.place(statement);
  }
  void take_decenter_kind(const Statement& statement) {
    using Decenter = CodeVSurface::Decenter;
    const Decenter kind = statement.name() == "DAR" ? Decenter::and_return : statement.name() == "REV" ? Decenter::reverse : Decenter::bend;
    if (target().decenter != Decenter::basic && target().decenter != kind)
      return report_.broken(numbers_.place(statement), fmt::format("{}: the surface is decentered in another way in line {}", statement.name(), target().decenter_kind_place.line), "it is one of DAR, REV and BEN");
    target().decenter = kind;
    target().decenter_place = target().decenter_kind_place = numbers_.place(statement);
  }

  void finish();
  void finish_aperture();

  const std::string& file_;
  Report& report_;
  Numbers numbers_;
  Lens lens_;
  Real unit_ = 1;
  bool is_radius_mode_ = true, has_radius_mode_ = false, has_unit_ = false, has_image_ = false, has_fields_ = false, has_glass_code_ = false, is_in_private_catalog_ = false;
  Statement aperture_;
  std::optional<int> reference_;
  Place reference_place_, stop_place_;
  std::vector<Real> x_fields_, y_fields_;
  std::vector<Statement> pickups_;
  std::vector<CodeVSurface> surfaces_{1};  // the object first
  std::size_t target_ = 0;
};

void CodeVReader::finish() {
  if (!has_radius_mode_) report_.left_out({file_}, "no RDM: the first numbers of the surfaces are taken as radii", "RDM says that they are, RDM N that they are curvatures");
  if (!has_unit_) report_.left_out({file_}, "no DIM: the lengths are taken as mm");
  if (lens_.wavelengths_nm.empty()) report_.broken({file_}, "no wavelength (WL)");
  const std::size_t count = lens_.wavelengths_nm.size();
  if (!reference_ && count > 1) report_.warning({file_}, "no REF: the middle wavelength is taken as the primary one");
  if (reference_ && static_cast<std::size_t>(*reference_) > count) report_.broken(reference_place_, fmt::format("REF: there are {} wavelengths", count));
  lens_.primary = static_cast<std::size_t>(reference_.value_or(static_cast<int>(count + 1) / 2)) - (count > 0 ? 1 : 0);
  const auto field = [&](const std::vector<Real>& values, std::size_t i) {
    return i < values.size() ? static_cast<double>(values[i] * (lens_.field_kind == FieldKind::angles_deg ? 1 : unit_)) : 0;
  };
  for (std::size_t i = 0; i < std::max(x_fields_.size(), y_fields_.size()); ++i) lens_.fields.emplace_back(field(x_fields_, i), field(y_fields_, i));
  const CodeVSurface& object = surfaces_.front();
  if (surfaces_.front().thickness_place.line > 0 && std::abs(object.thickness) < infinite_object) {
    lens_.object_distance = static_cast<double>(object.thickness * unit_);
    if (lens_.object_distance == 0) report_.broken(object.thickness_place, "the object stands at the first surface");
    if (object.curvature != 0) report_.left_out(object.place.line > 0 ? object.place : object.thickness_place, "SO: a curved object");
  }
  for (const Statement& pickup : pickups_) check_pickup(pickup, surfaces_, has_image_, numbers_, report_);
  lens_.object_medium = object.medium;
  if (object.mirror_place) report_.broken(*object.mirror_place, "the object is a mirror");
  const bool is_aspheric = (object.conic != 0 && object.curvature != 0) || std::any_of(object.powers.begin(), object.powers.end(), [](const auto& one) { return one.second != 0; });
  if (is_aspheric) report_.left_out(object.shape_place, "SO: an aspheric object");
  if (object.circle_place.line > 0) report_.left_out(object.circle_place, "CIR: an aperture of the object");
  if (object.decenter_place.line > 0) report_.left_out(object.decenter_place, "SO: a decentered object");
  for (std::size_t i = 1; i < surfaces_.size(); ++i) lens_.surfaces.push_back(surface_of(surfaces_[i], unit_, report_));
  Surface& image = lens_.surfaces.back();
  lens_.image_shift = std::exchange(image.thickness, 0);  // the defocus
  lens_.surfaces[lens_.surfaces.size() - 2].thickness += lens_.image_shift;
  if (image.medium.kind != Medium::Kind::air) report_.warning(image.medium.place, "SI: what is behind the image surface is left out: no ray gets there");
  image.medium = {};
  if (object.stop) report_.broken(stop_place_, "the object is the stop", "STO stands behind the S of its surface, or names it: STO S3");
  const bool has_stop = object.stop || std::any_of(lens_.surfaces.begin(), lens_.surfaces.end(), [](const Surface& one) { return one.stop; });
  if (!has_stop) report_.warning({file_}, "no STO: surface 1 is taken as the stop");
  if (!has_stop) lens_.surfaces.front().stop = true;
  lens_.aims = !lens_.surfaces.front().stop;  // that program aims every ray; a stop that stands first is its own pupil
  finish_aperture();
}

void CodeVReader::finish_aperture() {
  if (aperture_.words.empty()) return report_.broken({file_}, "no aperture (EPD, FNO, NA or NAO)");
  const std::string& name = aperture_.name();
  const std::optional<Real> given = numbers_.number(aperture_, 1);
  if (!given) return;
  const Place at = numbers_.place(aperture_);
  if (!(*given > 0)) return report_.broken(at, fmt::format("{}: the aperture is not positive", name));
  if (name == "EPD") return void(lens_.aperture = {ApertureKind::entrance_pupil_diameter_mm, static_cast<double>(*given * unit_), at});
  if (name == "NA") lens_.remarks.push_back("Its aperture, an image-space NA, is the F-number 1/(2 NA) here.");
  const Real value = name == "NA" ? 1 / (2 * *given) : *given;
  lens_.aperture = {name == "NAO" ? ApertureKind::object_na : ApertureKind::image_f_number, static_cast<double>(value), at};
}

}  // namespace

std::optional<Lens> read_code_v(const std::string& file, const std::string& text, Report& report) { return CodeVReader(file, report).read(text); }

}  // namespace sagitta::lens_file
