// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/documents.h"

#include <algorithm>
#include <string>
#include <utility>

namespace sagitta::prescription {
namespace {

// Where a finding stands: the places that name one base after the other, then the place in the last of them.
struct Position {
  std::size_t depth = 0;  // of the document
  std::vector<std::pair<int, int>> path{{0, 0}};
};

Position position(const std::vector<Document>& documents, std::size_t depth, const Place& place) {
  Position result{depth, {}};
  for (std::size_t i = 1; i <= depth; ++i) result.path.emplace_back(documents[i].named_at.line, documents[i].named_at.column);
  result.path.emplace_back(place.line, place.column);
  return result;
}

}  // namespace

Findings in_order(const Findings& findings, const std::vector<Document>& documents) {
  struct Placed {
    Position at;
    const Finding* finding;
  };
  std::vector<Placed> placed;
  Position last;
  for (auto one = findings.all().rbegin(); one != findings.all().rend(); ++one) {
    const auto of = std::find_if(documents.begin(), documents.end(),
                                 [&](const Document& document) { return document.file == one->place.file; });
    if (of != documents.end()) last = position(documents, static_cast<std::size_t>(of - documents.begin()), one->place);
    placed.push_back({last, &*one});
  }
  std::reverse(placed.begin(), placed.end());
  std::stable_sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) { return a.at.path < b.at.path; });

  Findings ordered;
  std::size_t depth = 0;
  const auto go_to = [&](std::size_t next) {  // leaving a base, say where it is named
    for (; depth > next; --depth) ordered.note(documents[depth].named_at, "named here");
    depth = next;
  };
  for (const Placed& one : placed) {
    if (ordered.error_count() == most_told_errors) break;
    go_to(one.at.depth);
    ordered.add(*one.finding);
  }
  go_to(0);
  if (findings.error_count() > most_told_errors)
    ordered.note({documents.front().file},
                 "and " + std::to_string(findings.error_count() - most_told_errors) + " more errors");
  return ordered;
}

}  // namespace sagitta::prescription
