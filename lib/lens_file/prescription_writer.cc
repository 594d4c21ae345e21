// SPDX-License-Identifier: Apache-2.0
#include "lib/lens_file/prescription_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <type_traits>

#include "lib/lens_file/numbers.h"
#include "lib/lens_file/placement.h"
#include "lib/prescription/keys.h"
#include "lib/prescription/utf8.h"
#include "lib/prescription/yaml_tree.h"

namespace sagitta::lens_file {
namespace {

constexpr std::size_t line_width = 150, longest_text = 200;

// Latin, Greek and Cyrillic letters and what is below them; beyond, some characters are no text to YAML.
std::string harmless(std::string_view text) {
  std::string result;
  while (!text.empty() && result.size() < longest_text) {
    const std::size_t length = prescription::utf8_length(text);
    const bool is_text = length > 0 && length <= 2 && !prescription::starts_with_control(text);
    result += is_text ? text.substr(0, length) : "?";
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return result;
}

std::string vector_text(const numerics::Vec3<double>& v) { return fmt::format("[{}, {}, {}]", number_text(v.x), number_text(v.y), number_text(v.z)); }

std::string value_text(const Item& item) {
  return std::visit(
      [](const auto& value) -> std::string {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, double>) {
          return number_text(value);
        } else if constexpr (std::is_same_v<Value, std::string>) {
          return yaml_text(value);
        } else {
          std::string text;
          for (const auto& [i, number] : value) text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", i, number_text(number));
          return "{" + text + "}";
        }
      },
      item.value);
}

std::string form_text(const Form& form) {
  std::string text;
  for (const Item& item : form.items) text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", item.key, value_text(item));
  return fmt::format("{}: {{{}}}", form.kind, text);
}

// "" for air, which is the default.
std::string medium_text(const Medium& medium) {
  switch (medium.kind) {
    case Medium::Kind::mirror: return "mirror";
    case Medium::Kind::glass: return medium.name == "air" ? "" : yaml_text(medium.name);
    case Medium::Kind::index: return medium.index == 1 ? "" : fmt::format("{{index: {}}}", number_text(medium.index));
    case Medium::Kind::nd_vd: return fmt::format("{{nd: {}, vd: {}}}", number_text(medium.index), number_text(medium.vd));
    case Medium::Kind::gradient: return fmt::format("{{grin: {{{}}}}}", form_text(medium.gradient));
    case Medium::Kind::air: break;
  }
  return "";
}

// Broken at blanks behind commas, where a line would be longer than the width.
std::string wrapped(const std::string& text, const std::string& indent) {
  std::string result;
  for (std::size_t begin = 0;;) {
    const std::size_t width = line_width - indent.size();
    if (text.size() - begin <= width) return result + text.substr(begin);
    std::size_t end = text.rfind(", ", begin + width);
    if (end == std::string::npos || end <= begin) end = text.find(", ", begin);
    if (end == std::string::npos) return result + text.substr(begin);
    result += text.substr(begin, end + 1 - begin) + "\n" + indent;
    begin = end + 2;
  }
}

std::string surface_text(const Lens& lens, std::size_t i, const Placed& placed) {
  const Surface& surface = lens.surfaces[i];
  const bool is_last = i + 1 == lens.surfaces.size();
  std::vector<std::string> entries;
  const auto add = [&](const char* key, const std::string& value) { entries.push_back(fmt::format("{}: {}", key, value)); };
  const std::string medium = is_last ? "" : medium_text(surface.medium), before = i == 0 ? medium_text(lens.object_medium) : medium_text(lens.surfaces[i - 1].medium);
  if (!surface.name.empty() || is_last) add("name", surface.name.empty() ? "image" : yaml_text(surface.name));
  if (surface.stop) add("stop", "true");
  if (!surface.shape.kind.empty()) entries.push_back(form_text(surface.shape));
  else if (medium != before && !is_last) entries.push_back("plane: {}");
  if (placed.decenter_mm != numerics::Vec3<double>{}) add("decenter_mm", vector_text(placed.decenter_mm));
  if (placed.tilt_deg != numerics::Vec3<double>{}) add("tilt_deg", vector_text(placed.tilt_deg));
  if (!is_last) add("thickness_mm", number_text(static_cast<double>(lens.axial_thickness(i))));
  if (!medium.empty()) add("medium", medium);
  if (std::isfinite(surface.semi_diameter)) add("semi_diameter_mm", number_text(surface.semi_diameter));
  if (surface.inner_semi_diameter != 0) add("inner_semi_diameter_mm", number_text(surface.inner_semi_diameter));
  const std::string line = fmt::format("  - {{{}}}", fmt::join(entries, ", "));
  if (line.size() <= line_width) return line + "\n";
  std::string block;
  for (const std::string& entry : entries) block += (block.empty() ? "  - " : "    ") + wrapped(entry, "      ") + "\n";
  return block;
}

std::string comment(const std::string& text) {
  std::string result, line = "#";
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    if (line.size() + 1 + (end - begin) > line_width) result += line + "\n", line = "#  ";
    line += " " + text.substr(begin, end - begin);
    begin = end + 1;
  }
  return result + line + "\n";
}

std::string head_comment(const Lens& lens, const std::string& file, const std::vector<Placed>& places, const Report& report) {
  const std::string name = harmless(std::filesystem::path(file).filename().string());
  std::string text = lens.title.empty() ? "" : comment(harmless(lens.title) + ".");
  text += comment(fmt::format("Source: {}, {}, by sagitta import.", name, harmless(lens.program)));
  std::string remarks = "What clips rays in it is an aperture that was set, not the size that a surface is drawn with.";
  for (const std::string& remark : lens.remarks) remarks += " " + harmless(remark);
  for (std::size_t i = 0; i < places.size(); ++i)
    if (!lens.aims && lens.surfaces[i].stop && places[i].is_moved()) remarks += " The stop is moved off the axis or tilted: rays are launched through the paraxial pupil on the axis, unless they are aimed.";
  if (std::any_of(places.begin(), places.end(), [](const Placed& one) { return one.is_moved(); }))
    remarks += " Places and angles of moved surfaces are from the axis of the first one, which stays straight; thicknesses are along the light, as in the file.";
  text += comment(remarks);
  if (report.left_out_count() == 0) return text;
  text += comment("Left out of that file, by line:");
  std::vector<Report::LeftOut> by_line = report.all_left_out();
  std::stable_sort(by_line.begin(), by_line.end(), [](const auto& a, const auto& b) { return a.place.line < b.place.line; });
  for (const Report::LeftOut& one : by_line) text += comment(fmt::format("  {}: {}", std::max(one.place.line, 1), harmless(one.what)));
  if (const auto more = report.left_out_count() - static_cast<int>(report.all_left_out().size()); more > 0) text += comment(fmt::format("  and {} more", more));
  return text;
}

}  // namespace

std::string yaml_text(const std::string& text) {
  const std::string good = harmless(text);
  const auto is_plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || std::string_view("_./()+- ").find(c) != std::string_view::npos; };
  constexpr std::array words_of_yaml{"true", "false", "null", "yes", "no", "on", "off"};
  std::string lower = good;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const bool begins_and_ends_well = !good.empty() && good.front() != ' ' && good.back() != ' ' && (std::isalnum(static_cast<unsigned char>(good.front())) != 0);
  if (begins_and_ends_well && std::all_of(good.begin(), good.end(), is_plain) && !prescription::parse_number(good).ok &&
      std::find(words_of_yaml.begin(), words_of_yaml.end(), lower) == words_of_yaml.end())
    return good;
  std::string quoted;
  for (const char c : good) quoted += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
  return "\"" + quoted + "\"";
}

std::string prescription_text(const Lens& lens, const std::string& file, const std::vector<std::string>& catalogs, const Report& report) {
  const std::vector<Placed> places = place(lens);
  std::string text = head_comment(lens, file, places, report) + "sagitta: 1\n";
  const std::string source = std::filesystem::path(file).filename().string();
  text += fmt::format("name: {}\nsource: {}\n", yaml_text(lens.title.empty() ? std::filesystem::path(file).stem().string() : lens.title), yaml_text(source + ", " + lens.program));
  std::string list;
  for (const std::string& one : catalogs) list += (list.empty() ? "" : ", ") + yaml_text(one);
  if (!catalogs.empty()) text += "catalogs: [" + list + "]\n";
  list.clear();
  for (const double nm : lens.wavelengths_nm) list += (list.empty() ? "" : ", ") + number_text(nm);
  text += wrapped("wavelengths_nm: [" + list + "]", "  ") + "\n";
  if (lens.primary != 0) text += fmt::format("primary_nm: {}\n", number_text(lens.wavelengths_nm[lens.primary]));
  text += fmt::format("aperture: {{{}: {}{}}}\n", prescription::aperture_keys[static_cast<std::size_t>(lens.aperture->kind)].name, number_text(lens.aperture->value), lens.aims ? ", aim: stop" : "");
  list.clear();
  for (const auto& [x, y] : lens.fields) list += fmt::format("{}[{}, {}]", list.empty() ? "" : ", ", number_text(x), number_text(y));
  if (!list.empty()) text += wrapped(fmt::format("fields: {{{}: [{}]}}", prescription::field_keys[static_cast<std::size_t>(lens.field_kind)].name, list), "  ") + "\n";
  const std::string medium = medium_text(lens.object_medium);
  if (std::isfinite(lens.object_distance) || !medium.empty())
    text += fmt::format("object: {{distance_mm: {}{}}}\n", number_text(lens.object_distance), medium.empty() ? "" : ", medium: " + medium);
  text += "surfaces:\n";
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) text += surface_text(lens, i, places[i]);
  return text;
}

}  // namespace sagitta::lens_file
