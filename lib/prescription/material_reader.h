// SPDX-License-Identifier: Apache-2.0
// Reads one medium from a file in refractiveindex.info's YAML format.
//
// The format (CC0, https://refractiveindex.info) is foreign, so only what gives n is looked at: under DATA, a list of
//   - type: formula N,      with wavelength_range (older files: range) and coefficients, in um (lib/medium/formulas.h). In place of
//                           the number the name of a formula that the database does not have: Cornu, Navarro
//   - type: tabulated n,    with data: rows of um, n (lib/medium/table.h)
//   - type: tabulated nk,   rows of um, n, k; k is read as a number and left
//   - type: tabulated k, n2 left alone
// REFERENCES and COMMENTS are handed on. Everything else in the file (conditions, properties, with "formula A" among them) is left alone.
// Where several entries give n, the first one counts and a warning names the others. The range of validity is the
// formula's wavelength_range or the table's ends; in it the index must exist (medium::wavelength_without_index).
// Table rows out of order are sorted, with a note; the same row twice is one row; two indices at one wavelength are an
// error. At most 20 errors are reported of one file.
#pragma once

#include <optional>
#include <string>

#include "lib/medium/medium.h"
#include "lib/prescription/diagnostics.h"

namespace sagitta::prescription {

// A medium, and where it comes from.
struct Material : medium::Medium {
  Place place;                       // in which file, and where there; "" for air
  std::string references, comments;  // what the file says of itself
};

// The medium in `file`, named after the file. Findings are about that file.
std::optional<Material> read_material(const std::string& file, Findings& findings);

}  // namespace sagitta::prescription
