// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/surface_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "lib/prescription/keys.h"
#include "lib/prescription/shape_reader.h"
#include "lib/prescription/value_reader.h"

namespace sagitta::prescription {
namespace {

using numerics::Key;
using numerics::Vec3;

// The names of the shapes, as keys of a surface.
const std::vector<Key>& shape_names() {
  static const std::vector<Key> names = [] {
    std::vector<Key> all;
    for (const ShapeKind& kind : shape_kinds())
      all.push_back({.name = kind.name, .kind = numerics::ValueKind::mapping, .meaning = "shape of the surface"});
    return all;
  }();
  return names;
}

const std::vector<Key>& surface_and_shape_keys() {
  static const std::vector<Key> keys = [] {
    std::vector<Key> all(surface_keys.begin(), surface_keys.end());
    all.insert(all.end(), shape_names().begin(), shape_names().end());
    return all;
  }();
  return keys;
}

Vec3<double> read_vector(const Section& section, std::string_view key, Findings& findings) {
  const YamlNode* node = section.find(key);
  const auto xyz = node ? read_tuple(*node, std::string(key), "xyz", numerics::any_number, findings) : std::nullopt;
  return xyz ? Vec3<double>{(*xyz)[0], (*xyz)[1], (*xyz)[2]} : Vec3<double>{};
}

Shape read_shape_of(const Section& section, KnownFiles& known, Findings& findings) {
  const YamlNode::Entry* given = section.one_of(shape_names(), false);
  if (!given) return {.kind = "plane", .parameters = {}, .cloud = nullptr, .place = section.place()};
  const auto kind = std::find_if(shape_kinds().begin(), shape_kinds().end(),
                                 [&](const ShapeKind& one) { return one.name == given->key; });
  return read_shape(*kind, *given->value, known, findings);
}

void check_thickness(const Section& section, const Surface& surface, bool is_last, Findings& findings) {
  const YamlNode* given = section.find("thickness_mm");
  if (!is_last && !given)
    findings.error(section.place(), fmt::format("missing key 'thickness_mm' in {}", section.owner()),
                   "every surface but the last has one");
  if (is_last && surface.thickness_mm != 0)
    findings.error(
        given->place,
        fmt::format("thickness_mm of the last surface must be 0 or left out, not '{}'", excerpt(given->text)),
        "the last surface is the image surface: nothing follows it");
}

Surface read_surface(const Section& section, bool is_last, MediumReader& media, KnownFiles& known, Findings& findings) {
  Surface surface;
  surface.place = section.place();
  surface.name = section.text("name").value_or("");
  surface.shape = read_shape_of(section, known, findings);
  surface.stop = section.flag("stop").value_or(false);
  surface.thickness_mm = section.number("thickness_mm").value_or(0);
  check_thickness(section, surface, is_last, findings);
  const MediumReader::Read after = media.read(section.find("medium"));
  if (!after.is_mirror) surface.medium = after.medium;
  surface.gradient = after.gradient;
  if (const YamlNode* given = section.find("medium"); is_last && given) {
    if (after.is_mirror)
      findings.error(given->place, "the last surface cannot be a mirror",
                     "it is the image surface, where rays end: add a surface for the image behind the mirror");
    else
      findings.warning(given->place, "the medium behind the last surface plays no part", "rays end on the image surface");
  }
  surface.semi_diameter_mm = section.number("semi_diameter_mm").value_or(surface.semi_diameter_mm);
  surface.inner_semi_diameter_mm = section.number("inner_semi_diameter_mm").value_or(0);
  if (!(surface.inner_semi_diameter_mm < surface.semi_diameter_mm))
    findings.error(section.find("inner_semi_diameter_mm")->place,
                   fmt::format("inner_semi_diameter_mm must be less than semi_diameter_mm, {}, not '{}'",
                               surface.semi_diameter_mm, surface.inner_semi_diameter_mm));
  surface.decenter_mm = read_vector(section, "decenter_mm", findings);
  surface.tilt_deg = read_vector(section, "tilt_deg", findings);
  return surface;
}

}  // namespace

std::vector<Surface> read_surfaces(const YamlNode& list, MediumReader& media, Findings& findings) {
  std::vector<Surface> surfaces;
  if (list.kind != YamlNode::Kind::sequence || list.items.size() < 2) {
    refuse(list, "surfaces", "a list of at least 2, the last one being the image surface", findings);
    if (list.kind != YamlNode::Kind::sequence) return surfaces;
  }
  if (list.items.size() > most_surfaces) {
    findings.error(list.place, fmt::format("{} surfaces are more than {}", list.items.size(), most_surfaces));
    return surfaces;
  }
  struct Stop {
    std::size_t number;
    Place place;
  };
  std::vector<Stop> stops;
  KnownFiles known;
  bool all_stops_known = true;
  for (std::size_t number = 1; number <= list.items.size(); ++number) {
    const YamlNode& node = *list.items[number - 1];
    const Section section(node, fmt::format("surface {}", number), surface_and_shape_keys(), findings);
    const YamlNode* stop = section.find("stop");
    all_stops_known = all_stops_known && node.kind == YamlNode::Kind::mapping &&
                      (!stop || stop->text == "true" || stop->text == "false");
    if (node.kind != YamlNode::Kind::mapping) continue;
    surfaces.push_back(read_surface(section, number == list.items.size(), media, known, findings));
    if (surfaces.back().stop) stops.push_back({number, stop->place});
  }
  if (stops.empty() && all_stops_known)
    findings.error(list.place, "no surface is the stop", "give exactly one surface 'stop: true'");
  if (stops.size() > 1)
    for (const Stop& one : stops)
      findings.error(one.place, fmt::format("surface {} is one of {} stops", one.number, stops.size()),
                     "exactly one surface is the stop");
  return surfaces;
}

}  // namespace sagitta::prescription
