// SPDX-License-Identifier: Apache-2.0
// What commands with output files end with. Each says on standard error what could not be written.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lib/output/chart.h"
#include "lib/output/exr.h"
#include "lib/output/figure.h"

namespace sagitta::tools {

// Makes the folder and those above it, "" being the working folder; true if it is there. `command` is named in the message.
bool make_folder(const char* command, const std::filesystem::path& folder);

// True, with a message, where one of the files to be written, which `option` names, is the input (`what`), by whatever name or link:
// writing it would destroy what cannot be made again.
bool overwrites(const char* command, const std::string& option, const std::filesystem::path& input, const std::vector<std::filesystem::path>& outputs,
                const char* what = "the file of the points");

// True if it was written.
bool written(const char* command, const output::WriteResult& result);

// BASE.exr, the figure as its preview before the parts, and BASE.png. thread_count 0: as many threads as the machine runs.
bool write_image(const char* command, const std::filesystem::path& base, std::vector<output::ExrPart> parts, const output::Figure& figure, int thread_count);

// BASE.svg and BASE.png, of the same drawing.
bool write_chart(const char* command, const std::filesystem::path& base, const output::Chart& chart);

// True where a name given as -o ends in .png or .svg, or is empty; else a message.
bool names_chart(const char* command, const std::string& file);
// One of the two, as the name ends; its folder is made.
bool write_chart_file(const char* command, const std::filesystem::path& file, const output::Chart& chart);

// The figure alone, as a PNG.
bool write_picture(const char* command, const std::filesystem::path& file, const output::Figure& figure);

}  // namespace sagitta::tools
