// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "lib/lens_file/lens_reader.h"
#include "lib/lens_file/lens_text_internal.h"
#include "lib/lens_file/zemax_glass_internal.h"
#include "lib/lens_file/zemax_surface_internal.h"
#include "lib/prescription/keys.h"

namespace sagitta::lens_file {
namespace {

// Operands that say nothing about where rays go.
constexpr std::array without_optics{
    // of the system: notes, files, language, environment of coatings, scattering and polarisation, weights, settings of the program
    "NOTE", "PFIL", "LANG", "PUSH", "SDMA", "ROPD", "PICB", "POLS", "GLRS", "GSTD", "NSCD", "COFN", "FWGN", "FWGT", "WWGT", "WWGN", "FCOM", "HYPR", "PUPD", "EFFL", "TOTR", "PMAG", "ISNA",
    "AUTH", "DBDT", "IWDP", "OMMA",
    // of a surface: drawing and mechanical size, coating, colour, mirror substrate, physical optics, edges, tool and import notes, its number in other programs
    "MEMA", "OEMA", "SSID", "LUID", "EERA", "HIDE", "SLAB", "POPS", "MIRR", "COAT", "FIMP", "GLCZ", "SCOL", "TRAC", "CHZN", "CSDN", "NSOA",
    // of a surface: variables, pickups and solves, whose values stand in their own lines
    "VDSZ", "MAZH", "PZUP", "PKUP", "PPAR", "VPAR", "VCON", "EDGE", "MARA", "CFHZ",
    // tolerances, merit function, configurations
    "TOL", "TOLE", "MOFF", "BLNK", "DMFS", "CONF", "OPDX", "TCED", "TCMM", "RGLA"};

constexpr std::array other_apertures{OtherAperture{"SQAP", "a rectangular aperture"}, OtherAperture{"SQOB", "a rectangular obscuration"}, OtherAperture{"ELAP", "an elliptical aperture"},
                                     OtherAperture{"ELOB", "an elliptical obscuration"}, OtherAperture{"SPID", "a spider"}, OtherAperture{"USAP", "an aperture of the user's own shape"}};

struct Unit {
  std::string_view name;
  Real mm;
};
constexpr std::array units{Unit{"MM", 1}, Unit{"CM", 10}, Unit{"IN", 25.4L}, Unit{"INCH", 25.4L}, Unit{"M", 1000}, Unit{"METER", 1000}};

class ZemaxReader {
 public:
  ZemaxReader(const std::string& file, Report& report) : file_(file), report_(report), numbers_(file, report) { lens_.program = "a Zemax lens file"; }

  std::optional<Lens> read(std::string_view text) {
    int number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
      take_line(text.substr(begin, end - begin), ++number);
      if (!is_sequential_ || surfaces_.size() > static_cast<std::size_t>(most_surfaces)) break;
      begin = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
    }
    if (!is_sequential_) return std::nullopt;
    if (surfaces_.size() > static_cast<std::size_t>(most_surfaces)) {
      report_.broken(surfaces_.back().place, fmt::format("more than {} surfaces", most_surfaces));
      return std::nullopt;
    }
    if (surfaces_.size() < 3) {
      report_.broken({file_, surfaces_.empty() ? 0 : number, 1}, surfaces_.empty() ? "no SURF: not a Zemax lens file" : "the file ends before its image surface: there is an object, at least one surface, and an image");
      return std::nullopt;
    }
    if (skipped_count_ > 0)
      report_.note(first_skipped_, fmt::format("from here on {} not read: merit function, tolerances and configurations have no optics",
                                               skipped_count_ == 1 ? "1 line is" : fmt::format("{} lines are", skipped_count_)));
    finish();
    return std::move(lens_);
  }

 private:
  using Handler = void (ZemaxReader::*)(const Statement&);
  struct Operand {
    std::string_view name;
    Handler take;
  };

  void take_line(std::string_view line, int number) {
    Statement statement;
    statement.indented = !line.empty() && blanks.find(line.front()) != std::string_view::npos;
    for (std::size_t begin = line.find_first_not_of(blanks); begin != std::string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
      statement.words.push_back({std::string(line.substr(begin, end - begin)), number, static_cast<int>(begin) + 1});
      if (statement.words.size() == 1) statement.rest = trimmed(line.substr(end));
      begin = line.find_first_not_of(blanks, end);
    }
    if (!statement.words.empty()) take(statement);
  }

  void take(const Statement& statement) {
    using Z = ZemaxReader;
    static constexpr std::array of_system{
        Operand{"VERS", &Z::take_version}, Operand{"MODE", &Z::take_mode}, Operand{"NAME", &Z::take_name}, Operand{"UNIT", &Z::take_unit}, Operand{"ENPD", &Z::take_aperture},
        Operand{"FNUM", &Z::take_aperture}, Operand{"OBNA", &Z::take_aperture}, Operand{"FLOA", &Z::take_aperture}, Operand{"FTYP", &Z::take_field_type}, Operand{"XFLN", &Z::take_fields},
        Operand{"YFLN", &Z::take_fields}, Operand{"XFLD", &Z::take_fields}, Operand{"YFLD", &Z::take_fields}, Operand{"WAVM", &Z::take_wavelength}, Operand{"WAVL", &Z::take_wavelengths},
        Operand{"PWAV", &Z::take_primary}, Operand{"VDXN", &Z::take_vignetting}, Operand{"VDYN", &Z::take_vignetting}, Operand{"VCXN", &Z::take_vignetting},
        Operand{"VCYN", &Z::take_vignetting}, Operand{"VANN", &Z::take_vignetting}, Operand{"ENVD", &Z::take_environment}, Operand{"GCAT", &Z::take_catalogs},
        Operand{"GFAC", &Z::take_apodization}, Operand{"RAIM", &Z::take_ray_aiming}, Operand{"MNUM", &Z::take_configurations}, Operand{"SURF", &Z::take_surface}};
    static constexpr std::array of_surface{
        Operand{"TYPE", &Z::take_type}, Operand{"STOP", &Z::take_stop}, Operand{"CURV", &Z::take_value}, Operand{"CONI", &Z::take_value}, Operand{"DISZ", &Z::take_thickness},
        Operand{"GLAS", &Z::take_glass}, Operand{"DIAM", &Z::take_semi_diameter}, Operand{"PARM", &Z::take_parameter}, Operand{"XDAT", &Z::take_parameter}, Operand{"COMM", &Z::take_comment},
        Operand{"IGNR", &Z::take_ignored}, Operand{"CLAP", &Z::take_clip}, Operand{"FLAP", &Z::take_clip}, Operand{"OBSC", &Z::take_clip}, Operand{"OBDC", &Z::take_clip_decenter},
        Operand{"GDAT", &Z::take_grid}, Operand{"GARR", &Z::take_grid_node}};
    const auto is_it = [&](const auto& one) { return one.name == statement.name(); };
    if (const auto found = std::find_if(of_system.begin(), of_system.end(), is_it); found != of_system.end()) return (this->*found->take)(statement);
    // Behind the surfaces, whose lines are indented, the lines of other things begin in the first column again.
    const bool is_behind = has_indented_lines_ && !statement.indented;
    if (!surfaces_.empty() && !is_behind) {
      has_indented_lines_ |= statement.indented;
      if (const auto found = std::find_if(of_surface.begin(), of_surface.end(), is_it); found != of_surface.end()) return (this->*found->take)(statement);
    }
    if (std::find(without_optics.begin(), without_optics.end(), statement.name()) != without_optics.end()) return;
    if (is_behind) {
      if (skipped_count_++ == 0) first_skipped_ = numbers_.place(statement);
      return;
    }
    leave_out(statement.name(), statement.name(), other_apertures, numbers_.place(statement), report_);
  }

  ZemaxSurface& surface() { return surfaces_.back(); }
  PlacedNumber placed(const Statement& statement, std::size_t i) const {
    const std::optional<Real> value = numbers_.number(statement, i);
    if (!value) return {0, i < statement.words.size() ? numbers_.place(statement.words[i]) : numbers_.place(statement)};
    return {*value, numbers_.place(statement.words[i]), half_a_digit(statement.words[i].text)};
  }

  void take_version(const Statement& statement) { lens_.program = fmt::format("a Zemax lens file (VERS {})", prescription::excerpt(statement.rest)); }
  void take_mode(const Statement& statement) {
    is_sequential_ = statement.rest.starts_with("SEQ");
    if (!is_sequential_) report_.broken(numbers_.place(statement), fmt::format("MODE is {}: only sequential systems (SEQ) are read", prescription::excerpt(statement.rest)));
  }
  void take_name(const Statement& statement) { lens_.title = unquoted(statement.rest); }
  static std::string unquoted(std::string_view text) {
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = trimmed(text.substr(1, text.size() - 2));
    return std::string(text);
  }
  void take_unit(const Statement& statement) {
    const auto unit = statement.words.size() < 2 ? units.end() : std::find_if(units.begin(), units.end(), [&](const Unit& one) { return one.name == statement.words[1].text; });
    has_unit_ = true;
    if (unit == units.end()) return report_.broken(numbers_.place(statement), fmt::format("UNIT '{}' is not one of MM, CM, IN, METER", prescription::excerpt(statement.rest)));
    unit_ = unit->mm;
    if (unit_ != 1) lens_.remarks.push_back(fmt::format("Its lengths in {} are converted to mm.", unit->name == "IN" || unit->name == "INCH" ? "inches" : unit->name == "CM" ? "cm" : "metres"));
  }
  void take_aperture(const Statement& statement) {
    if (!aperture_.words.empty()) return report_.broken(numbers_.place(statement), fmt::format("{}: a second aperture beside {} in line {}", statement.name(), aperture_.name(), aperture_.words[0].line));
    aperture_ = statement;
  }
  void take_field_type(const Statement& statement) {
    field_type_ = {Real(numbers_.whole(statement, 1, 0, 9).value_or(0)), numbers_.place(statement)};
    if (statement.words.size() > 2 && numbers_.whole(statement, 2, 0, 1).value_or(0) != 0)
      report_.left_out(numbers_.place(statement.words[2]), "FTYP: an object space that is telecentric", "its pupil is computed from the stop instead");
    if (statement.words.size() > 3) field_count_ = static_cast<std::size_t>(numbers_.whole(statement, 3, 0, most_fields).value_or(0));
    if (statement.words.size() > 4) wavelength_count_ = static_cast<std::size_t>(numbers_.whole(statement, 4, 0, most_wavelengths).value_or(0));
    // The fifth and sixth are of normalised fields and of solves; the seventh is what optiland's reader takes it for; the eighth is the number of fields again.
    if (statement.words.size() > 7 && numbers_.number(statement, 7).value_or(0) != 0)
      report_.left_out(numbers_.place(statement.words[7]), "FTYP: an image space that is afocal", "rays are traced to the image surface, and not made parallel");
  }
  void take_fields(const Statement& statement) {
    (statement.name()[0] == 'X' ? x_fields_ : y_fields_) = numbers_.list(statement, 1).value_or(std::vector<Real>{});
    lens_.fields_place = numbers_.place(statement);
  }
  void add_wavelength(const Word& word, const std::string& of) {
    const std::optional<Real> um = numbers_.number(word, of);
    if (!um) return;
    if (!prescription::wavelengths_nm_range.contains(static_cast<double>(*um * 1000)) || lens_.wavelengths_nm.size() >= static_cast<std::size_t>(most_wavelengths))
      return report_.broken(numbers_.place(word), fmt::format("{}: '{}' um is no wavelength", of, prescription::excerpt(word.text)));
    lens_.add_wavelength(static_cast<double>(*um * 1000), numbers_.place(word));
  }
  void take_wavelength(const Statement& statement) {
    const std::optional<int> number = numbers_.whole(statement, 1, 1, most_wavelengths);
    if (!number || !numbers_.number(statement, 2)) return;
    if (*number != static_cast<int>(lens_.wavelengths_nm.size()) + 1) return report_.broken(numbers_.place(statement.words[1]), fmt::format("WAVM {} where {} comes next", *number, lens_.wavelengths_nm.size() + 1));
    add_wavelength(statement.words[2], statement.name());
  }
  void take_wavelengths(const Statement& statement) {
    lens_.wavelengths_nm.clear(), lens_.wavelength_places.clear();
    for (std::size_t i = 1; i < statement.words.size(); ++i) add_wavelength(statement.words[i], statement.name());
  }
  void take_primary(const Statement& statement) { primary_ = {Real(numbers_.whole(statement, 1, 1, most_wavelengths).value_or(1)), numbers_.place(statement)}; }
  void take_vignetting(const Statement& statement) { vignetting_.push_back(statement); }
  void take_environment(const Statement& statement) {
    const std::optional<Real> celsius = numbers_.number(statement, 1), atmospheres = statement.words.size() > 2 ? numbers_.number(statement, 2) : Real(1);
    if (celsius && atmospheres && (*celsius != 20 || *atmospheres != 1))
      report_.left_out(numbers_.place(statement), "ENVD: a temperature other than 20 C or a pressure other than 1 atm", "indices are those of the catalogues");
  }
  void take_catalogs(const Statement& statement) {
    for (std::size_t i = 1; i < statement.words.size(); ++i) lens_.glass_catalogs.push_back(statement.words[i].text);
    lens_.remarks.push_back(fmt::format("Its glasses are of {}.", prescription::excerpt(statement.rest)));
  }
  void take_ray_aiming(const Statement& statement) {
    const int how = statement.words.size() > 2 ? numbers_.whole(statement, 2, 0, 2).value_or(0) : 0;
    lens_.aims = how == 2;
    if (how == 1) report_.left_out(numbers_.place(statement.words[2]), "RAIM: paraxial ray aiming", "`aim: stop` in aperture aims real rays");
  }
  // GFAC type factor: 0 is uniform.
  void take_apodization(const Statement& statement) {
    if (numbers_.number(statement, 1).value_or(0) != 0) report_.left_out(numbers_.place(statement), "GFAC: an apodized pupil", "every ray counts alike here");
  }
  void take_configurations(const Statement& statement) {
    if (numbers_.whole(statement, 1, 0, 10000).value_or(0) > 1) report_.left_out(numbers_.place(statement), "MNUM: other configurations than the one of the surfaces");
  }

  void take_surface(const Statement& statement) {
    const std::optional<int> number = numbers_.whole(statement, 1, 0, most_surfaces);
    if (number && *number != static_cast<int>(surfaces_.size()))
      report_.broken(numbers_.place(statement.words[1]), fmt::format("SURF {} where {} comes next", *number, surfaces_.size()));
    surfaces_.emplace_back();
    surface().place = surface().type_place = numbers_.place(statement);
  }
  void take_type(const Statement& statement) {
    if (statement.words.size() < 2) return report_.broken(numbers_.place(statement), "TYPE: the type is missing");
    surface().type = statement.words[1].text;
    surface().type_place = numbers_.place(statement);
  }
  void take_stop(const Statement&) { surface().stop = true; }
  void take_value(const Statement& statement) { (statement.name() == "CURV" ? surface().curvature : surface().conic) = placed(statement, 1); }
  void take_thickness(const Statement& statement) {
    surface().infinite = statement.words.size() > 1 && statement.words[1].text == "INFINITY";
    surface().thickness = surface().infinite ? PlacedNumber{0, numbers_.place(statement)} : placed(statement, 1);
  }
  void take_glass(const Statement& statement) {
    const std::optional<Medium> medium = zemax_glass(statement, numbers_, report_);
    if (!medium) return;
    surface().medium = *medium;
    if (medium->kind != Medium::Kind::nd_vd || has_model_glass_) return;
    lens_.remarks.push_back("Its model glasses are two-term formulas through nd and Vd here, which differ between and beyond the F and C lines from OpticStudio's own.");
    has_model_glass_ = true;
  }
  void take_ignored(const Statement& statement) {
    if (numbers_.number(statement, 1).value_or(0) != 0) report_.left_out(numbers_.place(statement), "IGNR: a surface that is ignored, and stands here", "delete it in OpticStudio");
  }
  void take_semi_diameter(const Statement& statement) { surface().semi_diameter = placed(statement, 1); }
  void take_parameter(const Statement& statement) {
    const std::optional<int> i = numbers_.whole(statement, 1, 0, 10000);
    if (i) (statement.name() == "PARM" ? surface().parm : surface().xdat)[*i] = placed(statement, 2);
  }
  void take_comment(const Statement& statement) { surface().comment = unquoted(statement.rest); }
  void take_clip(const Statement& statement) {
    const Place at = numbers_.place(statement);
    const bool is_open = statement.words.size() > 2 && statement.words[2].text.starts_with("INF");
    const std::optional<Real> least = numbers_.number(statement, 1), most = is_open ? largest_number : numbers_.number(statement, 2);
    if (surface().clip) return report_.left_out(at, fmt::format("{}: a second aperture of the surface", statement.name()));
    if (least && most) surface().clip = {statement.name(), *least, *most, at};
  }
  void take_clip_decenter(const Statement& statement) {
    const std::optional<std::vector<Real>> to = numbers_.list(statement, 1);
    surface().clip_is_off_centre = to && std::any_of(to->begin(), to->end(), [](Real one) { return one != 0; });
  }

  ZemaxGrid& grid() { return surface().grid ? *surface().grid : surface().grid.emplace(); }
  // The numbers of a line of a grid, so many, and the rest 0.
  std::optional<std::vector<Real>> grid_numbers(const Statement& statement, std::size_t count) {
    const std::optional<std::vector<Real>> values = numbers_.list(statement, 1);
    if (!values) return std::nullopt;
    if (values->size() < count) report_.broken(numbers_.place(statement), fmt::format("{}: {} numbers where {} are needed", statement.name(), values->size(), count));
    for (std::size_t i = count; i < values->size(); ++i)
      if ((*values)[i] != 0) report_.left_out(numbers_.place(statement.words[i + 1]), fmt::format("{}: what its {}th number says is not known", statement.name(), i + 1));
    return values->size() < count ? std::nullopt : values;
  }
  void take_grid(const Statement& statement) {
    grid().place = numbers_.place(statement);
    grid().layout = grid_numbers(statement, 4).value_or(std::vector<Real>{});
  }
  void take_grid_node(const Statement& statement) {
    const std::optional<std::vector<Real>> values = grid_numbers(statement, 5);
    if (!values) return;
    if (grid().nodes.empty() && (*values)[0] == 1) grid().first_node = 1;
    const auto next = static_cast<Real>(grid().nodes.size()) + Real(grid().first_node);
    if ((*values)[0] != next) report_.broken(numbers_.place(statement.words[1]), fmt::format("GARR {} where {} comes next", prescription::excerpt(statement.words[1].text), number_text(static_cast<double>(next))));
    grid().nodes.push_back({(*values)[1], (*values)[2], (*values)[3], (*values)[4]});
  }

  void finish();
  void finish_surfaces();
  void finish_aperture();
  void finish_fields();
  void finish_wavelengths();

  const std::string& file_;
  Report& report_;
  Numbers numbers_;
  Lens lens_;
  Real unit_ = 1;
  bool is_sequential_ = true, has_unit_ = false, has_model_glass_ = false, has_indented_lines_ = false;
  Statement aperture_;
  PlacedNumber field_type_, primary_{1, {}};
  std::optional<std::size_t> field_count_, wavelength_count_;
  std::vector<Real> x_fields_, y_fields_;
  std::vector<Statement> vignetting_;
  std::vector<ZemaxSurface> surfaces_;
  int skipped_count_ = 0;
  Place first_skipped_;
};

void ZemaxReader::finish() {
  if (!has_unit_) report_.left_out({file_}, "no UNIT: the lengths are taken as mm");
  finish_wavelengths();
  finish_fields();
  finish_surfaces();
  finish_aperture();
}

void ZemaxReader::finish_wavelengths() {
  const std::size_t given = lens_.wavelengths_nm.size(), count = wavelength_count_.value_or(given);
  if (given == 0 || count == 0 || count > given) return report_.broken({file_}, given == 0 ? "no wavelength (WAVM, WAVL)" : fmt::format("FTYP tells of {} wavelengths, WAVM gives {}", count, given));
  lens_.wavelengths_nm.resize(count);
  if (!(primary_.value >= 1 && primary_.value <= Real(count))) return report_.broken(primary_.place, fmt::format("PWAV: there are {} wavelengths", count));
  lens_.primary = static_cast<std::size_t>(primary_.value) - 1;
}

void ZemaxReader::finish_fields() {
  const auto last_used = [](const std::vector<Real>& values) {
    return static_cast<std::size_t>(values.rend() - std::find_if(values.rbegin(), values.rend(), [](Real one) { return one != 0; }));
  };
  const std::size_t count = field_count_.value_or(std::max({last_used(x_fields_), last_used(y_fields_), std::size_t{1}}));
  for (const Statement& statement : vignetting_) {
    const std::optional<std::vector<Real>> factors = numbers_.list(statement, 1);
    if (factors && std::any_of(factors->begin(), factors->begin() + static_cast<std::ptrdiff_t>(std::min(count, factors->size())), [](Real one) { return one != 0; }))
      report_.left_out(numbers_.place(statement), fmt::format("{}: vignetting factors", statement.name()), "apertures of surfaces clip rays instead");
  }
  using prescription::FieldKind;
  constexpr FieldKind kinds[] = {FieldKind::angles_deg, FieldKind::object_heights_mm, FieldKind::paraxial_image_heights_mm, FieldKind::real_image_heights_mm};
  if (field_type_.value >= std::size(kinds)) return report_.left_out(field_type_.place, "FTYP: a kind of field that is not known");
  lens_.field_kind = kinds[static_cast<std::size_t>(field_type_.value)];
  const auto value = [&](const std::vector<Real>& values, std::size_t i) { return i < values.size() ? static_cast<double>(values[i] * (lens_.field_kind == FieldKind::angles_deg ? 1 : unit_)) : 0; };
  for (std::size_t i = 0; i < count; ++i) lens_.fields.emplace_back(value(x_fields_, i), value(y_fields_, i));
}

void ZemaxReader::finish_surfaces() {
  const ZemaxSurface& object = surfaces_.front();
  if (!object.infinite) lens_.object_distance = static_cast<double>(object.thickness.value * unit_);
  if (object.curvature.value != 0) report_.left_out(object.curvature.place, "a curved object");
  if (object.is_coordinate_break()) report_.left_out(object.type_place, "an object that is a coordinate break");
  else if (object.type != "STANDARD") report_.left_out(object.type_place, fmt::format("an object of type {}", prescription::excerpt(object.type)));
  if (object.clip) report_.left_out(object.clip->place, fmt::format("{}: an aperture of the object", object.clip->operand));
  if (object.stop) report_.broken(object.place, "the object is the stop");
  lens_.object_medium = object.medium;
  if (object.medium.kind == Medium::Kind::mirror) report_.broken(object.medium.place, "the object is a mirror");
  std::vector<Move> moves;
  Real thickness = 0;
  for (std::size_t i = 1; i < surfaces_.size(); ++i) {
    const ZemaxSurface& given = surfaces_[i];
    const bool is_last = i + 1 == surfaces_.size();
    if (given.thickness.place.line == 0) report_.left_out(given.place, fmt::format("SURF {} has no DISZ, which every surface has", i), "does the file end too early?");
    if (given.infinite) report_.broken(given.thickness.place, "DISZ INFINITY: only the object may be at infinity");
    if (is_last && given.medium.kind != Medium::Kind::air)
      report_.warning(given.medium.place, "GLAS: what is behind the image surface, the last one, is left out: no ray gets there", "if it is not the image, the file ends too early");
    if (is_last && given.thickness.value != 0)
      report_.left_out(given.thickness.place, "DISZ: a thickness behind the image surface, which is the last one", "does the file end too early?");
    if (!given.is_coordinate_break()) {
      lens_.surfaces.push_back(surface_of(given, unit_, report_));
      lens_.surfaces.back().before = std::exchange(moves, {});
      lens_.surfaces.back().thickness_before = std::exchange(thickness, 0);
      continue;
    }
    if (is_last) report_.broken(given.type_place, "the image surface is a coordinate break");
    if (given.stop) report_.broken(given.place, "a coordinate break is the stop");
    if (given.medium.kind == Medium::Kind::mirror) report_.left_out(given.medium.place, "GLAS: a coordinate break that is a mirror");
    moves.push_back(move_of(given, unit_, report_));
    moves.push_back(Move::along_axis(given.thickness.value * unit_));
    thickness += given.thickness.value * unit_;
  }
  if (lens_.surfaces.size() < 2) return report_.broken({file_}, "there is no surface before the image surface");
  lens_.surfaces.back().medium = {};
  lens_.surfaces.back().thickness = 0;
  if (std::isfinite(lens_.object_distance)) lens_.object_distance += static_cast<double>(lens_.surfaces.front().thickness_before);
  if (std::isfinite(lens_.object_distance) && lens_.object_distance == 0) report_.broken(object.thickness.place.line > 0 ? object.thickness.place : object.place, "the object stands at the first surface", "DISZ of SURF 0 tells how far it is, or INFINITY");
  const auto stops = std::count_if(lens_.surfaces.begin(), lens_.surfaces.end(), [](const Surface& one) { return one.stop; });
  if (stops != 1) report_.broken({file_}, stops == 0 ? "no surface is the stop (STOP)" : fmt::format("{} surfaces are the stop (STOP)", stops));
}

// FLOA is the semi-diameter of the stop.
void ZemaxReader::finish_aperture() {
  if (aperture_.words.empty()) return report_.broken({file_}, "no aperture (ENPD, FNUM, OBNA or FLOA)");
  const std::string& name = aperture_.name();
  const Place at = numbers_.place(aperture_);
  using prescription::ApertureKind;
  if (name == "FLOA") {
    const auto stop = std::find_if(surfaces_.begin(), surfaces_.end(), [](const ZemaxSurface& one) { return one.stop; });
    if (stop == surfaces_.end()) return;
    if (!stop->semi_diameter || !(stop->semi_diameter->value > 0)) return report_.broken(at, "FLOA: the stop has no semi-diameter (DIAM)");
    lens_.aperture = {ApertureKind::stop_diameter_mm, static_cast<double>(2 * stop->semi_diameter->value * unit_), at};
    // It is the beam that is so wide there: rays on its rim are not to be clipped by their rounding.
    for (Surface& surface : lens_.surfaces)
      if (surface.stop && 2 * surface.semi_diameter == lens_.aperture->value) surface.semi_diameter = std::numeric_limits<double>::infinity();
    return;
  }
  const std::optional<Real> value = numbers_.number(aperture_, 1);
  if (!value) return;
  if (!(*value > 0)) return report_.broken(at, fmt::format("{}: the aperture is not positive", name));
  if (name != "ENPD" && aperture_.words.size() > 2 && numbers_.whole(aperture_, 2, 0, 9).value_or(0) != 0)
    return report_.broken(numbers_.place(aperture_.words[2]), name == "FNUM" ? "FNUM: a working F/# is not an aperture here" : "OBNA: an object cone angle is not an aperture here",
                          "set another aperture in OpticStudio: entrance pupil diameter, image space F/#, object space NA, or float by stop size");
  if (name == "ENPD") lens_.aperture = {ApertureKind::entrance_pupil_diameter_mm, static_cast<double>(*value * unit_), at};
  else lens_.aperture = {name == "FNUM" ? ApertureKind::image_f_number : ApertureKind::object_na, static_cast<double>(*value), at};
}

}  // namespace

std::optional<Lens> read_zemax(const std::string& file, const std::string& text, Report& report) { return ZemaxReader(file, report).read(text); }

}  // namespace sagitta::lens_file
