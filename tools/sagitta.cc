// SPDX-License-Identifier: Apache-2.0
// The program: the command line in, one command out.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <system_error>

#include "lib/numerics/instruction_set.h"
#include "lib/numerics/key.h"
#include "lib/numerics/zernike_basis.h"
#include "lib/prescription/cloud_reader.h"
#include "lib/prescription/yaml_tree.h"
#include "lib/scene/fit_zernike.h"
#include "tools/commands.h"
#include "tools/version.h"

namespace {

using namespace sagitta::tools;

constexpr const char* usage_status = R"(Exit status: 0 done; 1 the input is wrong, not one ray arrived, a variant of `study` failed, or an answer that `verify` looked at is not good; 2 wrong usage.
Results go to standard output or the output folder, messages to standard error.)";

// As CLI::Range, but nan is out of it.
CLI::Validator from_to(double low, double high) {
  const auto fault = [low, high](const std::string& text) {
    double value = 0;
    const bool inside = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
    return inside ? std::string() : fmt::format("{} is not a number from {:g} to {:g}", text, low, high);
  };
  return {fault, fmt::format("FLOAT in [{:g} - {:g}]", low, high)};
}

CLI::IsMember one_of(std::string_view choices) { return CLI::IsMember(sagitta::numerics::words_of(choices)); }

// --set NAME=VALUE, as often as wanted.
CLI::Option* add_settings(CLI::App& command, SystemOptions& options) {
  const auto take = [&options](const std::vector<std::string>& given) {
    for (const std::string& text : given) {
      const std::size_t end = text.find('=');
      const std::string name = text.substr(0, end);
      const bool has_both = end != std::string::npos && end != 0;
      const auto value = has_both ? sagitta::prescription::parse_number(std::string_view(text).substr(end + 1)) : sagitta::prescription::ParsedNumber{};
      if (!value.ok || !std::isfinite(value.value))
        throw CLI::ValidationError("--set", fmt::format("{}: expected NAME=VALUE with a number, such as accommodation_D=4", text));
      for (const auto& before : options.settings)
        if (before.name == name) throw CLI::ValidationError("--set", fmt::format("{} is set twice", name));
      options.settings.push_back({name, value.value});
    }
  };
  return command.add_option_function<std::vector<std::string>>("--set", take, "NAME=VALUE: sets a parameter that the system declares; for several, several times")
      ->type_name("NAME=VALUE")->allow_extra_args(false);
}

void add_only(CLI::App& command, std::vector<std::string>& only) {
  command.add_option("--only", only, "spot, wavefront, or both separated by a comma (default: both)")
      ->delimiter(',')->check(CLI::IsMember({"spot", "wavefront"}));
}

void add_ray_count(CLI::App& command, std::int64_t& ray_count) {
  command.add_option("--rays", ray_count, "rays per field and wavelength, at least (the exact number: 'launched')")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1000000000}))->capture_default_str();
}

void add_job(CLI::App& command, JobOptions& options) {
  add_ray_count(command, options.ray_count);
  command.add_option("--pattern", options.pattern, "hexapolar, square, random:SEED, fan_x or fan_y")->capture_default_str();
  command.add_option("--threads", options.thread_count, "threads (default: as many as the machine runs)")
      ->check(CLI::Range(1, 1024));
  command.add_flag("--json", options.json, "print the summary as JSON in place of the table");
}

void add_trace(CLI::App& app, int& status) {
  static TraceOptions options;
  CLI::App* command = app.add_subcommand("trace", "Trace every field and wavelength: spots, wavefronts, pictures, summary");
  command->add_option("SYSTEM", options.system, "prescription (YAML)")->required();
  command->add_option("-o,--output", options.folder,
                      "folder for spot.exr, spot.png, wavefront.exr, wavefront.png and summary.json")->required();
  add_only(*command, options.only);
  add_job(*command, options);
  add_settings(*command, options);
  command->callback([&status] { status = trace_command(options); });
}

void add_explain(CLI::App& app, int& status) {
  static ExplainOptions options;
  CLI::App* command = app.add_subcommand("explain", "Say what tracing a system costs, surface by surface, and what is left out");
  command->add_option("SYSTEM", options.system, "prescription (YAML)")->required();
  add_only(*command, options.only);
  add_ray_count(*command, options.ray_count);
  command->add_flag("--json", options.json, "print JSON in place of the tables");
  add_settings(*command, options);
  command->callback([&status] { status = explain_command(options); });
}

void add_verify(CLI::App& app, int& status) {
  static VerifyOptions options;
  CLI::App* command = app.add_subcommand("verify", "Trace rays in double and in 50 digits, and say what rounding does to the answers");
  command->add_option("SYSTEM", options.systems, "prescriptions (YAML); of several, a line each")->required();
  command->add_option("--rays", options.ray_count, "rays per field and wavelength, at least; each takes .1 ms a surface")->check(CLI::Range(std::int64_t{1}, std::int64_t{100000}))->capture_default_str();
  command->add_option("--position-mm", options.position_tolerance_mm, "what a place in the image may be off by, mm")->check(from_to(0, 1e300))->capture_default_str();
  command->add_option("--opd-waves", options.opd_tolerance_waves, "what a wavefront may be off by, waves")->check(from_to(0, 1e300))->capture_default_str();
  command->add_option("--threads", options.thread_count, "threads (default: as many as the machine runs)")->check(CLI::Range(1, 1024));
  command->add_flag("--json", options.json, "print JSON in place of the tables");
  add_settings(*command, options);
  command->callback([&status] { status = verify_command(options); });
}

void add_refraction(CLI::App& app, int& status) {
  static RefractionOptions options;
  CLI::App* command = app.add_subcommand("refraction", "The refraction of an eye: sphere, cylinder, axis, M, J0 and J45, four ways");
  command->add_option("SYSTEM", options.system, "prescription (YAML) from air into the eye")->required();
  command->add_option("--vertex-mm", options.vertex_distance_mm, "plane of the refraction, mm before the cornea's vertex: 0 at the cornea, 12 to 14 for spectacles")
      ->check(from_to(-1e3, 1e3))->capture_default_str();
  command->add_option("--spectrum", options.spectrum, "FROM:TO:STEP in nm in place of the system's wavelengths, for the longitudinal chromatic aberration");
  command->add_option("--threads", options.thread_count, "threads (default: as many as the machine runs)")->check(CLI::Range(1, 1024));
  command->add_flag("--json", options.json, "print JSON in place of the table");
  command->add_option("-o,--output", options.picture, "picture of M against wavelength, .png or .svg");
  add_settings(*command, options);
  command->callback([&status] { status = refraction_command(options); });
}

void add_compare(CLI::App& app, int& status) {
  static CompareOptions options;
  CLI::App* command = app.add_subcommand("compare", "Trace several systems by the rays of the first, and show what differs");
  command->add_option("SYSTEM", options.systems, "prescriptions (YAML), 2 to 16; with --surface, one")->required();
  command->add_option("-o,--output", options.folder, "folder for comparison.exr, comparison.png and summary.json")->required();
  auto* surface = command->add_option("--surface", options.surface, "name of a surface of SYSTEM that is made from points in several ways");
  auto* with = command->add_option("--with", options.points, "file of the points");
  auto* as = command->add_option("--as", options.as,
      "the ways, separated by commas: delaunay (c1), delaunay:INTERPOLATION, zernike:TERMS; the first is the reference")->delimiter(',');
  auto* format = command->add_option("--format", options.format, "format of the points")
      ->check(one_of(sagitta::prescription::cloud_formats()))->capture_default_str();
  auto* axes = command->add_option("--axes", options.axes, "osa: x of the points is to the examiner's right")
      ->check(one_of("local|osa"))->capture_default_str();
  auto* radius = command->add_option("--radius-mm", options.radius_mm, "circle of the Zernike fits (default: what the beam needs)")
      ->check(from_to(1e-6, 1e6));
  auto* smoothing = command->add_option("--smoothing-um", options.smoothing_um, "rms by which smoothed heights may leave the points (default: that of the surface's own points, or 0)")
      ->check(from_to(0, 1e9));
  auto* edge = command->add_option("--max-edge-mm", options.max_edge_mm, "facets with a longer edge are holes (default: that of the surface's own points, or none)")
      ->check(from_to(1e-9, 1e9));
  surface->needs(with)->needs(as);
  for (CLI::Option* option : {with, as, format, axes, radius, smoothing, edge}) option->needs(surface);
  add_job(*command, options);
  add_settings(*command, options);
  command->callback([&status] { status = compare_command(options); });
}

void add_rays(CLI::App& app, int& status) {
  static RaysOptions options;
  CLI::App* command = app.add_subcommand("rays", "Real rays, surface by surface, as CSV");
  command->add_option("SYSTEM", options.system, "prescription (YAML)")->required();
  auto* pupil = command->add_option("--pupil", options.pupil, "pupil points PX,PY in the unit disc (default: 0,0, the chief ray)");
  auto* fan = command->add_option("--fan", options.fan, "x:21 or y:21, so many rays evenly across the pupil");
  auto* from = command->add_option("--from", options.from,
      "CSV file of given rays: x_mm,y_mm,z_mm,l,m,n[,wavelength_nm], global frame, direction cosines");
  auto* field = command->add_option("--field", options.field, "number of the field, from 0 (default: all)");
  command->add_option("--wavelength", options.wavelength_nm, "wavelength in nm (default: all of the system; with --from, the primary one)")
      ->check(from_to(1e-3, 1e12));
  pupil->excludes(from);
  fan->excludes(from)->excludes(pupil);
  field->excludes(from);
  add_settings(*command, options);
  command->callback([&status] { status = rays_command(options); });
}

void add_check(CLI::App& app, int& status) {
  static CheckOptions options;
  CLI::App* command = app.add_subcommand("check", "Read and check a prescription and every file it names");
  command->add_option("SYSTEM", options.system, "prescription (YAML)")->required();
  add_settings(*command, options);
  command->callback([&status] { status = check_command(options); });
}

void add_materials(CLI::App& app, int& status) {
  static MaterialsOptions options;
  CLI::App* command = app.add_subcommand("materials", "List the media that a prescription can name; evaluate and plot them");
  command->add_option("NAME", options.names, "media, or files in refractiveindex.info's format (.yml); none: all are listed");
  command->add_option("--at", options.wavelengths_nm, "wavelengths in nm, separated by commas (default: lines of the spectrum in the medium's range)")
      ->delimiter(',')->allow_extra_args(false)->check(from_to(1e-6, 1e12));
  command->add_option("--catalog", options.catalogs, "glass catalogue (AGF) in which names are looked up as well; may be repeated")->allow_extra_args(false);
  command->add_option("-o,--output", options.picture, "picture of index against wavelength, .png or .svg");
  command->add_flag("--json", options.json, "print JSON in place of the tables");
  command->callback([&status] { status = materials_command(options); });
}

void add_convert(CLI::App& app, int& status) {
  static ConvertOptions options;
  CLI::App* command = app.add_subcommand("convert", "Write points in the compact form (binary PLY), which reads at the speed of the disk");
  command->add_option("POINTS", options.points, "file of the points")->required();
  command->add_option("-o,--output", options.file, "PLY file to write, for `format: ply` of a prescription")->required();
  command->add_option("--format", options.format, "format of POINTS")->check(one_of(sagitta::prescription::cloud_formats()))->capture_default_str();
  command->add_option("--axes", options.axes, "frame of POINTS: local, the surface's own, or osa, x to the examiner's right")
      ->check(one_of("local|osa"))->capture_default_str();
  command->callback([&status] { status = convert_command(options); });
}

void add_import(CLI::App& app, int& status) {
  static ImportOptions options;
  CLI::App* command = app.add_subcommand("import", "Make a prescription of a lens file of Zemax OpticStudio (.zmx, sequential) or CODE V (.seq)");
  command->add_option("LENS", options.lens, "LENS.zmx or LENS.seq")->required();
  command->add_option("-o,--output", options.file, "LENS.yaml")->required();
  command->add_option("--catalog", options.catalogs, "glass catalogue (AGF) in which glasses are looked for, too; the prescription names it; may be repeated")->type_name("FILE.agf")->allow_extra_args(false);
  command->add_flag("--partial", options.takes_parts, "leave out what is not understood: warnings in place of errors, and a list in the head comment");
  command->callback([&status] { status = import_command(options); });
}

void add_study(CLI::App& app, int& status) {
  static StudyOptions options;
  CLI::App* command = app.add_subcommand("study", "Measure error against run time: every variant of a study, as tables, plots and a page");
  auto* study = command->add_option("STUDY", options.study, "study (YAML), or the name of one of systems/studies/");
  auto* system = command->add_option("--system", options.system, "in its place a prescription (YAML): how its spots and wavefronts settle with more rays, and with every interpolation of its points")->excludes(study);
  command->add_option("-o,--output", options.folder, "folder for study.csv, study.json, study.md and the plots; finished rows of the same study there are kept (not with --system)")->required();
  command->add_option("--threads", options.thread_count, "threads for the exact rays, for variants with threads: 0, and with --system (default: as many as the machine runs)")
      ->check(CLI::Range(1, 1024));
  add_settings(*command, options)->needs(system);
  command->callback([&status] {
    if (options.study.empty() && options.system.empty()) throw CLI::RequiredError("STUDY or --system");
    status = study_command(options);
  });
}

void add_fit(CLI::App& app, int& status) {
  static FitOptions options;
  CLI::App* command = app.add_subcommand("fit", "Fit measured points: best sphere, best conic, a Zernike surface for a prescription");
  command->add_option("POINTS", options.points, "file of the points")->required();
  command->add_option("--terms", options.terms, "Zernike terms, from the indexing's first")->check(CLI::Range(1, sagitta::scene::most_zernike_terms({})))->capture_default_str();
  command->add_option("--radius-mm", options.radius_mm, "normalisation radius; points within it are fitted")
      ->check(from_to(1e-6, 1e9))->capture_default_str();
  command->add_option("--indexing", options.indexing, "osa, noll or fringe")
      ->check(one_of(sagitta::numerics::zernike_indexings))->capture_default_str();
  command->add_option("--format", options.format, "format of the points")
      ->check(one_of(sagitta::prescription::cloud_formats()))->capture_default_str();
  command->add_option("--axes", options.axes, "local, or osa: x to the examiner's right (xyz)")
      ->check(one_of("local|osa"))->capture_default_str();
  command->add_option("-o,--output", options.fragment, "FILE.yaml for the shape; FILE.exr and FILE.png, the residual map, beside it");
  command->add_flag("--json", options.json, "print the fit as JSON in place of the tables");
  command->callback([&status] { status = fit_command(options); });
}

void add_schema(CLI::App& app, int& status) {
  app.add_subcommand("schema", "Print the JSON Schema of a prescription, for editors that complete and check while you type")
      ->callback([&status] { status = schema_command(); });
}

// The same few megabytes are wanted again and again, by blocks of rays, maps and pictures. Pages that were given back to the system
// would have to be cleared anew, at a microsecond each.
void keep_freed_memory() {
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 128 << 20);
  mallopt(M_TOP_PAD, 1 << 20);
#endif
}

// A misspelt limit would be none.
bool knows_instruction_set(std::string_view name) {
  const auto& names = sagitta::numerics::instruction_set_names;
  return name.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

// What --help and --version print is an exception of CLI11's, too.
int exit_status(CLI::App& app, int argc, char** argv, const int& status) try {
  app.parse(argc, argv);
  return status;
} catch (const CLI::ParseError& fault) {
  return app.exit(fault) == 0 ? 0 : 2;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit is an error to report, not a reason to die
  keep_freed_memory();
  if (const char* name = std::getenv("SAGITTA_ISA"); name && !knows_instruction_set(name)) {
    fmt::print(stderr, "sagitta: SAGITTA_ISA is '{}'\n  hint: it may be {}\n", name, fmt::join(sagitta::numerics::instruction_set_names, ", "));
    return 2;
  }
  CLI::App app{"Sagitta: sequential ray tracing of eyes and lenses, from a text file to spots and wavefronts.", "sagitta"};
  app.set_version_flag("--version", about_this_build, "Print what this build is: version, compiler, libraries, licence");
  app.footer(usage_status);
  app.require_subcommand(1);
  int status = 0;
  add_trace(app, status);
  add_explain(app, status);
  add_verify(app, status);
  add_refraction(app, status);
  add_compare(app, status);
  add_rays(app, status);
  add_check(app, status);
  add_materials(app, status);
  add_fit(app, status);
  add_convert(app, status);
  add_import(app, status);
  add_study(app, status);
  add_schema(app, status);
  try {
    status = exit_status(app, argc, argv, status);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw std::system_error(errno, std::generic_category());
  } catch (const std::bad_alloc&) {
    std::fputs("sagitta: not enough memory: ask for fewer fields, wavelengths or points in one run\n", stderr);
    return 1;
  } catch (const std::system_error& fault) {
    std::fprintf(stderr, "sagitta: standard output cannot be written: %s\n", fault.code().message().c_str());
    return 1;
  }
  return status;
}
