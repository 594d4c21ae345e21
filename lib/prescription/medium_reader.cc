// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/medium_reader.h"

#include <fmt/format.h>

#include <filesystem>

#include "lib/prescription/material_search.h"
#include "lib/prescription/search_path.h"
#include "lib/prescription/value_reader.h"

namespace sagitta::prescription {

MediumReader::Read MediumReader::read(const YamlNode* node) {
  if (!node) return {};
  if (node->kind == YamlNode::Kind::scalar && node->text == "mirror") return {.is_mirror = true};
  uses_.push_back({node->kind == YamlNode::Kind::mapping ? read_inline(*node) : read_name(*node), node->place});
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

medium::Medium MediumReader::read_name(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::scalar || node.text.empty()) {
    refuse(node, "medium", "a name, {index: ...}, {nd: ..., vd: ...} or mirror", findings_);
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
    findings_.error(node.place, "medium must have either 'index', or both 'nd' and 'vd'");
  if (index) return medium::constant(fmt::format("index {}", *index), *index);
  return nd && vd ? medium::from_nd_vd(*nd, *vd) : medium::air();
}

}  // namespace sagitta::prescription
