// SPDX-License-Identifier: Apache-2.0
// From a lens file of another program to the text of a prescription: read it, find its glasses, solve its image, write it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/prescription/diagnostics.h"

namespace sagitta::lens_file {

struct ImportRequest {
  std::string file;                   // of the other program
  std::string output;                 // where the prescription will stand: media are looked for as they will be from there
  std::vector<std::string> catalogs;  // AGF files in which glasses are looked for, too
  bool takes_parts = false;           // what is not understood is left out, with a warning, in place of an error
};

// A file beside the prescription, which names it.
struct DataFile {
  std::string path, text;
};

struct Imported {
  std::optional<std::string> prescription;  // its text; none where there is an error among the findings
  std::vector<DataFile> files;              // of the data that it names
  prescription::Findings findings;          // in the order of the lines of the file
  int surface_count = 0, left_out_count = 0;
  bool could_be_left_out = false;           // there is an error that takes_parts would make a warning
};

Imported import(const ImportRequest& request);

}  // namespace sagitta::lens_file
