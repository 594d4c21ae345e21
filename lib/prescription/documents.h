// SPDX-License-Identifier: Apache-2.0
// The files that make one prescription: the one that was asked for and, through `extends`, its base, the base's base, ...
#pragma once

#include <string>
#include <vector>

#include "lib/prescription/diagnostics.h"

namespace sagitta::prescription {

struct Document {
  std::string file;
  Place named_at;  // in the document before it; of the first: nowhere
};

// The findings in the order of the prescription, up to 100 errors. What is said about another file goes with the note
// "named here" that follows it and has a place in a document. Findings in a base stand where the base is named, in the
// order of the base, and are followed by such a note themselves.
Findings in_order(const Findings& findings, const std::vector<Document>& documents);

}  // namespace sagitta::prescription
