// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/study_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "lib/prescription/documents.h"
#include "lib/prescription/reader.h"
#include "lib/prescription/search_path.h"
#include "lib/prescription/study_keys.h"
#include "lib/prescription/value_reader.h"

namespace sagitta::prescription {
namespace {

namespace fs = std::filesystem;
using numerics::Key;
using numerics::ValueKind;
using Kind = YamlNode::Kind;

constexpr const char* studies_folder = "systems/studies";

std::optional<std::string> read_pattern(const YamlNode& node, Findings& findings) {
  constexpr std::string_view random = "random:";
  if (node.kind == Kind::scalar && node.text.starts_with(random)) {
    std::uint64_t seed = 0;
    const char* end = node.text.data() + node.text.size();
    const auto read = std::from_chars(node.text.data() + random.size(), end, seed);
    if (read.ec == std::errc{} && read.ptr == end) return node.text;
  }
  return read_text(node, "pattern", "hexapolar|square|fan_x|fan_y|random:SEED", findings);
}

// Sets one key of settings.
void set(const YamlNode& node, const Key& key, Parameters& settings, Findings& findings) {
  const std::string name(key.name);
  settings.places[name] = node.place;
  if (key.kind == ValueKind::number) {
    if (const auto number = read_number(node, name, key.range, findings)) settings.numbers[name] = *number;
  } else if (const auto text = name == "pattern" ? read_pattern(node, findings) : read_text(node, name, key.choices, findings)) {
    settings.texts[name] = *text;
  }
}

enum class Lists { multiplied, refused };

std::vector<Parameters> read_settings(const YamlNode& node, const std::string& owner, KeyTable keys, Lists lists, Findings& findings);

// The values of one key, each alone in its settings.
std::vector<Parameters> read_values(const YamlNode& node, const Key& key, Lists lists, Findings& findings) {
  if (node.kind == Kind::sequence && lists == Lists::multiplied && !node.items.empty()) {
    std::vector<Parameters> all;
    for (const YamlNode::Pointer& item : node.items) {
      if (item->kind == Kind::sequence) {
        refuse(*item, fmt::format("each of {}", key.name), "a single value", findings);
        continue;
      }
      auto values = read_values(*item, key, lists, findings);
      std::move(values.begin(), values.end(), std::back_inserter(all));
      if (all.size() > most_variants) break;  // which is told where they are multiplied
    }
    return all;
  }
  if (key.kind == ValueKind::mapping) return read_settings(node, std::string(key.name), roughness_keys, lists, findings);
  Parameters one;
  set(node, key, one, findings);
  return {one};
}

Parameters merged(Parameters settings, const Parameters& more) {
  for (const auto& [key, value] : more.numbers) settings.numbers[key] = value;
  for (const auto& [key, value] : more.texts) settings.texts[key] = value;
  for (const auto& [key, value] : more.places) settings.places[key] = value;
  return settings;
}

// Every combination of the values that are given, by the order of the table.
std::vector<Parameters> read_settings(const YamlNode& node, const std::string& owner, KeyTable keys, Lists lists, Findings& findings) {
  const Section section(node, owner, keys, findings);
  std::vector<Parameters> all(1);
  for (const Key& key : keys) {
    const YamlNode* given = section.find(key.name);
    if (!given) continue;
    const std::vector<Parameters> values = read_values(*given, key, lists, findings);
    if (values.empty()) continue;
    if (all.size() * values.size() > most_variants) {
      findings.error(given->place, fmt::format("{} has more than {} variants", owner, most_variants), "make the lists shorter, or several studies");
      return all;
    }
    std::vector<Parameters> product;
    for (const Parameters& before : all)
      for (const Parameters& value : values) product.push_back(merged(before, value));
    all = std::move(product);
  }
  for (Parameters& one : all) {
    if (one.numbers.contains("points_per_mm") && one.numbers.contains("points_per_mm2"))
      findings.error(section.find("points_per_mm")->place, "'points_per_mm' beside 'points_per_mm2'", "keep one of them: the one is the root of the other");
    if (const auto found = one.numbers.find("points_per_mm"); found != one.numbers.end()) {
      one.numbers["points_per_mm2"] = found->second * found->second;
      one.places["points_per_mm2"] = one.places["points_per_mm"];
      one.numbers.erase(found);
    }
    if (findings.has_errors()) break;  // the same in every one
  }
  return all;
}

// Surface and field are the study's, where they are not given.
Parameters with_fallbacks(Parameters settings, const std::string& surface, std::size_t field) {
  settings.texts.emplace("surface", surface);
  settings.numbers.emplace("field", static_cast<double>(field));
  const auto fill = [&](KeyTable keys) {
    for (const Key& key : keys) {
      if (key.kind == ValueKind::number && key.name != "points_per_mm") settings.numbers.emplace(key.name, key.fallback);
      if (key.kind == ValueKind::text) settings.texts.emplace(key.name, key.choices.substr(0, key.choices.find('|')));
    }
  };
  fill(variant_keys);
  fill(roughness_keys);
  return settings;
}

// The number of the surface that is named here; none, with an error, where the system has no such one.
std::optional<int> find_surface(const std::string& name, const Place& place, const Model& system, Findings& findings) {
  const auto number = surface_named(system, name);
  if (number) return number;
  std::vector<std::string> names;
  for (const Surface& one : system.surfaces)
    if (!findings.is_full() && !one.name.empty()) names.push_back(one.name);
  const std::string meant = nearest_name(name, names);
  findings.error(place, fmt::format("there is no surface '{}' in {}", excerpt(name), fs::path(system.file).filename().string()),
                 meant.empty() ? fmt::format("its surfaces are: {}", listed(names)) : fmt::format("did you mean '{}'?", meant));
  return std::nullopt;
}

void check_field(double field, const Place& place, const Model& system, Findings& findings) {
  const std::size_t count = system.fields.points.size();
  if (!(field < static_cast<double>(count)))
    findings.error(place, fmt::format("there is no field {:g}", field), fmt::format("the system has 0 to {}", count - 1));
}

// What one setting says to another, and to the system, if that could be read.
void check_variant(const Parameters& variant, const YamlNode& block, const Model& system, Findings& findings) {
  const bool is_sampled = variant.text("interpolation") != "analytic", is_on_rings = variant.number("rings") > 0 || variant.number("meridians") > 0;
  const auto at = [&](const char* key) {
    const auto found = variant.places.find(key);
    return found == variant.places.end() ? block.place : found->second;
  };
  if (is_on_rings && variant.text("arrangement") != "rings")
    findings.error(at("rings"), fmt::format("rings and meridians have no use with arrangement: {}", variant.text("arrangement")), "they are for arrangement: rings");
  else if ((variant.number("rings") > 0) != (variant.number("meridians") > 0))
    findings.error(at(variant.number("rings") > 0 ? "rings" : "meridians"), "rings and meridians stand together", "give both, or a density");
  else if (is_on_rings && variant.number("points_per_mm2") > 0)
    findings.error(at("points_per_mm2"), "a density beside rings and meridians", "keep one of them: the one follows from the others");
  else if (is_on_rings && !(variant.number("margin_spacings") < variant.number("rings")))
    findings.error(at("margin_spacings"), fmt::format("margin_spacings must be less than rings, {:g}, not {:g}", variant.number("rings"), variant.number("margin_spacings")));
  if (is_sampled && !is_on_rings && !(variant.number("points_per_mm2") > 0))
    findings.error(block.place, fmt::format("interpolation {} needs a density", variant.text("interpolation")), "give points_per_mm2 or points_per_mm, or interpolation: analytic");
  for (const char* key : {"points_per_mm2", "rings", "meridians", "cloud_radius_mm"})
    if (!is_sampled && variant.number(key) > 0) findings.error(at(key), fmt::format("{} has no use with interpolation: analytic", key), "there are no points: put it into a block of its own");
  if (variant.number("cloud_radius_mm") > 0 && variant.places.contains("margin_spacings"))
    findings.error(at("cloud_radius_mm"), "cloud_radius_mm beside margin_spacings", "keep one of them");
  if (variant.places.contains("truth") && !(variant.number("rms_um") > 0))
    findings.error(at("truth"), "a truth without a roughness", "give rms_um beside it");
  if (variant.text("search") == "nearest_vertex" && variant.text("interpolation") != "linear")
    findings.error(at("search"), fmt::format("the nearest vertex is looked for on linear facets, not with interpolation: {}", variant.text("interpolation")),
                   "put it into a block of its own");
  if (variant.number("tolerance_mm") > 0 && is_sampled)
    findings.error(at("tolerance_mm"), fmt::format("tolerance_mm has no use with interpolation: {}", variant.text("interpolation")), "it is for interpolation: analytic");
  if (system.surfaces.empty()) return;
  if (variant.places.contains("surface")) find_surface(variant.text("surface"), at("surface"), system, findings);
  if (variant.places.contains("field")) check_field(variant.number("field"), at("field"), system, findings);
}

std::vector<Parameters> read_variants(const YamlNode& node, const StudyFile& study, const std::string& surface, Findings& findings) {
  std::vector<Parameters> variants;
  std::map<std::pair<decltype(Parameters::numbers), decltype(Parameters::texts)>, std::size_t> known;
  if (node.kind != Kind::sequence || node.items.empty()) {
    refuse(node, "variants", "a list of at least one block of settings", findings);
    return variants;
  }
  for (std::size_t i = 0; i < node.items.size() && variants.size() <= most_variants; ++i) {
    const YamlNode& block = *node.items[i];
    const int errors_before = findings.error_count();
    for (const Parameters& given : read_settings(block, fmt::format("block {} of variants", i + 1), variant_keys, Lists::multiplied, findings)) {
      if (findings.error_count() > errors_before) break;
      variants.push_back(with_fallbacks(given, surface, study.field));
      check_variant(variants.back(), block, study.system, findings);
      const auto [first, is_new] = known.emplace(std::pair(variants.back().numbers, variants.back().texts), variants.size());
      if (!is_new && findings.error_count() == errors_before)
        findings.error(block.place, fmt::format("variants {} and {} are the same", first->second, variants.size()), "each is to stand once, over all blocks");
    }
  }
  if (variants.size() > most_variants) findings.error(node.place, fmt::format("more than {} variants", most_variants), "make several studies");
  return variants;
}

std::vector<PublishedFigure> read_paper(const YamlNode& node, const std::vector<Parameters>& variants, Findings& findings) {
  std::vector<PublishedFigure> paper;
  if (node.kind != Kind::sequence || node.items.empty()) {
    refuse(node, "paper", "a list of printed figures", findings);
    return paper;
  }
  if (node.items.size() > most_figures) {
    findings.error(node.place, fmt::format("{} printed figures are more than {}", node.items.size(), most_figures), "make several studies");
    return paper;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const Section section(*node.items[i], fmt::format("figure {} of paper", i + 1), paper_keys, findings);
    const YamlNode* where = section.find("where");
    if (!where) continue;
    PublishedFigure figure{read_settings(*where, "where", variant_keys, Lists::refused, findings).front(), {}, section.text("note").value_or("")};
    for (const Key& key : paper_keys)
      if (const auto value = key.kind == ValueKind::number ? section.number(key.name) : std::nullopt) figure.values.emplace_back(key.name, *value);
    if (!findings.has_errors() && std::none_of(variants.begin(), variants.end(), [&](const Parameters& one) { return has_settings(one, figure.where); }))
      findings.error(where->place, "no variant has these settings", "name settings that stand in one of the blocks of variants");
    paper.push_back(std::move(figure));
  }
  return paper;
}

// Line ends and all.
std::string read_paragraphs(const Section& section, std::string_view key) { return section.text(key) ? section.find(key)->text : std::string{}; }

bool is_name(const std::string& text) {
  return text.size() <= 60 && std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_'; });
}

void read_system(const Section& section, const std::string& surface, StudyFile& study, Findings& findings) {
  const auto name = section.text("system");
  if (!name) return;
  const Place& place = section.find("system")->place;
  const auto file = find_named_file(*name, place, findings);
  if (!file) return;
  ReadResult read = read_prescription(*file);
  for (const Finding& finding : read.findings.all()) findings.add(finding);
  if (!read.findings.all().empty()) findings.note(place, "named here");
  if (!read.model) return;
  study.system = std::move(*read.model);
  if (!surface.empty()) study.surface_number = find_surface(surface, section.find("surface")->place, study.system, findings).value_or(1);
  if (const YamlNode* field = section.find("field")) check_field(static_cast<double>(study.field), field->place, study.system, findings);
}

}  // namespace

StudyReadResult read_study(const std::string& file) {
  Findings findings;
  const YamlNode::Pointer root = read_yaml(file, findings);
  if (!root) return {std::nullopt, std::move(findings)};
  const Section section(*root, "the study", study_keys, findings);
  StudyFile study;
  study.file = file;
  section.number("sagitta_study");
  study.name = section.text("name").value_or("");
  if (!is_name(study.name))
    findings.error(section.find("name")->place, fmt::format("name must be of at most 60 letters, digits, - and _, not '{}'", excerpt(study.name)), "title takes any text");
  study.title = section.text("title").value_or(study.name);
  study.source = section.text("source").value_or("");
  study.about = read_paragraphs(section, "about");
  study.notes = read_paragraphs(section, "notes");
  study.field = static_cast<std::size_t>(section.number("field").value_or(0));
  const std::string surface = section.text("surface").value_or("");
  read_system(section, surface, study, findings);
  if (const YamlNode* node = section.find("variants")) study.variants = read_variants(*node, study, surface, findings);
  if (const YamlNode* node = section.find("paper")) study.paper = read_paper(*node, study.variants, findings);
  Findings ordered = in_order(findings, {{file, {}}});
  if (findings.has_errors()) return {std::nullopt, std::move(ordered)};
  return {std::move(study), std::move(ordered)};
}

std::optional<Place> place_of_root_key(const std::string& file, std::string_view key) {
  Findings unused;
  const YamlNode::Pointer root = read_yaml(file, unused);
  if (!root) return std::nullopt;
  const auto found = std::find_if(root->entries.begin(), root->entries.end(), [&](const YamlNode::Entry& entry) { return entry.key == key; });
  return found == root->entries.end() ? std::nullopt : std::optional(found->key_place);
}

std::optional<std::string> find_study(const std::string& name) {
  std::error_code failure;
  if (fs::is_regular_file(name, failure)) return name;
  return find_file(fmt::format("{}/{}.yaml", studies_folder, name), "");
}

std::vector<std::string> study_names() {
  std::set<std::string> names;
  for (const std::string& folder : search_folders("")) {
    std::error_code failure;
    for (const auto& entry : fs::directory_iterator(fs::path(folder) / studies_folder, failure))
      if (entry.path().extension() == ".yaml" && !entry.path().stem().string().ends_with("-system")) names.insert(entry.path().stem().string());
  }
  return {names.begin(), names.end()};
}

}  // namespace sagitta::prescription
