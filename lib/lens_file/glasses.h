// SPDX-License-Identifier: Apache-2.0
// Names of glasses, as lens files spell them, to media that a prescription can name.
//
// A name counts as it is; else the medium whose name is the same but for capital letters, `-`, `_` and blanks (CODE V's NBK7 is N-BK7), then without a last part
// `_MAKER` (NBK7_SCHOTT), then by the few names of other programs for what is here under another one. Where the medium that is found so is not the
// glass of a maker but a substance, whose formula may be another source's, a warning says so.
//
// Makers give the same name to different glasses (F5 is Schott's and CDGM's). So a glass `_MAKER` whose sources name other makers, and not that one, is unknown; where
// they name none, a warning says so. Where the file only lists catalogues, none of them of the maker here, or states an nd or Vd that is another one, a warning says so.
#pragma once

#include <span>
#include <string>

#include "lib/lens_file/lens.h"
#include "lib/lens_file/report.h"
#include "lib/medium/medium.h"
#include "lib/prescription/agf_reader.h"

namespace sagitta::lens_file {

// Gives every glass of the lens the name of its medium, and checks that it has an index at every wavelength. Media are looked for as they will be for a
// prescription `output`. An error where there is none, at the place in the lens file.
void find_glasses(Lens& lens, const std::string& output, std::span<const prescription::AgfCatalog> catalogs, Report& report);

// The index of a medium whose glass is found, at a wavelength; of a mirror and of a gradient NaN.
double index_of(const Medium& medium, double wavelength_nm, const std::string& output, std::span<const prescription::AgfCatalog> catalogs);

}  // namespace sagitta::lens_file
