// SPDX-License-Identifier: Apache-2.0
// Reads lens files of other programs. A format is one file, and one line in lens_reader.cc.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "lib/lens_file/lens.h"
#include "lib/lens_file/report.h"

namespace sagitta::lens_file {

inline constexpr std::size_t most_lens_file_bytes = std::size_t{4} << 20;
inline constexpr int most_surfaces = 1000, most_fields = 1000, most_wavelengths = 1000;

// The formats that are read, as "LENS.zmx or LENS.seq".
std::string lens_file_formats();
// Whether the name of the file, whose ending tells the format, is one of them.
bool is_lens_file(const std::string& file);

// By the ending of its name. None, with an error, where the file cannot be read, or says too little to be a lens; what it returns beside errors is not to be used.
// Glasses are names, and no solve is solved.
std::optional<Lens> read_lens(const std::string& file, Report& report);

// Zemax OpticStudio, sequential (.zmx): lines of an operand of four letters and what belongs to it; those of a surface are indented behind SURF. There is no public
// specification; the operands are those that public files have. What is read: VERS MODE NAME UNIT, ENPD FNUM OBNA FLOA, FTYP XFLN YFLN, WAVM WAVL PWAV, ENVD GCAT GFAC RAIM VDXN
// VDYN VCXN VCYN VANN MNUM, SURF TYPE STOP CURV CONI DISZ GLAS DIAM PARM XDAT COMM IGNR CLAP FLAP OBSC OBDC GDAT GARR. Curvatures are 1/unit, radii PARM 1 of BICONICX and TOROIDAL.
// A tilt of a coordinate break (PARM 3 to 5) turns right-handed, in degrees: positive about x, +y turns toward +z (Zemax, "Rotation Matrix and Tilt About X/Y/Z").
std::optional<Lens> read_zemax(const std::string& file, const std::string& text, Report& report);

// CODE V sequences (.seq): commands of up to three letters, separated by `;` and line ends; `!` starts a comment, `&` at a line's end goes on. What is read: RDM LEN
// TIT DIM, EPD FNO NA NAO, WL REF, XAN YAN XOB YOB, SO S SI and RDY CUY THI GLA RMD SLB STO, SPH CON ASP K A to J, CIR, XDE YDE ZDE ADE BDE CDE with DAR REV BEN, PIM PIK. A
// command may name its surface (THI S3 5). ADE and BDE turn left-handed, CDE right-handed.
std::optional<Lens> read_code_v(const std::string& file, const std::string& text, Report& report);

}  // namespace sagitta::lens_file
