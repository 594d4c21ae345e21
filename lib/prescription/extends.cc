// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/extends.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "lib/prescription/keys.h"
#include "lib/prescription/search_path.h"
#include "lib/prescription/value_reader.h"

namespace sagitta::prescription {
namespace {

constexpr std::size_t most_documents = 16;

using Entries = std::vector<YamlNode::Entry>;

bool is_shape(const std::string& key) {
  return std::any_of(shape_kinds().begin(), shape_kinds().end(), [&](const ShapeKind& kind) { return kind.name == key; });
}

// Those of `entries` whose keys the changes have too are replaced, and the others follow.
void put(Entries& entries, const Entries& changes) {
  std::unordered_map<std::string, std::size_t> place;
  for (std::size_t i = 0; i < entries.size(); ++i) place.emplace(entries[i].key, i);
  for (const YamlNode::Entry& entry : changes) {
    if (const auto old = place.find(entry.key); old != place.end())
      entries[old->second] = entry;
    else
      entries.push_back(entry);
  }
}

std::string name_of(const YamlNode& surface) {
  const YamlNode::Pointer name = surface.find("name");
  return name ? name->text : "";
}

YamlNode::Pointer with_changes(const YamlNode& surface, const YamlNode& changes) {
  auto result = std::make_shared<YamlNode>(surface);
  const auto is_shape_entry = [](const YamlNode::Entry& one) { return is_shape(one.key); };
  if (std::any_of(changes.entries.begin(), changes.entries.end(), is_shape_entry)) std::erase_if(result->entries, is_shape_entry);
  put(result->entries, changes.entries);
  return result;
}

// The surfaces of a base by their names.
struct NamedSurfaces {
  explicit NamedSurfaces(const YamlNode& base) {
    for (std::size_t i = 0; i < base.items.size(); ++i) {
      const std::string name = name_of(*base.items[i]);
      if (!name.empty()) names.push_back(name);
      places[name].push_back(i);
    }
  }
  std::unordered_map<std::string, std::vector<std::size_t>> places;  // in the list
  std::vector<std::string> names;                                    // in its order
};

// The place in the base's list of the surface that an entry names; none, with an error, where there is none or more than one.
std::optional<std::size_t> find_surface(const NamedSurfaces& base, const YamlNode& entry, Findings& findings) {
  if (entry.kind != YamlNode::Kind::mapping) {
    refuse(entry, "each of surfaces of a file that extends another", "a mapping with the name of a surface of the base", findings);
    return std::nullopt;
  }
  const YamlNode::Pointer given = entry.find("name");
  if (!given) {
    findings.error(entry.place, "missing key 'name' in an entry of surfaces",
                   "in a file that extends another it says which surface is changed");
    return std::nullopt;
  }
  if (!read_text(*given, "name", {}, findings)) return std::nullopt;
  if (const auto found = base.places.find(given->text); found != base.places.end()) {
    if (found->second.size() == 1) return found->second.front();
    findings.error(given->place, fmt::format("{} surfaces of the base are named '{}'", found->second.size(), excerpt(given->text)),
                   "give them names of their own there");
    return std::nullopt;
  }
  const std::string near = findings.is_full() ? "" : nearest_name(given->text, base.names);
  findings.error(given->place, fmt::format("no surface of the base is named '{}'", excerpt(given->text)),
                 !near.empty()        ? fmt::format("did you mean '{}'?", excerpt(near))
                 : base.names.empty() ? "its surfaces have no names"
                                      : fmt::format("its surfaces are: {}", listed(base.names)));
  return std::nullopt;
}

YamlNode::Pointer merged_surfaces(const YamlNode::Pointer& base, const YamlNode& changes, Findings& findings) {
  if (changes.kind != YamlNode::Kind::sequence) {
    refuse(changes, "surfaces of a file that extends another", "a list of changes to the base's surfaces", findings);
    return base;
  }
  if (base->kind != YamlNode::Kind::sequence) return base;  // which is an error of the base
  auto result = std::make_shared<YamlNode>(*base);
  const NamedSurfaces surfaces(*base);
  std::map<std::size_t, int> changed_on_line;
  for (const YamlNode::Pointer& entry : changes.items) {
    const auto i = find_surface(surfaces, *entry, findings);
    if (!i) continue;
    const Place& place = entry->find("name")->place;
    if (const auto [before, is_new] = changed_on_line.emplace(*i, place.line); !is_new)
      findings.error(place, fmt::format("the surface '{}' is repeated", excerpt(name_of(*entry))),
                     fmt::format("it stands on line {} already", before->second));
    else
      result->items[*i] = with_changes(*base->items[*i], *entry);
  }
  return result;
}

YamlNode::Pointer merged_parameters(const YamlNode::Pointer& base, const YamlNode::Pointer& changes) {
  if (changes->kind != YamlNode::Kind::mapping) return changes;  // which is an error here,
  if (base->kind != YamlNode::Kind::mapping) return base;        // and this one of the base
  auto result = std::make_shared<YamlNode>(*base);
  put(result->entries, changes->entries);
  return result;
}

// Both files are of the same version of the format, or the base's keys would be read by other rules than were meant.
void check_version(const YamlNode& base, Findings& findings) {
  if (const YamlNode::Pointer version = base.find("sagitta"))
    read_number(*version, "sagitta", {prescription_version, prescription_version}, findings);
}

YamlNode::Pointer merged(const YamlNode& base, const YamlNode& changes, Findings& findings) {
  auto result = std::make_shared<YamlNode>(changes);
  for (YamlNode::Entry& entry : result->entries) {
    if (entry.key == "sagitta") check_version(base, findings);
    const YamlNode::Pointer old = base.find(entry.key);
    if (old && entry.key == "surfaces") entry.value = merged_surfaces(old, *entry.value, findings);
    if (old && entry.key == "parameters") entry.value = merged_parameters(old, entry.value);
  }
  Entries entries = base.entries;
  put(entries, std::exchange(result->entries, {}));
  result->entries = std::move(entries);
  return result;
}

// The base's file; "" with an error where there is none to go on with.
std::string find_base(const YamlNode& extends, const std::vector<Document>& documents, Findings& findings) {
  if (extends.kind != YamlNode::Kind::scalar || extends.text.empty()) {
    refuse(extends, "extends", "the name of a file", findings);
    return {};
  }
  const auto name = read_text(extends, "extends", {}, findings);
  const auto file = name ? find_named_file(*name, extends.place, findings) : std::nullopt;
  if (!file) return {};
  std::error_code failure;
  const auto is_file = [&](const Document& one) { return std::filesystem::equivalent(one.file, *file, failure); };
  if (const auto first = std::find_if(documents.begin(), documents.end(), is_file); first != documents.end()) {
    std::vector<std::string> between;
    for (auto one = first + 1; one != documents.end(); ++one) between.push_back(fmt::format("'{}'", excerpt(std::filesystem::path(one->file).filename().string())));
    findings.error(extends.place, fmt::format("'{}' extends itself{}{}", excerpt(*name), between.empty() ? "" : " by way of ",
                                              fmt::join(between, ", ")));
    return {};
  }
  if (documents.size() == most_documents) {
    findings.error(extends.place, fmt::format("a chain of more than {} files that extend each other", most_documents));
    return {};
  }
  return *file;
}

YamlNode::Pointer read_and_merge(std::vector<Document>& documents, Findings& findings) {
  const YamlNode::Pointer own = read_yaml(documents.back().file, findings);
  const YamlNode::Pointer extends = own ? own->find("extends") : nullptr;
  if (!extends) return own;
  const std::string file = find_base(*extends, documents, findings);
  if (file.empty()) return nullptr;
  documents.push_back({file, extends->place});
  const YamlNode::Pointer base = read_and_merge(documents, findings);
  if (!base) return nullptr;
  auto changes = std::make_shared<YamlNode>(*own);
  std::erase_if(changes->entries, [](const YamlNode::Entry& one) { return one.key == "extends"; });
  if (base->kind != YamlNode::Kind::mapping) {
    refuse(*base, "a prescription that is extended", "a mapping", findings);
    return nullptr;
  }
  return merged(*base, *changes, findings);
}

}  // namespace

ExtendedTree read_extended(const std::string& file, Findings& findings) {
  ExtendedTree result{nullptr, {{file, {}}}};
  result.root = read_and_merge(result.documents, findings);
  return result;
}

}  // namespace sagitta::prescription
