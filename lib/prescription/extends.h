// SPDX-License-Identifier: Apache-2.0
// `extends: base.yaml`: one prescription on top of another, merged as trees before the model is read, so that every node
// keeps the place where it stands.
//
// The keys of the file replace those of its base. Its `surfaces` are a list in which each entry has the `name` of exactly
// one surface of the base: the entry's keys replace that surface's, a shape replaces its shape whichever kind it has. A
// base may extend another: at most 16 files in all. `parameters` give values to those of the base, by name, and may declare
// others.
//
// Errors: a base that is not there, a file that extends itself through others, a longer chain; a name that is missing,
// unknown, borne by several surfaces of the base, or repeated.
#pragma once

#include <string>
#include <vector>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/documents.h"
#include "lib/prescription/yaml_tree.h"

namespace sagitta::prescription {

struct ExtendedTree {
  YamlNode::Pointer root;           // without `extends`; null where a file could not be read
  std::vector<Document> documents;  // the file itself, then the bases that were found
};

ExtendedTree read_extended(const std::string& file, Findings& findings);

}  // namespace sagitta::prescription
