// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/schema.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/prescription/arithmetic.h"
#include "lib/prescription/expression.h"
#include "lib/prescription/index_pattern.h"
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

// Numbers whose products no ray could be traced with. An infinite one is none of them.
ordered_json out_of_reach() {
  constexpr double largest_double = std::numeric_limits<double>::max();
  return {{"anyOf",
           {{{"exclusiveMinimum", largest_number}, {"maximum", largest_double}},
            {{"exclusiveMaximum", -largest_number}, {"minimum", -largest_double}},
            {{"exclusiveMinimum", 0}, {"exclusiveMaximum", smallest_number}},
            {{"exclusiveMinimum", -smallest_number}, {"exclusiveMaximum", 0}}}}};
}

// The bounds that a finite number has anyway keep .inf out.
ordered_json literal(const Range& range) {
  ordered_json json{{"type", range.whole ? "integer" : "number"}};
  const bool from_below = range.low > -largest_number, to_above = range.high < largest_number;
  if (from_below) json[range.open ? "exclusiveMinimum" : "minimum"] = range.low;
  else if (!range.infinite || std::isfinite(range.low)) json["minimum"] = -largest_number;
  if (to_above) json[range.open ? "exclusiveMaximum" : "maximum"] = range.high;
  else if (!range.infinite || std::isfinite(range.high)) json["maximum"] = largest_number;
  const ordered_json beyond{{"$ref", "#/definitions/out_of_reach"}};
  json["not"] = range.zero ? beyond : ordered_json{{"anyOf", {{{"const", 0}}, beyond}}};
  return json;
}

ordered_json number(const Range& range) { return {{"anyOf", {literal(range), {{"$ref", "#/definitions/arithmetic"}}}}}; }

ordered_json list_of(ordered_json items, int least, std::optional<int> most = std::nullopt) {
  ordered_json json{{"type", "array"}, {"minItems", least}, {"items", std::move(items)}};
  if (most) json["maxItems"] = *most;
  return json;
}

ordered_json tuple_of(const Range& range, int count) { return list_of(number(range), count, count); }

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
  return {{"anyOf", {{{"type", "string"}, {"minLength", 1}, {"description", "name of a file of materials/ or beside the prescription, air, or mirror"}, {"examples", {"air", "mirror"}}}, described}}};
}

// Where a mirror or a gradient has no place.
ordered_json homogeneous_medium() {
  const ordered_json gradient{{"type", "object"}, {"required", {"grin"}}};
  return {{"allOf", {{{"$ref", "#/definitions/medium"}}, {{"not", {{"anyOf", {{{"const", "mirror"}}, gradient}}}}}}}};
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
  return {{"type", "object"},
          {"maxProperties", most_parameters},
          {"propertyNames", {{"pattern", "^[A-Za-z][A-Za-z0-9_]{0,63}$"}, {"not", {{"enum", function_names()}}}}},
          {"additionalProperties", literal(numerics::any_number)}};
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
  if (key.name == "catalogs") return list_of({{"type", "string"}, {"minLength", 1}}, 0, most_catalogs);
  if (key.name == "grin") return gradient_schema();
  if (key.name == "aperture") return with_one_of(mapping(aperture_section_keys), aperture_keys);
  if (key.name == "fields") return with_one_of(mapping(field_keys), field_keys);
  if (key.name.ends_with("angles_deg") || key.name.ends_with("_heights_mm")) return list_of(tuple_of(key.range, 2), 1);
  if (key.name == "object") return mapping(object_keys);
  if (key.name == "surfaces") return list_of({{"$ref", "#/definitions/surface"}}, 0, most_surfaces);
  if (key.name == "wavelengths_nm") {
    ordered_json json = list_of(number(key.range), 1, most_wavelengths);
    json["uniqueItems"] = true;
    return json;
  }
  return {};  // a test finds it
}

ordered_json indexed(const Range& range, numerics::IndexRange indices) {
  const ordered_json by_index{{"type", "object"}, {"propertyNames", {{"pattern", index_pattern(indices)}}}, {"additionalProperties", number(range)}};
  if (!indices.is_list) return by_index;
  return {{"anyOf", {by_index, list_of(number(range), 0, (indices.last - indices.first) / indices.step + 1)}}};
}

// Those whose indices depend on a choice: by each of its words.
ordered_json indexed_by_choice(const Key& key, KeyTable keys) {
  const auto choice = std::find_if(keys.begin(), keys.end(), [&](const Key& one) { return one.name == key.indexed_by; });
  const std::string name(key.name), by(key.indexed_by);
  ordered_json all = ordered_json::array();
  for (const std::string& word : numerics::words_of(choice->choices))
    all.push_back({{"if", {{"required", {by}}, {"properties", {{by, {{"const", word}}}}}}}, {"then", {{"properties", {{name, indexed(key.range, key.indices(word))}}}}}});
  return all;
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
      return key.indexed_by.empty() ? indexed(key.range, key.indices ? key.indices({}) : numerics::IndexRange{}) : ordered_json{{"type", {"object", "array"}}};
    case ValueKind::medium:
      return {{"$ref", "#/definitions/medium"}};
    case ValueKind::homogeneous_medium:
      return homogeneous_medium();
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
    if (!key.indexed_by.empty()) json["allOf"] = indexed_by_choice(key, keys);
  }
  return json;
}

}  // namespace

std::string json_schema() {
  ordered_json json{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Sagitta prescription, version " + std::to_string(prescription_version)}};
  json.update(mapping(system_keys));
  json["definitions"] = {
      {"out_of_reach", out_of_reach()},
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
