// SPDX-License-Identifier: Apache-2.0
// The program's commands: what the command line gives each, and what it does. Each is one file, NAME_command.cc, and
// returns the exit status: 0 done; 1 the input is wrong, or not one ray arrived; 2 wrong usage.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lib/prescription/arithmetic.h"

namespace sagitta::tools {

// Of the commands that read systems.
struct SystemOptions {
  prescription::Settings settings;  // of their parameters
};

// Of the commands that trace a job.
struct JobOptions : SystemOptions {
  std::string folder;
  std::int64_t ray_count = 10000;
  std::string pattern = "hexapolar";
  int thread_count = 0;
  bool json = false;
};

struct TraceOptions : JobOptions {
  std::string system;
  std::vector<std::string> only;  // of "spot", "wavefront"; empty: both
};
int trace_command(const TraceOptions& options);

struct ExplainOptions : SystemOptions {
  std::string system;
  std::vector<std::string> only;  // as of trace
  std::int64_t ray_count = 10000;
  bool json = false;
};
int explain_command(const ExplainOptions& options);

struct VerifyOptions : SystemOptions {
  std::vector<std::string> systems;
  std::int64_t ray_count = 100;
  double position_tolerance_mm = 1e-9, opd_tolerance_waves = 1e-4;
  int thread_count = 0;
  bool json = false;
};
int verify_command(const VerifyOptions& options);

struct RaysOptions : SystemOptions {
  std::string system;
  std::vector<std::string> pupil;  // "px,py"
  std::string fan;                 // "x:21" or "y:21"
  std::string from;                // a CSV file of rays
  std::optional<int> field;
  std::optional<double> wavelength_nm;
};
int rays_command(const RaysOptions& options);

struct RefractionOptions : SystemOptions {
  std::string system;
  double vertex_distance_mm = 0;
  std::string spectrum;  // "400:700:10"; "": the system's wavelengths
  std::string picture;   // FILE.png or FILE.svg; "": none
  int thread_count = 0;
  bool json = false;
};
int refraction_command(const RefractionOptions& options);

struct CompareOptions : JobOptions {
  std::vector<std::string> systems;
  std::string surface, points, format = "xyz", axes = "local";  // variants of one surface, made from points
  std::vector<std::string> as;                                  // "delaunay", "delaunay:linear", "zernike:36"
  std::optional<double> radius_mm, smoothing_um, max_edge_mm;
};
int compare_command(const CompareOptions& options);

struct CheckOptions : SystemOptions {
  std::string system;
};
int check_command(const CheckOptions& options);

struct MaterialsOptions {
  std::vector<std::string> names;     // of media, or files NAME.yml; empty: all that are known are listed
  std::vector<std::string> catalogs;  // AGF files
  std::vector<double> wavelengths_nm;  // empty: the lines of the spectrum
  std::string picture;                // FILE.png or FILE.svg; "": none
  bool json = false;
};
int materials_command(const MaterialsOptions& options);

struct StudyOptions : SystemOptions {
  std::string study;  // a name of systems/studies/, or a file
  std::string system;  // a prescription in its place: how its answers settle
  std::string folder;
  int thread_count = 0;  // of the exact rays, and of variants with threads: 0; of a system's runs
};
int study_command(const StudyOptions& options);

struct ConvertOptions {
  std::string points, file;
  std::string format = "xyz";  // one of prescription::cloud_formats()
  std::string axes = "local";  // or "osa"
};
int convert_command(const ConvertOptions& options);

struct ImportOptions {
  std::string lens, file;
  std::vector<std::string> catalogs;  // AGF files
  bool takes_parts = false;
};
int import_command(const ImportOptions& options);

struct FitOptions {
  std::string points, format = "xyz", axes = "local";
  int terms = 36;
  double radius_mm = 3;
  std::string indexing = "osa";
  std::string fragment;  // FILE.yaml; "": none
  bool json = false;
};
int fit_command(const FitOptions& options);

int schema_command();

}  // namespace sagitta::tools
