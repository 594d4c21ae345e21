// SPDX-License-Identifier: Apache-2.0
// What is fuzzed: the readers, and the step from a prescription to rays. Each target takes the bytes of a file, hands them to the
// public entry point, and says what is wrong with the outcome; "" where nothing is. The fuzzer calls it with what it makes up
// (fuzz.cc), a test with what was kept (replay_test.cc).
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

#include "lib/analysis/job.h"
#include "lib/lens_file/import.h"
#include "lib/prescription/agf_reader.h"
#include "lib/prescription/cloud_reader.h"
#include "lib/prescription/grid_reader.h"
#include "lib/prescription/material_reader.h"
#include "lib/prescription/reader.h"
#include "lib/prescription/study_reader.h"
#include "lib/prescription/utf8.h"
#include "lib/scene/compile.h"
#include "lib/trace/trace.h"
#include "tests/prescription/support.h"

namespace sagitta::fuzz {

using Folder = prescription::test::TemporaryFolder;

// A spherical cap of radius 8, as rings of 6 points in all formats, and what else a prescription or a study may name.
inline void put_named_files(const Folder& folder) {
  std::string xyz = "0 0 0\n", polar = "ring,meridian,radius,z\n", radii, heights;
  for (int ring = 1; ring <= 4; ++ring)
    for (int i = 0; i < 6; ++i) {
      const double r = ring, angle = i * std::acos(-1) / 3, z = 8 - std::sqrt(64 - r * r);
      xyz += fmt::format("{} {} {}\n", r * std::cos(angle), r * std::sin(angle), z);
      polar += fmt::format("{},{},{},{}\n", ring, 60 * i, r, -z);
      radii += fmt::format("{}\n", r);
      heights += fmt::format("{:.0f},{:06.0f}\n", std::floor(z), 1e6 * (z - std::floor(z)));
    }
  std::string grid = "5 5 1.0 1.0 0 0 0\n";
  for (int k = 0; k < 25; ++k) grid += fmt::format("{}\n", 8 - std::sqrt(64 - (k % 5 - 2) * (k % 5 - 2) - (k / 5 - 2) * (k / 5 - 2)));
  folder.write("points.dat", grid);
  folder.write("points.xyz", xyz);
  folder.write("points.polar", polar);
  folder.write("points.cso", "Dato misurato : Elevazioni\nAnelli : 4\nSemimeridiani : 6\n---\n" + radii + heights);
  folder.write("points.ply", "ply\nformat ascii 1.0\nelement vertex 25\nproperty double x\nproperty double y\nproperty double z\nend_header\n" + xyz);
  folder.write("glass.yml", "DATA:\n  - {type: formula 2, wavelength_range: 0.3 2.5, coefficients: 0 1.04 0.006 0.23 0.02 1.01 103.6}\n");
  folder.write("base.yaml", "sagitta: 1\nwavelengths_nm: [550]\naperture: {entrance_pupil_diameter_mm: 2}\nsurfaces:\n"
                            "  - {name: front, stop: true, conic: {radius_mm: 8}, thickness_mm: 3, medium: {index: 1.5}}\n  - {name: image}\n");
}

// Messages of a reader: bounded, in plain text, and there where nothing was read.
inline std::string wrong_with(const prescription::Findings& findings, bool is_read) {
  if (is_read == findings.has_errors()) return is_read ? "read in spite of errors" : "not read, without an error";
  if (findings.error_count() > 101) return fmt::format("{} errors", findings.error_count());
  for (const prescription::Finding& finding : findings.all()) {
    const std::string text = format(finding);
    if (finding.place.line < 0 || finding.place.column < 0) return "a place before the file: " + text;
    if (finding.what.size() > 4000 || finding.hint.size() > 4000) return "an endless message: " + text;
    for (std::string_view rest = text; !rest.empty();) {
      const std::size_t length = prescription::utf8_length(rest);
      if (length == 0 || (prescription::starts_with_control(rest) && rest[0] != '\n')) return "a message with bytes that are no text: " + text;
      rest.remove_prefix(length);
    }
  }
  return {};
}

inline bool all_finite(const numerics::Vec3<double>& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

inline std::string wrong_with(const prescription::PointCloud& cloud) {
  if (cloud.points.empty()) return "a cloud without points";
  if (!cloud.lines.empty() && cloud.lines.size() != cloud.points.size()) return "lines and points do not match";
  for (const auto& p : cloud.points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || std::isinf(p.z)) return fmt::format("a point ({}, {}, {})", p.x, p.y, p.z);
  return {};
}

inline std::string wrong_with(const prescription::SagGrid& grid) {
  if (grid.count_x < 5 || grid.count_y < 5 || grid.nodes.size() != static_cast<std::size_t>(grid.count_x) * static_cast<std::size_t>(grid.count_y)) return "a grid of other nodes than it has";
  if (!(grid.spacing_x > 0 && grid.spacing_y > 0 && std::isfinite(grid.spacing_x) && std::isfinite(grid.spacing_y) && std::isfinite(grid.first_x) && std::isfinite(grid.first_y)))
    return "a grid nowhere";
  for (const auto& node : grid.nodes)
    if (std::isinf(node.z) || !std::isfinite(node.dz_dx) || !std::isfinite(node.dz_dy) || !std::isfinite(node.d2z_dxdy)) return "a node with numbers that are none";
  return {};
}

inline std::string wrong_with(const prescription::Model& model) {
  if (model.surfaces.empty() || model.wavelengths_nm.empty() || model.fields.points.empty()) return "a model without surfaces, wavelengths or fields";
  const auto index_is_good = [&](const medium::Medium& medium) {
    return std::all_of(model.wavelengths_nm.begin(), model.wavelengths_nm.end(), [&](double nm) { return medium.covers(nm / 1000) && medium.index(nm / 1000) > 0; });
  };
  if (!index_is_good(model.object.medium)) return "no index before the first surface";
  for (const auto& surface : model.surfaces) {
    if (surface.medium && !index_is_good(*surface.medium)) return "no index behind " + surface.name;
    if (!std::isfinite(surface.thickness_mm) || !all_finite(surface.decenter_mm) || !all_finite(surface.tilt_deg)) return "a surface nowhere";
    if (surface.shape.cloud)
      if (const std::string wrong = wrong_with(*surface.shape.cloud); !wrong.empty()) return wrong;
    if (surface.shape.grid)
      if (const std::string wrong = wrong_with(*surface.shape.grid); !wrong.empty()) return wrong;
  }
  return {};
}

inline std::string fuzz_prescription(const Folder& folder, std::string_view bytes) {
  const auto read = prescription::read_prescription(folder.write("system.yaml", std::string(bytes)));
  const std::string wrong = wrong_with(read.findings, read.model.has_value());
  return wrong.empty() && read.model ? wrong_with(*read.model) : wrong;
}

inline std::string fuzz_study(const Folder& folder, std::string_view bytes) {
  const auto read = prescription::read_study(folder.write("study.yaml", std::string(bytes)));
  const std::string wrong = wrong_with(read.findings, read.study.has_value());
  if (!wrong.empty() || !read.study) return wrong;
  const prescription::StudyFile& study = *read.study;
  if (study.variants.empty() || study.variants.size() > prescription::most_variants) return fmt::format("{} variants", study.variants.size());
  if (study.surface_number < 1 || static_cast<std::size_t>(study.surface_number) > study.system.surfaces.size()) return "no surface under study";
  return study.field < study.system.fields.points.size() ? "" : "no such field";
}

inline std::string wrong_with(const medium::Medium& medium) {
  for (int i = 0; i <= 16; ++i) {
    const double share = i / 16.0, um = share * medium.longest_um + (1 - share) * medium.shortest_um;
    const double index = medium.index(um);
    const bool is_pole = std::isnan(index) && i > 0 && i < 16;  // one that is narrower than the reader looks
    if (!is_pole && !(index >= medium::least_index && index <= medium::largest_index)) return fmt::format("the index {} at {} um", index, um);
  }
  return {};
}

inline std::string fuzz_material(const Folder& folder, std::string_view bytes) {
  prescription::Findings findings;
  const auto medium = prescription::read_material(folder.write("material.yml", std::string(bytes)), findings);
  const std::string wrong = wrong_with(findings, medium.has_value());
  return wrong.empty() && medium ? wrong_with(*medium) : wrong;
}

inline std::string fuzz_catalog(const Folder& folder, std::string_view bytes) {
  prescription::Findings findings;
  const auto catalog = prescription::read_agf(folder.write("catalog.agf", std::string(bytes)), findings);
  const std::string wrong = wrong_with(findings, catalog.has_value());
  if (!wrong.empty() || !catalog) return wrong;
  for (std::size_t i = 0; i < std::min<std::size_t>(catalog->glasses.size(), 20); ++i) {
    prescription::Findings of_glass;
    const prescription::AgfGlass& glass = catalog->glasses[i];
    const auto material = prescription::read_glass(*catalog, glass, of_glass);
    if (const std::string wrong_glass = wrong_with(of_glass, material.has_value()); !wrong_glass.empty()) return wrong_glass;
    if (catalog->find(glass.name) != &glass) return "a glass that is not found by its name";
    if (const std::string wrong_index = material ? wrong_with(*material) : ""; !wrong_index.empty()) return wrong_index;
  }
  return {};
}

// As either format, whole or in part: what is written can be read.
inline std::string fuzz_lens_file(const Folder& folder, std::string_view bytes) {
  for (const char* name : {"lens.zmx", "lens.seq"}) {
    const std::string file = folder.write(name, std::string(bytes));
    for (const bool takes_parts : {false, true}) {
      const lens_file::Imported imported = lens_file::import({file, folder.path() + "/imported.yaml", {}, takes_parts});
      if (const std::string wrong = wrong_with(imported.findings, imported.prescription.has_value()); !wrong.empty()) return wrong;
      if (!imported.prescription) continue;
      for (const lens_file::DataFile& one : imported.files) folder.write(std::filesystem::path(one.path).filename().string(), one.text);
      const auto read = prescription::read_prescription(folder.write("imported.yaml", *imported.prescription));
      if (!read.model) return "a prescription that cannot be read: " + format(read.findings.all().front());
      if (const std::string wrong = wrong_with(*read.model); !wrong.empty()) return wrong;
    }
  }
  return {};
}

template <const char* format>
std::string fuzz_cloud(const Folder& folder, std::string_view bytes) {
  prescription::Findings findings;
  const auto cloud = prescription::read_cloud({folder.write("cloud", std::string(bytes)), format}, findings);
  const std::string wrong = wrong_with(findings, cloud != nullptr);
  return wrong.empty() && cloud ? wrong_with(*cloud) : wrong;
}
inline constexpr char xyz[] = "xyz", cso[] = "cso", polar[] = "polar", ply[] = "ply";

// The same bytes in every format.
inline std::string fuzz_grid(const Folder& folder, std::string_view bytes) {
  const std::string file = folder.write("grid", std::string(bytes));
  for (const char* format : {"zemax", "xyz"}) {
    prescription::Findings findings;
    const auto grid = prescription::read_grid({file, format}, findings);
    if (const std::string wrong = wrong_with(findings, grid != nullptr); !wrong.empty()) return wrong;
    if (const std::string wrong = grid ? wrong_with(*grid) : ""; !wrong.empty()) return wrong;
  }
  return {};
}

// Every ray ends with a status and with finite numbers, lost or not.
inline std::string wrong_with(const trace::RayBatch& rays, int surface_count) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const int status = rays.ended[i] % 8, at = rays.ended_at(i);
    const auto d = rays.direction(i);
    const bool is_ended = status != 0;
    if (status < 0 || status >= surface::status_count || is_ended != (at != 0) || at < 0 || at > surface_count)
      return fmt::format("ray {} ended as {}", i, rays.ended[i]);
    if (!all_finite(rays.position(i)) || !all_finite(d) || !std::isfinite(rays.optical_path_length(i)))
      return fmt::format("ray {}, {} at {}, has numbers that are none", i, surface::status_names[static_cast<std::size_t>(status)], at);
    if (!(std::abs(norm(d) - 1) <= 1e-9)) return fmt::format("ray {} has a direction of length {}", i, norm(d));
  }
  return {};
}

// A few rays of a few fields and wavelengths; the bits that a compilation of the whole clouds gives are those that one of
// the needed part gives.
inline std::string wrong_with_rays(const scene::CompileResult& whole, const scene::CompileResult* part) {
  const scene::Scene& scene = *whole.scene;
  const auto pupil = trace::pupil_points({}, 19);
  for (std::size_t field = 0; field < std::min<std::size_t>(scene.fields.size(), 3); ++field)
    for (std::size_t w = 0; w < std::min<std::size_t>(scene.wavelengths.size(), 2); ++w) {
      const trace::RayBatch launched = trace::launch(scene, scene.fields[field], scene.wavelengths[w].index.front(), pupil);
      if (const std::string wrong = wrong_with(launched, 0); !wrong.empty()) return "at the start: " + wrong;
      trace::RayBatch rays = launched;
      trace::trace(scene, scene.wavelengths[w], rays);
      if (const std::string wrong = wrong_with(rays, scene.surface_count()); !wrong.empty()) return wrong;
      if (trace::count_statuses(rays).total() != static_cast<std::int64_t>(launched.size())) return "rays were lost";
      if (!part) continue;
      trace::RayBatch again = launched;
      trace::trace(*part->scene, part->scene->wavelengths[w], again);
      for (std::size_t i = 0; i < rays.size(); ++i)
        if (again.status(i) != trace::Status::outside_data && (again.ended[i] != rays.ended[i] || again.position(i) != rays.position(i)))
          return fmt::format("ray {} depends on what else was triangulated", i);
    }
  return {};
}

// The main job in small: whatever arrives, and however few, its figures are numbers, or are left out.
inline std::string wrong_with_job(const scene::Scene& scene) {
  analysis::JobRequest request;
  request.ray_count = 19, request.spot_image_size = 8, request.thread_count = 1;
  request.wavefront.size = 8, request.wavefront.zernike_terms = 6;
  for (const analysis::JobResult& result : analysis::run_job(scene, request)) {
    if (result.rays.total() != 19) return fmt::format("a job of 19 rays counts {}", result.rays.total());
    const bool any_arrived = result.rays[trace::Status::ok] > 0;
    if (any_arrived && !(std::isfinite(result.spot->rms_radius) && std::isfinite(result.spot->geometric_radius) && std::isfinite(result.spot->centroid_x)))
      return "a spot without a size";
    const auto& wavefront = result.wavefront->wavefront;
    if (!wavefront && result.wavefront->reason.empty()) return "no wavefront, without a reason";
    if (wavefront && !(std::isfinite(wavefront->rms_waves) && std::isfinite(wavefront->peak_to_valley_waves))) return "a wavefront without an rms";
    if (wavefront && wavefront->zernike)
      for (const double coefficient : wavefront->zernike->coefficients)
        if (!std::isfinite(coefficient)) return "a Zernike coefficient that is no number";
  }
  return {};
}

// The prescription and, behind a line "%%", its cloud points.xyz. The compilation of large clouds and of many terms takes its time, which is no
// finding here.
inline std::string fuzz_compile(const Folder& folder, std::string_view bytes) {
  constexpr std::string_view mark = "\n%%\n";
  const std::size_t end = bytes.find(mark);
  if (end != std::string_view::npos) folder.write("cloud.xyz", std::string(bytes.substr(end + mark.size())));
  const auto read = prescription::read_prescription(folder.write("system.yaml", std::string(bytes.substr(0, end))));
  if (!read.model || read.model->surfaces.size() > 50) return {};
  for (const auto& surface : read.model->surfaces)
    if ((surface.shape.cloud && surface.shape.cloud->points.size() > 500) || (surface.shape.grid && surface.shape.grid->nodes.size() > 5000)) return {};
  const scene::CompileResult whole = scene::compile(*read.model);
  if (const std::string wrong = wrong_with(in_order(whole.findings, read.model->documents), whole.scene.has_value()); !wrong.empty() || !whole.scene) return wrong;
  const bool has_clouds = std::any_of(read.model->surfaces.begin(), read.model->surfaces.end(), [](const auto& one) { return one.shape.cloud != nullptr; });
  if (whole.scene->fields.size() * whole.scene->wavelengths.size() <= 4)
    if (const std::string wrong = wrong_with_job(*whole.scene); !wrong.empty()) return wrong;
  if (!has_clouds) return wrong_with_rays(whole, nullptr);
  const scene::CompileResult part = scene::compile(*read.model, analysis::beam_of_job());
  if (!part.scene) return "what compiles whole does not compile in part";
  return wrong_with_rays(whole, &part);
}

struct Target {
  std::string_view name;
  std::string (*run)(const Folder& folder, std::string_view bytes);
};
inline constexpr std::array targets{Target{"prescription", fuzz_prescription}, Target{"study", fuzz_study}, Target{"material", fuzz_material}, Target{"catalog", fuzz_catalog}, Target{"lens_file", fuzz_lens_file},
                                    Target{"xyz", fuzz_cloud<xyz>}, Target{"cso", fuzz_cloud<cso>}, Target{"polar", fuzz_cloud<polar>},
                                    Target{"ply", fuzz_cloud<ply>}, Target{"grid", fuzz_grid}, Target{"compile", fuzz_compile}};

}  // namespace sagitta::fuzz
