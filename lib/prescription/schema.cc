// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/schema.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/prescription/keys.h"
#include "lib/prescription/yaml_tree.h"

namespace sagitta::prescription {
namespace {

using nlohmann::ordered_json;
using numerics::Key;
using numerics::Range;
using numerics::ValueKind;

// In the words of the unit that the name ends with.
std::string description_of(const Key& key) {
  constexpr std::pair<std::string_view, const char*> units[]{{"_mm", "mm"}, {"_um", "um"}, {"_nm", "nm"}, {"_deg", "degrees"}};
  std::string text(key.meaning);
  for (const auto& [ending, unit] : units)
    if (key.name.ends_with(ending)) text += std::string(" (") + unit + ")";
  return text;
}

// The bounds that a finite number has anyway keep .inf out.
ordered_json literal(const Range& range) {
  ordered_json json{{"type", range.whole ? "integer" : "number"}};
  const bool from_below = range.low > -largest_number, to_above = range.high < largest_number;
  if (from_below) json[range.open ? "exclusiveMinimum" : "minimum"] = range.low;
  else if (!range.infinite || std::isfinite(range.low)) json["minimum"] = -largest_number;
  if (to_above) json[range.open ? "exclusiveMaximum" : "maximum"] = range.high;
  else if (!range.infinite || std::isfinite(range.high)) json["maximum"] = largest_number;
  if (!range.zero) json["not"] = {{"const", 0}};
  return json;
}

ordered_json number(const Range& range) { return {{"anyOf", {literal(range), {{"$ref", "#/definitions/arithmetic"}}}}}; }

ordered_json list_of(ordered_json items, int least) { return {{"type", "array"}, {"minItems", least}, {"items", std::move(items)}}; }

ordered_json tuple_of(const Range& range, int count) {
  ordered_json json = list_of(number(range), count);
  json["maxItems"] = count;
  return json;
}

ordered_json required(std::string_view key) { return {{"required", {key}}}; }

// A mapping with a table of keys.
ordered_json mapping(KeyTable keys);

// Exactly one of the alternatives stands there.
ordered_json with_one_of(ordered_json json, KeyTable alternatives) {
  for (const Key& key : alternatives) json["oneOf"].push_back(required(key.name));
  return json;
}

ordered_json medium_schema() {
  ordered_json described = mapping(medium_keys);
  described["oneOf"] = {required("index"), {{"required", {"nd", "vd"}}}, required("grin")};
  described["dependencies"] = {{"dispersion", {"reference_nm", "index"}}, {"reference_nm", {"dispersion"}}};
  return {{"anyOf", {{{"type", "string"}, {"description", "name of a file of materials/ or beside the prescription, air, or mirror"}, {"examples", {"air", "mirror"}}}, described}}};
}

ordered_json shape_schema(const ShapeKind& kind) {
  ordered_json json = mapping(kind.keys);
  json["description"] = "shape of the surface";
  return json;
}

// At most one shape; without one it is a plane.
ordered_json surface_schema() {
  ordered_json json = mapping(surface_keys), shapes = ordered_json::array();
  for (const ShapeKind& kind : shape_kinds()) {
    json["properties"][std::string(kind.name)] = shape_schema(kind);
    shapes.push_back(required(kind.name));
  }
  json["oneOf"] = shapes;
  json["oneOf"].push_back({{"not", {{"anyOf", shapes}}}});
  return json;
}

ordered_json parameters_schema() {
  return {{"type", "object"}, {"propertyNames", {{"pattern", "^[A-Za-z][A-Za-z0-9_]{0,63}$"}}}, {"additionalProperties", literal(numerics::any_number)}};
}

// Exactly one form, and what it may have beside it.
ordered_json gradient_schema() {
  ordered_json json = mapping(gradient_keys);
  for (const ShapeKind& form : gradient_kinds()) {
    json["properties"][std::string(form.name)] = mapping(form.keys);
    json["properties"][std::string(form.name)]["description"] = "form of the gradient";
    json["oneOf"].push_back(required(form.name));
  }
  json["dependencies"] = {{"dispersion", {"reference_nm"}}, {"reference_nm", {"dispersion"}}};
  return json;
}

// A mapping or a list of its own kind, by its name.
ordered_json special(const Key& key) {
  if (key.name == "parameters") return parameters_schema();
  if (key.name == "catalogs") return list_of({{"type", "string"}, {"minLength", 1}}, 0);
  if (key.name == "grin") return gradient_schema();
  if (key.name == "aperture") return with_one_of(mapping(aperture_section_keys), aperture_keys);
  if (key.name == "fields") return with_one_of(mapping(field_keys), field_keys);
  if (key.name.ends_with("angles_deg") || key.name.ends_with("_heights_mm")) return list_of(tuple_of(key.range, 2), 1);
  if (key.name == "object") return mapping(object_keys);
  if (key.name == "surfaces") return list_of({{"$ref", "#/definitions/surface"}}, 0);
  if (key.name == "wavelengths_nm") {
    ordered_json json = list_of(number(key.range), 1);
    json["maxItems"] = most_wavelengths;
    return json;
  }
  return {};  // a test finds it
}

ordered_json indexed(const Key& key) {
  const ordered_json by_index{{"type", "object"}, {"patternProperties", {{"^[0-9]+$", number(key.range)}}}, {"additionalProperties", false}};
  const bool is_list = !key.indices || !key.indexed_by.empty() || key.indices({}).is_list;
  return is_list ? ordered_json{{"anyOf", {by_index, list_of(number(key.range), 0)}}} : by_index;
}

ordered_json any_text() { return {{"type", {"string", "number", "boolean"}}, {"minLength", 1}}; }

ordered_json value_of(const Key& key) {
  switch (key.kind) {
    case ValueKind::number:
      return key.range.low == key.range.high ? ordered_json{{"const", key.range.low}} : number(key.range);
    case ValueKind::flag:
      return {{"type", "boolean"}};
    case ValueKind::text:
    case ValueKind::file:
      return key.choices.empty() ? any_text() : ordered_json{{"enum", numerics::words_of(key.choices)}};
    case ValueKind::vector3:
      return tuple_of(key.range, 3);
    case ValueKind::indexed:
      return indexed(key);
    case ValueKind::medium:
      return {{"$ref", "#/definitions/medium"}};
    case ValueKind::mapping:
    case ValueKind::list:
      return special(key);
  }
  return {};
}

ordered_json described(const Key& key) {
  ordered_json value = value_of(key);
  // Beside a reference nothing else is read.
  ordered_json json = value.contains("$ref") ? ordered_json{{"allOf", {value}}} : value;
  json["description"] = description_of(key);
  return json;
}

ordered_json mapping(KeyTable keys) {
  ordered_json json{{"type", "object"}, {"properties", ordered_json::object()}, {"additionalProperties", false}};
  for (const Key& key : keys) {
    json["properties"][std::string(key.name)] = described(key);
    if (key.required) json["required"].push_back(key.name);
  }
  return json;
}

}  // namespace

std::string json_schema() {
  ordered_json json{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Sagitta prescription, version " + std::to_string(prescription_version)}};
  json.update(mapping(system_keys));
  json["definitions"] = {
      {"arithmetic", {{"type", "string"}, {"pattern", "^="}, {"description", "arithmetic with numbers and parameters: = 12 - 0.4 * NAME"}}},
      {"medium", medium_schema()},
      {"surface", surface_schema()}};
  // What extends another says what it changes, by the names of surfaces; all else stands in the other.
  const ordered_json stop{{"required", {"stop"}}, {"properties", {{"stop", {{"const", true}}}}}};
  ordered_json whole{{"required", std::move(json["required"])}, {"properties", {{"surfaces", {{"minItems", 2}, {"contains", stop}}}}}};
  json.erase("required");
  json["if"] = required("extends");
  json["then"] = {{"properties", {{"surfaces", {{"items", required("name")}}}}}};
  json["else"] = std::move(whole);
  return json.dump(1) + "\n";
}

}  // namespace sagitta::prescription
