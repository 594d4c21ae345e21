// SPDX-License-Identifier: Apache-2.0
// Reads glass catalogues in the AGF format of Zemax, as makers of glass publish them. (Zemax OpticStudio User Manual, "Glass
// Catalog Format" and "The ... Formula"; OpticStudio's names of the formulas.)
//
// A catalogue is text: UTF-8, Latin-1, or UTF-16 with a byte order mark; lines end in LF, CRLF or CR. A line begins with two letters:
//   NM NAME FORMULA ...   begins a glass; what follows FORMULA (MIL code, Nd, Vd, status, ...) is left alone
//   CD c1 c2 ...          coefficients in um; those that are left out at the end are zero
//   LD MIN MAX            range in um; outside it the glass has no index
//   GC TEXT               comment on the glass; CC, before the first NM: on the catalogue. Both are handed on
// All else is left alone: ED, OD, IT (expansion, cost, transmission), and TD, the change of the index with the temperature. So the
// index is that at the reference temperature of TD (20 C in most catalogues), relative to air of that temperature and 1 atm, as CD
// gives it; a system at another temperature needs a catalogue for it.
//
// Formulas (L: wavelength in um; c: CD):
//    1 Schott        n^2 = c1 + c2 L^2 + c3 L^-2 + c4 L^-4 + c5 L^-6 + c6 L^-8
//    2 Sellmeier 1   n^2 = 1 + c1 L^2/(L^2 - c2) + c3 L^2/(L^2 - c4) + c5 L^2/(L^2 - c6)
//    3 Herzberger    n   = c1 + c2 H + c3 H^2 + c4 L^2 + c5 L^4 + c6 L^6,   H = 1/(L^2 - 0.028)
//    4 Sellmeier 2   n^2 = 1 + c1 + c2 L^2/(L^2 - c3^2) + c4/(L^2 - c5^2)
//    5 Conrady       n   = c1 + c2/L + c3/L^3.5
//    6 Sellmeier 3   as 2, of four terms
//    7 Handbook 1    n^2 = c1 + c2/(L^2 - c3) - c4 L^2
//    8 Handbook 2    n^2 = c1 + c2 L^2/(L^2 - c3) - c4 L^2
//    9 Sellmeier 4   n^2 = c1 + c2 L^2/(L^2 - c3) + c4 L^2/(L^2 - c5)
//   10 Extended      as 1, and c7 L^-10 + c8 L^-12
//   11 Sellmeier 5   as 2, of five terms
//   12 Extended 2    as 1, and c7 L^4 + c8 L^6
//   13 Extended 3    n^2 = c1 + c2 L^2 + c3 L^4 + c4 L^-2 + c5 L^-4 + c6 L^-6 + c7 L^-8 + c8 L^-10 + c9 L^-12
// Each is one of lib/medium's formulas with other names; no digit is lost on the way but the one that 1 + c1 of formula 4 rounds.
// (Some programs write L^2 over the last fraction of formula 4. The manual has none.)
//
// A glass is looked at when it is asked for, so that a fault in one does not hinder the use of the others.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/material_reader.h"

namespace sagitta::prescription {

// A line of a catalogue as it stands there, without its letters; number 0: the glass has none.
struct AgfLine {
  std::string text;
  int number = 0;
  int column = 0;    // of the first byte of the text, counted in UTF-8
  int repeated = 0;  // number of the next line of its kind in the same glass; 0: there is none
};

struct AgfGlass {
  std::string name;
  AgfLine formula, coefficients, range, comment;
};

struct AgfCatalog {
  std::string file, comment;
  std::vector<AgfGlass> glasses;                         // in the order of the file; of several of one name the first
  std::unordered_map<std::string, std::size_t> by_name;  // places in `glasses`

  const AgfGlass* find(const std::string& name) const;  // null where there is none
};

inline constexpr std::size_t most_agf_bytes = std::size_t{16} << 20, most_agf_glasses = 20'000;

// None, with an error, where the file cannot be read, is larger than most_agf_bytes, holds no glass or more than most_agf_glasses.
// A name that is repeated is a warning; the first counts.
std::optional<AgfCatalog> read_agf(const std::string& file, Findings& findings);

// The glass as a medium. None, with errors at its lines, where the formula is unknown, a number is none, all coefficients are zero,
// the range is missing or not one, coefficients or range are given twice, or the index does not exist in the range.
std::optional<Material> read_glass(const AgfCatalog& catalog, const AgfGlass& glass, Findings& findings);

}  // namespace sagitta::prescription
