// SPDX-License-Identifier: Apache-2.0
// Lens files as tests write them: the operands and encodings of those that other programs write.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "lib/lens_file/import.h"
#include "tests/prescription/support.h"

namespace sagitta::lens_file::test {

// The head of a Zemax file as OpticStudio writes it, with an aperture, fields and wavelengths of `system`; the surfaces are lines behind it.
inline std::string zemax(const std::string& system, const std::string& surfaces) {
  return "VERS 140730 201 26155\nMODE SEQ\nNAME Test lens\nPFIL 0 0 0\nLANG 0\nUNIT MM X W X CM MR CPMM\nENVD 2.0E+1 1 0\nGFAC 0 0\nGCAT SCHOTT MISC\nRAIM 0 0 1 1 0 1 0 0 0\n"
         "PUSH 0 0 0 0 0 0\nSDMA 0 1 0\nROPD 2\nPICB 1\n" + system + "FWGN 1 1 1 1 1 1 1 1 1 1 1 1\nVDXN 0 0 0 0 0 0 0 0 0 0 0 0\nVCYN 0 0 0 0 0 0 0 0 0 0 0 0\nPWAV 1\n" + surfaces +
         "TOL TOFF   0   0              0              0   0 0 0\nMNUM 1 1\nMOFF   0   1 \"\" 0 0 0 1 1 0 0.0 \"\"\n";
}
inline const std::string on_axis_at_543 = "ENPD 4.0E+0\nFTYP 0 0 1 1 0 0 0\nXFLN 0 0 0 0 0 0 0 0 0 0 0 0\nYFLN 0 0 0 0 0 0 0 0 0 0 0 0\nWAVM 1 5.43E-1 1\nWAVM 2 5.5E-1 1\nWAVM 3 5.5E-1 1\n";

inline std::string zemax_surface(int number, const std::string& lines) {
  std::string text = "SURF " + std::to_string(number) + "\n";
  for (std::size_t begin = 0; begin < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', begin), lines.size());
    text += "  " + lines.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  return text + "  HIDE 0 0 0 0 0 0 0 0 0 0\n  MIRR 2 0\n  SLAB 1\n  POPS 0 0 0 0 0 0 0 0 1 1 1 1 0 0 0 0\n";
}
// An object at infinity, a stop, the surfaces given, from number 2 on, and an image.
template <class... Lines>
std::string zemax_with(const Lines&... lines) {
  int number = 2;
  std::string text = zemax_surface(0, "TYPE STANDARD\nCURV 0.0 0 0 0 0 \"\"\nDISZ INFINITY\nDIAM 0 0 0 0 1 \"\"") + zemax_surface(1, "STOP\nTYPE STANDARD\nCURV 0.0\nDISZ 1");
  ((text += zemax_surface(number++, lines)), ...);
  return zemax(on_axis_at_543, text + zemax_surface(number, "TYPE STANDARD\nCURV 0.0\nDISZ 0"));
}

inline std::string in_utf_16(const std::string& ascii, bool low_end_first) {
  std::string bytes = low_end_first ? "\xFF\xFE" : "\xFE\xFF";
  for (const char c : ascii) low_end_first ? (bytes += c, bytes += '\0') : (bytes += '\0', bytes += c);
  return bytes;
}

struct Outcome {
  std::string prescription;  // "" where there is none
  std::string messages;      // with the base name of the file
  int left_out_count = 0;
};
inline Outcome import_text(const std::string& name, const std::string& text, bool takes_parts = false) {
  const prescription::test::TemporaryFolder folder;
  const Imported imported = import({folder.write(name, text), folder.path() + "/out.yaml", {}, takes_parts});
  Outcome run{imported.prescription.value_or(""), {}, imported.left_out_count};
  for (prescription::Finding finding : imported.findings.all()) {
    finding.place.file = std::filesystem::path(finding.place.file).filename();
    run.messages += format(finding) + "\n";
  }
  for (const DataFile& file : imported.files) folder.write(std::filesystem::path(file.path).filename().string(), file.text);
  if (imported.prescription) {
    const auto read = prescription::read_prescription(folder.write("out.yaml", *imported.prescription));
    EXPECT_TRUE(read.model.has_value()) << *imported.prescription << prescription::test::text_of(read.findings);
  }
  return run;
}
// The coefficient of an index; NaN where there is none.
inline double at(const prescription::Surface& surface, const char* key, int index) {
  for (const auto& [i, value] : surface.shape.parameters.list(key))
    if (i == index) return value;
  return std::numeric_limits<double>::quiet_NaN();
}
// The model that comes of a file without a complaint.
inline prescription::Model model_of(const std::string& name, const std::string& text) {
  const Outcome run = import_text(name, text);
  EXPECT_NE(run.prescription, "") << run.messages;
  auto read = prescription::test::read_text(run.prescription);
  return read.model ? *read.model : prescription::Model{};
}

}  // namespace sagitta::lens_file::test
