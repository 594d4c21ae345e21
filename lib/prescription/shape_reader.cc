// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/shape_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "lib/prescription/cloud_reader.h"
#include "lib/prescription/grid_reader.h"
#include "lib/prescription/search_path.h"
#include "lib/prescription/value_reader.h"
#include "lib/surface/grid.h"

namespace sagitta::prescription {
namespace {

using numerics::Key;
using numerics::ValueKind;

// The index range of a key, which may depend on a choice that was read before it.
numerics::IndexRange index_range(const Key& key, const Parameters& parameters) {
  if (!key.indices) return {};
  if (key.indexed_by.empty()) return key.indices({});
  const auto choice = parameters.texts.find(key.indexed_by);
  return choice == parameters.texts.end() ? numerics::IndexRange{} : key.indices(choice->second);
}

// A key that the choice has no use for would be read by nobody.
void check_use(const Section& section, const Key& key, const Parameters& parameters) {
  const YamlNode* node = section.find(key.name);
  const auto choice = parameters.texts.find(key.only_with);
  if (!node || key.only_with.empty() || choice == parameters.texts.end()) return;
  const std::vector<std::string> legal = numerics::words_of(key.only_choices);
  if (std::find(legal.begin(), legal.end(), choice->second) != legal.end()) return;
  section.findings().error(node->place, fmt::format("{} has no use with {}: {}", key.name, key.only_with, choice->second),
                           fmt::format("leave it out; it is for {}", fmt::join(legal, ", ")));
}

void read_value(const Section& section, const Key& key, Parameters& parameters) {
  const std::string name(key.name);
  const YamlNode* node = section.find(key.name);
  if (node) parameters.places[name] = node->place;
  check_use(section, key, parameters);
  switch (key.kind) {
    case ValueKind::number:
      parameters.numbers[name] = section.number(key.name).value_or(key.fallback);
      break;
    case ValueKind::flag:
      parameters.numbers[name] = section.flag(key.name).value_or(key.fallback != 0);
      break;
    case ValueKind::text:
    case ValueKind::file:
      if (const auto text = section.text(key.name))
        parameters.texts[name] = *text;
      else if (!node && !key.required)
        parameters.texts[name] = key.choices.substr(0, key.choices.find('|'));
      break;
    case ValueKind::indexed:
      if (!node) break;
      if (auto values = read_indexed(*node, name, key.range, index_range(key, parameters), section.findings()))
        parameters.indexed[name] = *std::move(values);
      break;
    case ValueKind::vector3:
    case ValueKind::medium:
    case ValueKind::homogeneous_medium:
    case ValueKind::mapping:
    case ValueKind::list:
      break;  // no shape has such a key; Parameters could not hold it
  }
}

// What the file holds that a shape names, by read(file); null, with errors, where it cannot be read.
template <class Data, class Read>
std::shared_ptr<const Data> read_once(const std::string& name, const std::string& format, bool osa_axes, const Place& place, KnownFilesOf<Data>& known_files, Findings& findings,
                                      const Read& read) {
  const auto file = find_named_file(name, place, findings);
  if (!file) return nullptr;
  const auto [known, is_new] = known_files.try_emplace({*file, format, osa_axes}, KnownFile<Data>{nullptr, place});
  auto& [data, named_at] = known->second;
  if (is_new) {
    const std::size_t finding_count = findings.all().size();
    data = read(*file);
    if (findings.all().size() > finding_count) findings.note(place, "named here");
  } else if (!data) {
    const bool is_here = named_at.file == place.file;
    findings.error(place, fmt::format("'{}' cannot be read", excerpt(name)), fmt::format("see {}line {}", is_here ? "" : named_at.file + ", ", named_at.line));
  }
  return data;
}

// The points of the file that `key` names; null, with errors, where there are none.
std::shared_ptr<const PointCloud> read_points(const std::string& key, const Parameters& parameters, KnownFiles& known, Findings& findings) {
  const auto name = parameters.texts.find(key);
  const auto format = parameters.texts.find("format"), axes = parameters.texts.find("axes");
  if (name == parameters.texts.end() || format == parameters.texts.end() || axes == parameters.texts.end())
    return nullptr;
  const Place& place = parameters.places.find(key)->second;
  const bool osa_axes = axes->second == "osa";
  if (osa_axes && !has_given_axes(format->second)) {
    findings.error(parameters.places.find("axes")->second,
                   fmt::format("axes must be local for the format {}, not 'osa'", format->second),
                   "the format itself tells its axes");
    return nullptr;
  }
  return read_once(name->second, format->second, osa_axes, place, known.clouds, findings,
                   [&](const std::string& file) { return read_cloud({file, format->second, osa_axes}, findings); });
}

std::shared_ptr<const SagGrid> read_grid_of(const std::string& key, const Parameters& parameters, KnownFiles& known, Findings& findings) {
  const auto name = parameters.texts.find(key), format = parameters.texts.find("format");
  if (name == parameters.texts.end() || format == parameters.texts.end()) return nullptr;
  return read_once(name->second, format->second, false, parameters.places.find(key)->second, known.grids, findings,
                   [&](const std::string& file) { return read_grid({file, format->second}, findings); });
}

}  // namespace

Parameters read_parameters(const Section& section, KeyTable keys) {
  Parameters parameters;
  for (const Key& key : keys) read_value(section, key, parameters);
  return parameters;
}

Shape read_shape(const ShapeKind& kind, const YamlNode& node, KnownFiles& known, Findings& findings) {
  const Section section(node, std::string(kind.name), kind.keys, findings);
  Shape shape{.kind = std::string(kind.name), .parameters = read_parameters(section, kind.keys), .cloud = nullptr, .place = node.place};
  for (const Key& key : kind.keys) {
    if (key.kind != ValueKind::file) continue;
    if (kind.name == surface::BicubicGrid::kind) shape.grid = read_grid_of(std::string(key.name), shape.parameters, known, findings);
    else shape.cloud = read_points(std::string(key.name), shape.parameters, known, findings);
  }
  return shape;
}

Shape make_shape(std::string_view kind, const std::vector<std::pair<std::string, std::string>>& values, const Place& place,
                 Findings& findings) {
  YamlNode node;
  node.kind = YamlNode::Kind::mapping;
  node.place = place;
  for (const auto& [key, text] : values) {
    auto value = std::make_shared<YamlNode>();
    value->kind = YamlNode::Kind::scalar;
    value->place = place;
    value->text = text;
    node.entries.push_back({key, place, std::move(value)});
  }
  const auto found = std::find_if(shape_kinds().begin(), shape_kinds().end(), [&](const ShapeKind& one) { return one.name == kind; });
  KnownFiles known;
  return read_shape(*found, node, known, findings);
}

}  // namespace sagitta::prescription
