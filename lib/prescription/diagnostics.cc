// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/diagnostics.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <string_view>
#include <utility>

#include "lib/prescription/utf8.h"

namespace sagitta::prescription {
namespace {

constexpr std::size_t excerpt_bytes = 40;
constexpr std::size_t most_listed = 12, most_candidates = 1000;
constexpr std::size_t longest_name = 64;  // a longer one is no misspelt key; bounds the time as well

unsigned char byte(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
}

// Edits that turn one into the other: insert, delete, replace a byte, or swap two neighbours (Damerau and Levenshtein,
// optimal string alignment), by rows of the table of prefixes.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = std::exchange(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::size_t utf8_length(std::string_view text) {
  const unsigned char first = byte(text, 0), second = byte(text, 1);
  const auto continues = [&](std::size_t i) { return (byte(text, i) & 0xC0) == 0x80; };
  if (text.empty()) return 0;
  if (first < 0x80) return 1;
  if (first < 0xC2 || !continues(1)) return 0;
  if (first < 0xE0) return 2;
  if (first < 0xF0)
    return continues(2) && !(first == 0xE0 && second < 0xA0) && !(first == 0xED && second >= 0xA0) ? 3 : 0;
  const bool in_range = first <= 0xF4 && !(first == 0xF0 && second < 0x90) && !(first == 0xF4 && second >= 0x90);
  return in_range && continues(2) && continues(3) ? 4 : 0;
}

bool starts_with_control(std::string_view text) {
  const unsigned char first = byte(text, 0);
  return !text.empty() &&
         (first < 0x20 || first == 0x7F || (first == 0xC2 && byte(text, 1) >= 0x80 && byte(text, 1) < 0xA0));
}

void Findings::add(Finding finding) {
  if (finding.severity == Severity::error) ++error_count_;
  findings_.push_back(std::move(finding));
}

void Findings::error(Place place, std::string what, std::string hint) {
  add({std::move(place), Severity::error, std::move(what), std::move(hint)});
}

void Findings::warning(Place place, std::string what, std::string hint) {
  add({std::move(place), Severity::warning, std::move(what), std::move(hint)});
}

void Findings::note(Place place, std::string what, std::string hint) {
  add({std::move(place), Severity::note, std::move(what), std::move(hint)});
}

std::string format(const Finding& finding) {
  const Place& place = finding.place;
  const std::string severity = finding.severity == Severity::error     ? "error"
                               : finding.severity == Severity::warning ? "warning"
                                                                       : "note";
  std::string text = place.file;
  if (place.line >= 0) text += ':' + std::to_string(std::max(place.line, 1)) + ':' + std::to_string(std::max(place.column, 1));
  text += ": " + severity + ": " + finding.what;
  if (!finding.hint.empty()) text += "\n  hint: " + finding.hint;
  return text;
}

std::string nearest_name(const std::string& given, const std::vector<std::string>& candidates) {
  if (given.empty() || given.size() > longest_name) return {};
  std::string nearest;
  std::size_t least = std::max<std::size_t>(1, given.size() / 3) + 1;
  for (const std::string& candidate : std::span(candidates).first(std::min(candidates.size(), most_candidates))) {
    if (candidate.size() > longest_name) continue;
    const std::size_t distance = edit_distance(given, candidate);
    if (distance < least) least = distance, nearest = candidate;
  }
  return nearest;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  const std::size_t count = std::min(names.size(), most_listed);
  for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + excerpt(names[i]);
  return names.size() > count ? text + " and " + std::to_string(names.size() - count) + " more" : text;
}

std::string excerpt(const std::string& text) {
  std::string shown;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t length = utf8_length(rest);
    const bool harmful = length == 0 || starts_with_control(rest);
    const std::string_view next = harmful ? std::string_view("?") : rest.substr(0, length);
    if (shown.size() + next.size() > excerpt_bytes) return shown + "...";
    shown += next;
    rest.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return shown;
}

}  // namespace sagitta::prescription
