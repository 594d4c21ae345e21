// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/value_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "lib/prescription/expression.h"

namespace sagitta::prescription {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The legal numbers in words.
std::string in_words(const numerics::Range& range) {
  const bool from_below = range.low > std::numeric_limits<double>::lowest(), to_above = range.high < infinity;
  if (range.low == range.high) return fmt::format("{}", range.low);
  std::string words = range.whole ? "a whole number" : "a number";
  if (from_below && to_above) {
    words += range.open ? " between " : " from ";
    words += fmt::format("{} {} {}", range.low, range.open ? "and" : "to", range.high);
    if (range.open) words += ", both excluded";
  } else if (from_below) {
    words += fmt::format(" {} {}", range.open ? "greater than" : "of at least", range.low);
  } else if (to_above) {
    words += fmt::format(" {} {}", range.open ? "less than" : "of at most", range.high);
  }
  if (!range.zero) words += " other than 0";
  if (range.infinite) words += range.low == -infinity ? " (.inf and -.inf are legal)" : " (.inf is legal)";
  return words;
}

// What stands in the file, in words.
std::string shown(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null:
      return "empty";
    case YamlNode::Kind::sequence:
      return fmt::format("a list of {}", node.items.size());
    case YamlNode::Kind::mapping:
      return "a mapping";
    case YamlNode::Kind::scalar:
      break;
  }
  if (node.text.empty()) return "an empty text";
  if (node.arithmetic && !node.arithmetic->fault) return fmt::format("{}, what '{}' comes to", node.arithmetic->value, excerpt(node.text));
  return fmt::format("{}'{}'", node.quoted ? "the text " : "", excerpt(node.text));
}

// How to turn this text into a number, for the usual slips; empty where it is none of them.
std::string number_hint(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::scalar) return {};
  const std::string& text = node.text;
  if (node.quoted && parse_number(text).ok) return "leave out the quotes";
  if (text.starts_with('=')) return "arithmetic stands in the values of a prescription, not here";
  if (text == "inf" || text == "-inf" || text == "Infinity" || text == "infinity") return "infinity is written .inf";
  const std::size_t end = text.find_first_not_of("+-.0123456789");
  if (end == std::string::npos || !parse_number(std::string_view(text).substr(0, end)).ok) return {};
  if (text[end] == ',') return "decimals are written with a point";
  const std::string_view rest = std::string_view(text).substr(std::min(text.find_first_not_of(' ', end), text.size()));
  constexpr std::array units{"mm", "um", "µm", "nm", "cm", "m", "deg", "degrees", "°", "d", "D", "in", "waves", "mm^-1", "1/mm", "%"};
  if (std::find(units.begin(), units.end(), rest) == units.end()) return {};
  return fmt::format("write {}: units stand in the names of keys, not with the numbers", excerpt(text.substr(0, end)));
}

// `[=min(a, 2), 0]` is a list of three: the comma within the parentheses parts its items.
bool is_cut_expression(const YamlNode& node) {
  return node.text.starts_with('=') && std::count(node.text.begin(), node.text.end(), '(') > std::count(node.text.begin(), node.text.end(), ')');
}

std::vector<std::string> names_of(KeyTable keys) {
  std::vector<std::string> names;
  for (const numerics::Key& key : keys) names.emplace_back(key.name);
  return names;
}

// The key that was meant: one that goes on where the given one ends ("radius" for radius_mm), or else the nearest.
std::string unknown_key_hint(const std::string& given, KeyTable keys) {
  const std::vector<std::string> names = names_of(keys);
  const auto goes_on = [&](const std::string& name) { return given.size() >= 3 && name.starts_with(given); };
  const auto found = std::find_if(names.begin(), names.end(), goes_on);
  const std::string meant = found != names.end() ? *found : nearest_name(given, names);
  if (!meant.empty()) return fmt::format("did you mean '{}'?", meant);
  return names.empty() ? "it takes no keys: {}" : fmt::format("the keys here are: {}", fmt::join(names, ", "));
}

bool is_plain(const YamlNode& node) { return node.kind == YamlNode::Kind::scalar && !node.quoted; }

std::optional<int> parse_index(const std::string& text) {
  int index = 0;
  if (text.starts_with('-')) return std::nullopt;  // -0
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), index);
  return status == std::errc{} && end == text.data() + text.size() ? std::optional(index) : std::nullopt;
}

}  // namespace

void refuse(const YamlNode& node, const std::string& label, const std::string& legal, Findings& findings) {
  findings.error(node.place, fmt::format("{} must be {}, not {}", label, legal, shown(node)));
}

std::optional<double> read_number(const YamlNode& node, const std::string& label, const numerics::Range& range,
                                  Findings& findings) {
  if (node.arithmetic && node.arithmetic->fault) {
    Finding fault = *node.arithmetic->fault;
    fault.what = fmt::format("{}: {}", label, fault.what);
    findings.add(std::move(fault));
    return std::nullopt;
  }
  const ParsedNumber parsed = node.arithmetic ? ParsedNumber{true, node.arithmetic->value} : is_plain(node) ? parse_number(node.text) : ParsedNumber{};
  if (parsed.ok && std::isfinite(parsed.value) && std::abs(parsed.value) > largest_number) {
    findings.error(node.place, fmt::format("{} must be at most {:g} in size, not {}", label, largest_number, shown(node)),
                   "products of larger numbers are infinite, and rays could not be traced");
    return std::nullopt;
  }
  if (parsed.ok && parsed.value != 0 && std::abs(parsed.value) < smallest_number && range.contains(parsed.value)) {
    findings.error(node.place, fmt::format("{} must be at least {:g} in size, not {}", label, smallest_number, shown(node)),
                   range.contains(0) ? "or 0" : "the square of a smaller number is 0, and rays could not be traced");
    return std::nullopt;
  }
  if (parsed.ok && range.contains(parsed.value)) return parsed.value;
  const bool is_too_far = parsed.ok && std::isfinite(parsed.value) && parsed.value != 0 && !range.contains(-parsed.value);
  findings.error(node.place, fmt::format("{} must be {}, not {}", label, in_words(range), shown(node)),
                 !parsed.ok                                    ? number_hint(node)
                 : std::isinf(parsed.value) && !range.infinite ? "it must be finite"
                 : is_too_far                                  ? std::string(range.reason)
                                                               : "");
  return std::nullopt;
}

std::optional<bool> read_flag(const YamlNode& node, const std::string& label, Findings& findings) {
  if (is_plain(node) && (node.text == "true" || node.text == "false")) return node.text == "true";
  refuse(node, label, "true or false", findings);
  return std::nullopt;
}

std::optional<std::string> read_text(const YamlNode& node, const std::string& label, std::string_view choices,
                                     Findings& findings) {
  if (choices.empty()) {
    if (node.kind != YamlNode::Kind::scalar || node.text.empty()) {
      refuse(node, label, "a text", findings);
      return std::nullopt;
    }
    std::string text = node.text;
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\t'; }, ' ');
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
  }
  const std::vector<std::string> names = numerics::words_of(choices);
  if (node.kind == YamlNode::Kind::scalar && std::find(names.begin(), names.end(), node.text) != names.end())
    return node.text;
  const std::string meant = node.kind == YamlNode::Kind::scalar ? nearest_name(node.text, names) : "";
  findings.error(node.place,
                 fmt::format("{} must be {}{}, not {}", label, names.size() > 1 ? "one of " : "",
                             fmt::join(names, ", "), shown(node)),
                 meant.empty() ? "" : fmt::format("did you mean '{}'?", meant));
  return std::nullopt;
}

std::optional<std::vector<double>> read_tuple(const YamlNode& node, const std::string& label,
                                              std::string_view components, const numerics::Range& range,
                                              Findings& findings) {
  if (node.kind != YamlNode::Kind::sequence || node.items.size() != components.size()) {
    const bool is_cut = std::any_of(node.items.begin(), node.items.end(), [](const YamlNode::Pointer& item) { return is_cut_expression(*item); });
    findings.error(node.place, fmt::format("{} must be a list [{}], not {}", label, fmt::join(components, ", "), shown(node)), is_cut ? hint_of_open_parenthesis : "");
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < components.size(); ++i)
    if (const auto value = read_number(*node.items[i], fmt::format("{} of {}", components[i], label), range, findings))
      values.push_back(*value);
  return values.size() == components.size() ? std::optional(values) : std::nullopt;
}

std::optional<std::vector<std::pair<int, double>>> read_indexed(const YamlNode& node, const std::string& label,
                                                                const numerics::Range& range,
                                                                numerics::IndexRange indices, Findings& findings) {
  std::map<int, double> values;
  bool all_legal = true;
  const auto add = [&](std::optional<int> index, const std::string& key, const Place& place, const YamlNode& value) {
    const bool is_legal = index && indices.contains(*index);
    if (!is_legal)
      findings.error(place, fmt::format("an index of {} must be {} number from {} to {}, not '{}'", label, indices.step == 2 ? "an even" : "a whole",
                                        indices.first, indices.last, excerpt(key)));
    const auto number = read_number(value, fmt::format("{} of index {}", label, excerpt(key)), range, findings);
    const bool is_new = is_legal && number && values.emplace(*index, *number).second;
    if (is_legal && number && !is_new) findings.error(place, fmt::format("index {} of {} is repeated", *index, label));
    all_legal = all_legal && is_new;
  };
  if (node.kind == YamlNode::Kind::mapping) {
    for (const YamlNode::Entry& entry : node.entries)
      add(parse_index(entry.key), entry.key, entry.key_place, *entry.value);
  } else if (node.kind == YamlNode::Kind::sequence && indices.is_list) {
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const int index = indices.first + indices.step * static_cast<int>(i);
      add(index, std::to_string(index), node.items[i]->place, *node.items[i]);
    }
  } else {
    refuse(node, label, indices.is_list ? "a mapping {index: value, ...} or a list" : "a mapping {index: value, ...}", findings);
    return std::nullopt;
  }
  if (!all_legal) return std::nullopt;
  return std::vector<std::pair<int, double>>(values.begin(), values.end());
}

Section::Section(const YamlNode& node, std::string owner, KeyTable keys, Findings& findings)
    : node_(node), owner_(std::move(owner)), keys_(keys), findings_(findings) {
  if (node.kind != YamlNode::Kind::mapping) {
    const std::vector<std::string> names = names_of(keys);
    refuse(node, owner_, names.empty() ? "{}" : fmt::format("a mapping of {}", fmt::join(names, ", ")), findings);
    return;
  }
  for (const YamlNode::Entry& entry : node.entries)
    if (std::none_of(keys.begin(), keys.end(), [&](const numerics::Key& key) { return key.name == entry.key; }))
      findings.error(entry.key_place, fmt::format("unknown key '{}' in {}", excerpt(entry.key), owner_),
                     unknown_key_hint(entry.key, keys));
  for (const numerics::Key& key : keys)
    if (key.required && !find(key.name))
      findings.error(node.place, fmt::format("missing key '{}' in {}", key.name, owner_),
                     fmt::format("{}: {}", key.name, key.meaning));
}

const numerics::Key& Section::described(std::string_view key) const {
  return *std::find_if(keys_.begin(), keys_.end(), [&](const numerics::Key& one) { return one.name == key; });
}

std::optional<double> Section::number(std::string_view key) const {
  const YamlNode* node = find(key);
  return node ? read_number(*node, std::string(key), described(key).range, findings_) : std::nullopt;
}

std::optional<bool> Section::flag(std::string_view key) const {
  const YamlNode* node = find(key);
  return node ? read_flag(*node, std::string(key), findings_) : std::nullopt;
}

std::optional<std::string> Section::text(std::string_view key) const {
  const YamlNode* node = find(key);
  return node ? read_text(*node, std::string(key), described(key).choices, findings_) : std::nullopt;
}

const YamlNode::Entry* Section::one_of(KeyTable alternatives, bool required) const {
  const YamlNode::Entry* chosen = nullptr;
  for (const YamlNode::Entry& entry : node_.entries) {
    if (std::none_of(alternatives.begin(), alternatives.end(),
                     [&](const numerics::Key& key) { return key.name == entry.key; }))
      continue;
    if (!chosen)
      chosen = &entry;
    else
      findings_.error(entry.key_place, fmt::format("'{}' beside '{}' in {}", entry.key, chosen->key, owner_),
                      fmt::format("keep exactly one of {}", fmt::join(names_of(alternatives), ", ")));
  }
  if (!chosen && required && node_.kind == YamlNode::Kind::mapping)
    findings_.error(node_.place, fmt::format("{} needs one of {}", owner_, fmt::join(names_of(alternatives), ", ")));
  return chosen;
}

}  // namespace sagitta::prescription
