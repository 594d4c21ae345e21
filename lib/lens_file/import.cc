// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "lib/lens_file/glasses.h"
#include "lib/lens_file/lens_reader.h"
#include "lib/lens_file/numbers.h"
#include "lib/lens_file/paraxial_image.h"
#include "lib/lens_file/prescription_writer.h"
#include "lib/lens_file/report.h"

namespace sagitta::lens_file {
namespace {

using prescription::Findings;

constexpr std::size_t most_bytes = 900'000, most_values = 150'000;  // what the reader of prescriptions takes, with something to spare

// What a prescription asks of its values among each other, said of the lens file.
void check(const Lens& lens, const std::string& output, const std::vector<prescription::AgfCatalog>& catalogs, Report& report) {
  const bool is_finite = std::isfinite(lens.object_distance);
  if (lens.aperture->kind == prescription::ApertureKind::image_f_number && is_finite)
    report.broken(lens.aperture->place, "an F-number is the aperture of a system with an object at infinity", "give an object-space NA or an entrance pupil diameter");
  if (lens.aperture->kind == prescription::ApertureKind::object_na) {
    if (!is_finite) report.broken(lens.aperture->place, "an object-space NA is the aperture of a system with a finite object", "give an entrance pupil diameter");
    if (const double index = index_of(lens.object_medium, lens.wavelengths_nm[lens.primary], output, catalogs); !(lens.aperture->value < index))
      report.broken(lens.aperture->place, fmt::format("an object-space NA must be less than the object's index, {}", index));
  }
  if (lens.field_kind == prescription::FieldKind::object_heights_mm && !is_finite) report.broken(lens.fields_place, "object heights are fields of a system with a finite object", "give angles");
  if (lens.field_kind == prescription::FieldKind::angles_deg &&
      std::any_of(lens.fields.begin(), lens.fields.end(), [](const auto& one) { return !(std::abs(one.first) < 90 && std::abs(one.second) < 90); }))
    report.broken(lens.fields_place, "an angle of a field is not between -90 and 90 degrees");
}

// A catalogue as the prescription names it: as it is from the folder of that, where it is below or beside it.
std::string name_from(const std::string& output, const std::string& catalog) {
  std::error_code fault;
  const auto folder = std::filesystem::absolute(std::filesystem::path(output).parent_path(), fault);
  const auto file = std::filesystem::absolute(catalog, fault);
  const std::string relative = file.lexically_relative(folder).string();
  return relative.empty() || relative.starts_with("../..") ? file.string() : relative;
}

// The data of shapes, as files beside the prescription: LENS-2.dat of surface 2 of LENS.yaml, or data-2.dat where the prescription cannot name LENS as it is.
std::vector<DataFile> data_files(Lens& lens, const std::string& output) {
  std::vector<DataFile> files;
  const std::string lens_name = std::filesystem::path(output).stem().string();
  const auto is_plain = [](char c) { return c > ' ' && c < 127 && c != '"' && c != '\\'; };
  const std::string base = lens_name.size() <= 100 && std::all_of(lens_name.begin(), lens_name.end(), is_plain) ? lens_name : "data";
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i)
    for (Item& item : lens.surfaces[i].shape.items) {
      if (item.key != "points") continue;
      std::filesystem::path file = output;
      const std::string name = fmt::format("{}-{}.dat", base, i + 1);
      files.push_back({file.replace_filename(name).string(), std::get<std::string>(std::exchange(item.value, name))});
    }
  return files;
}

// By line of the lens file; what is said of other files stays behind what it was said after.
Findings in_order(const Findings& findings, const std::string& file) {
  struct Placed {
    int line, column;
    prescription::Finding finding;
  };
  std::vector<Placed> all;
  for (const prescription::Finding& one : findings.all()) {
    const bool is_here = one.place.file == file;
    const int line = is_here ? one.place.line : all.empty() ? 0 : all.back().line, column = is_here ? one.place.column : all.empty() ? 0 : all.back().column;
    all.push_back({line, column, one});
  }
  std::stable_sort(all.begin(), all.end(), [](const Placed& a, const Placed& b) { return a.line != b.line ? a.line < b.line : a.column < b.column; });
  Findings sorted;
  for (Placed& one : all) sorted.add(std::move(one.finding));
  return sorted;
}

// A prescription traces each wavelength once.
void merge_wavelengths(Lens& lens, Report& report) {
  std::vector<double> all;
  for (std::size_t i = 0; i < lens.wavelengths_nm.size(); ++i) {
    const double nm = lens.wavelengths_nm[i];
    const auto same = std::find(all.begin(), all.end(), nm);
    if (same == all.end()) all.push_back(nm);
    else report.warning(lens.wavelength_places[i], fmt::format("the wavelength {} nm is repeated; it is taken once", number_text(nm)));
    if (i == lens.primary) lens.primary = static_cast<std::size_t>(std::find(all.begin(), all.end(), nm) - all.begin());
  }
  lens.wavelengths_nm = std::move(all);
}

}  // namespace

Imported import(const ImportRequest& request) {
  Imported result;
  Report report(result.findings, request.takes_parts);
  std::vector<prescription::AgfCatalog> catalogs;
  std::vector<std::string> names;
  for (const std::string& file : request.catalogs) {
    if (auto catalog = prescription::read_agf(file, result.findings)) catalogs.push_back(*std::move(catalog));
    names.push_back(name_from(request.output, file));
  }
  std::optional<Lens> lens = read_lens(request.file, report);
  if (lens && !lens->wavelengths_nm.empty()) {
    merge_wavelengths(*lens, report);
    find_glasses(*lens, request.output, catalogs, report);
    if (!report.has_errors()) check(*lens, request.output, catalogs, report);
    if (!report.has_errors()) solve_paraxial_image(*lens, request.output, catalogs, report);
  }
  if (lens && !report.has_errors()) {
    result.files = data_files(*lens, request.output);
    std::string text = prescription_text(*lens, request.file, names, report);
    const auto value_count = std::count_if(text.begin(), text.end(), [](char c) { return c == ',' || c == ':'; });
    if (text.size() > most_bytes || static_cast<std::size_t>(value_count) > most_values)
      report.broken({request.file}, "the prescription would be larger than a prescription may be (1 MiB)");
    else
      result.prescription = std::move(text);
    result.surface_count = static_cast<int>(lens->surfaces.size());
  }
  result.left_out_count = report.left_out_count();
  result.could_be_left_out = report.could_be_left_out();
  result.findings = in_order(result.findings, request.file);
  return result;
}

}  // namespace sagitta::lens_file
