// SPDX-License-Identifier: Apache-2.0
// What `sagitta compare` says: several systems by the same rays, as JSON, tables, EXR parts and sheets.
//
// Part names, by the systems' slugs (short names of letters, digits and hyphens):
//   SLUG.spot.fieldI.NMnm, SLUG.wavefront.fieldI.NMnm               as those of one system (report.h)
//   SLUG-minus-FIRST.wavefront.fieldI.NMnm                          Y: the difference of OPD in waves, NaN where one has
//                                                                   none; difference.mask: analysis/difference.h
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/analysis/difference.h"
#include "lib/output/report.h"

namespace sagitta::output {

// How well a surface stands for the points that it was fitted to.
struct FitQuality {
  int terms = 0;
  double radius_mm = 0;        // of the circle whose points were used
  double residual_rms_um = 0;
  int surface_number = 0;      // the surface; its coverage is the share of the rays reaching it that meet it within the circle
};

struct ComparedSystem {
  Report report;    // its `system` is a name that no other of the comparison has
  std::string slug;  // neither has any other this one
  std::optional<FitQuality> fit;
  std::vector<analysis::Difference> differences;  // from the first system, by result; its own are zero
};

struct Comparison {
  std::string title;
  std::vector<ComparedSystem> systems;  // the rays are those of the first
  std::size_t primary = 0;              // number of the wavelength of the sheets
};

// Letters and digits in lower case, a hyphen in place of anything else: "Navarro eye, Zernike cornea" is
// navarro-eye-zernike-cornea. "system" where nothing is left.
std::string slug_of(const std::string& name);

// "left eye" where all are; "A: left eye, B: right eye"; "" where none says.
std::string eyes_of(const Comparison& comparison);

std::string summary_json(const Comparison& comparison);
std::string summary_text(const Comparison& comparison);

std::vector<ExrPart> parts(const Comparison& comparison);
// A sheet for each field, at the primary wavelength: a row for each system, with its spot, its wavefront, and how that
// differs from the first. All spots have one scale, so have all wavefronts, and all differences but those of systems whose
// wavefronts are of no use.
std::vector<Figure> sheets(const Comparison& comparison);

}  // namespace sagitta::output
