// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/medium_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "lib/medium/shifted.h"
#include "lib/prescription/keys.h"
#include "lib/prescription/material_search.h"
#include "lib/prescription/search_path.h"
#include "lib/prescription/shape_reader.h"
#include "lib/prescription/value_reader.h"

namespace sagitta::prescription {

MediumReader::Read MediumReader::read(const YamlNode* node) {
  if (!node) return {};
  if (node->kind == YamlNode::Kind::scalar && node->text == "mirror") return {.is_mirror = true};
  if (const auto grin = node->find("grin"); grin && node->kind == YamlNode::Kind::mapping) {
    if (node->entries.size() > 1) findings_.error(node->place, "medium must have nothing beside 'grin'", "dispersion and reference_nm stand inside it");
    return read_gradient(*grin);
  }
  uses_.push_back({read_one(*node), node->place});
  return {uses_.back().medium};
}

void MediumReader::read_catalogs(const YamlNode* node) {
  if (!node) return;
  if (node->kind != YamlNode::Kind::sequence || node->items.size() > most_catalogs)
    return refuse(*node, "catalogs", fmt::format("a list of at most {} files", most_catalogs), findings_);
  for (const YamlNode::Pointer& item : node->items) {
    const auto name = read_text(*item, "each of catalogs", {}, findings_);
    const auto file = name ? find_named_file(*name, item->place, findings_) : std::nullopt;
    if (!file) continue;
    const std::size_t told_before = findings_.all().size();
    if (auto catalog = read_agf(*file, findings_)) catalogs_.push_back(*std::move(catalog));
    if (findings_.all().size() > told_before) findings_.note(item->place, "named here");
  }
}

medium::Medium MediumReader::read_one(const YamlNode& node) { return node.kind == YamlNode::Kind::mapping ? read_inline(node) : read_name(node); }

medium::Medium MediumReader::read_name(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::scalar || node.text.empty()) {
    refuse(node, "medium", "a name, {index: ...}, {nd: ..., vd: ...}, {grin: ...} or mirror", findings_);
    return medium::air();
  }
  if (!node.quoted && parse_number(node.text).ok) {
    findings_.error(node.place,
                    fmt::format("medium must be a name or a mapping, not the number '{}'", excerpt(node.text)),
                    fmt::format("write {{index: {}}}", excerpt(node.text)));
    return medium::air();
  }
  const std::string key = (std::filesystem::path(node.place.file).parent_path() / node.text).string();
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  if (const auto failed = failed_.find(key); failed != failed_.end()) {
    const bool is_here = failed->second.file == node.place.file;
    findings_.error(node.place, fmt::format("medium '{}' cannot be read", excerpt(node.text)),
                    fmt::format("see {}line {}", is_here ? "" : failed->second.file + ", ", failed->second.line));
    return medium::air();
  }
  const auto found = find_material(node.text, node.place, findings_, catalogs_);
  if (found) return known_.emplace(key, *found).first->second;
  failed_.emplace(key, node.place);
  return medium::air();
}

medium::Medium MediumReader::read_inline(const YamlNode& node) {
  const Section section(node, "medium", medium_keys, findings_);
  const auto index = section.number("index"), nd = section.number("nd"), vd = section.number("vd");
  const bool has_index = section.find("index"), has_nd = section.find("nd"), has_vd = section.find("vd");
  if (has_index ? has_nd || has_vd : !(has_nd && has_vd))
    findings_.error(node.place, "medium must have either 'index', or both 'nd' and 'vd', or 'grin'");
  const auto disperses_as = read_dispersion(node, section, "medium");
  if (section.find("dispersion") && !has_index) findings_.error(node.place, "medium must have 'index' beside 'dispersion'");
  if (index && disperses_as) return medium::shifted(disperses_as->medium, *index, disperses_as->reference_nm / 1000);
  if (index) return medium::constant(fmt::format("index {}", *index), *index);
  return nd && vd ? medium::from_nd_vd(*nd, *vd) : medium::air();
}

// The names of the forms, as keys beside those that any of them may have.
MediumReader::Read MediumReader::read_gradient(const YamlNode& node) {
  std::vector<numerics::Key> forms;
  for (const ShapeKind& kind : gradient_kinds())
    forms.push_back({.name = kind.name, .kind = numerics::ValueKind::mapping, .meaning = "form of the gradient"});
  std::vector<numerics::Key> keys = forms;
  keys.insert(keys.end(), gradient_keys.begin(), gradient_keys.end());
  const Section section(node, "grin", keys, findings_);
  Read result{.medium = medium::constant("gradient", 1), .gradient = GradientMedium{}};
  if (const YamlNode::Entry* form = section.one_of(forms, true)) {
    const auto& kind = *std::find_if(gradient_kinds().begin(), gradient_kinds().end(), [&](const ShapeKind& one) { return one.name == form->key; });
    result.gradient->kind = kind.name;
    result.gradient->parameters = read_parameters(Section(*form->value, form->key, kind.keys, findings_), kind.keys);
  }
  if (auto disperses_as = read_dispersion(node, section, "grin")) {
    uses_.push_back({disperses_as->medium, section.find("dispersion")->place});
    result.gradient->reference_nm = disperses_as->reference_nm;
    result.medium = std::move(disperses_as->medium);
  }
  return result;
}

std::optional<MediumReader::DispersesAs> MediumReader::read_dispersion(const YamlNode& node, const Section& section, std::string_view name) {
  const YamlNode *dispersion = section.find("dispersion"), *reference = section.find("reference_nm");
  if (!dispersion != !reference)
    findings_.error(node.place, fmt::format("{} must have both 'dispersion' and 'reference_nm', or neither", name), "the index is that at reference_nm");
  const auto reference_nm = section.number("reference_nm");
  if (!dispersion) return std::nullopt;
  const bool is_mirror = dispersion->kind == YamlNode::Kind::scalar && dispersion->text == "mirror", is_gradient = dispersion->kind == YamlNode::Kind::mapping && dispersion->find("grin");
  if (is_mirror || is_gradient) {
    refuse(*dispersion, "dispersion", "a medium of one index at each wavelength", findings_);
    return std::nullopt;
  }
  DispersesAs result{read_one(*dispersion), reference_nm.value_or(0)};
  if (reference_nm && result.medium.index(*reference_nm / 1000) > 0) return result;
  if (reference_nm) findings_.error(reference->place, fmt::format("{} has no index at reference_nm, {} nm", result.medium.name, *reference_nm));
  uses_.push_back({std::move(result.medium), dispersion->place});
  return std::nullopt;
}

}  // namespace sagitta::prescription
