// SPDX-License-Identifier: Apache-2.0
// The keys of a prescription, version 1: one table a mapping. Unknown and missing keys, legal ranges and hints all come
// from here; the keys of the shapes stand with the shapes (lib/surface/).
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "lib/gradient_index/leap.h"
#include "lib/medium/medium.h"
#include "lib/numerics/key.h"

namespace sagitta::prescription {

using KeyTable = std::span<const numerics::Key>;

inline constexpr int prescription_version = 1;

// Every surface has an index at every wavelength.
inline constexpr int most_surfaces = 10'000, most_wavelengths = 1000, most_catalogs = 16;

// Those of medium.h, in nm.
inline constexpr numerics::Range wavelengths_nm_range{1e-6, 1e12};

inline constexpr std::array system_keys{
    numerics::Key{.name = "sagitta",
                  .meaning = "version of the format, 1",
                  .required = true,
                  .range = {prescription_version, prescription_version}},
    numerics::Key{.name = "extends",
                  .kind = numerics::ValueKind::file,
                  .meaning = "another prescription, whose keys those of this file replace"},
    numerics::Key{.name = "parameters",
                  .kind = numerics::ValueKind::mapping,
                  .meaning = "numbers by name, for arithmetic in values: = 12 - 0.4 * NAME"},
    numerics::Key{.name = "name", .kind = numerics::ValueKind::text, .meaning = "name of the system"},
    numerics::Key{.name = "source", .kind = numerics::ValueKind::text, .meaning = "where the system is published"},
    numerics::Key{.name = "catalogs",
                  .kind = numerics::ValueKind::list,
                  .meaning = "glass catalogues (AGF files) in which names of media are looked up, in a list"},
    numerics::Key{.name = "eye",
                  .kind = numerics::ValueKind::text,
                  .meaning = "of an eye, which one: its results are then said in the frame of the examiner (OSA)",
                  .choices = "right|left"},
    numerics::Key{.name = "wavelengths_nm",
                  .kind = numerics::ValueKind::list,
                  .meaning = "the wavelengths, in a list",
                  .required = true,
                  .range = wavelengths_nm_range},
    numerics::Key{.name = "primary_nm",
                  .meaning = "wavelength of the first order; the first of wavelengths_nm unless given",
                  .range = wavelengths_nm_range},
    numerics::Key{.name = "aperture",
                  .kind = numerics::ValueKind::mapping,
                  .meaning = "size of the launched beam",
                  .required = true},
    numerics::Key{.name = "fields",
                  .kind = numerics::ValueKind::mapping,
                  .meaning = "where the light comes from; one field on the axis unless given"},
    numerics::Key{.name = "object",
                  .kind = numerics::ValueKind::mapping,
                  .meaning = "what stands before surface 1; air up to infinity unless given"},
    numerics::Key{.name = "tolerance_mm",
                  .meaning = "what one step of a ray in a gradient-index medium may be off by, in place and optical path",
                  .range = {.low = 1e-15, .high = 1e-3, .reason = "below, rounding is larger; above, the ray is not followed"},
                  .fallback = gradient_index::default_tolerance_mm},
    numerics::Key{.name = "surfaces",
                  .kind = numerics::ValueKind::list,
                  .meaning = "the surfaces in the order of the light; the last one is the image surface",
                  .required = true}};

// Exactly one of them, in the order of ApertureKind.
inline constexpr std::array aperture_keys{
    numerics::Key{.name = "entrance_pupil_diameter_mm",
                  .meaning = "diameter of the paraxial entrance pupil",
                  .range = numerics::positive},
    numerics::Key{.name = "stop_diameter_mm", .meaning = "diameter of the stop", .range = numerics::positive},
    numerics::Key{.name = "image_f_number",
                  .meaning = "focal length over entrance pupil diameter; infinite object only",
                  .range = numerics::positive},
    numerics::Key{.name = "object_na",
                  .meaning = "index times sine of the half angle at the object; finite object only",
                  .range = numerics::positive}};

// Beside one of them.
inline constexpr std::array aim_keys{
    numerics::Key{.name = "aim",
                  .kind = numerics::ValueKind::text,
                  .meaning = "what pupil points stand for: the paraxial entrance pupil, or the stop, at which every ray is then aimed",
                  .choices = "entrance_pupil|stop"}};
inline constexpr auto aperture_section_keys = [] {
  std::array<numerics::Key, aperture_keys.size() + aim_keys.size()> all;
  std::copy(aim_keys.begin(), aim_keys.end(), std::copy(aperture_keys.begin(), aperture_keys.end(), all.begin()));
  return all;
}();

// Exactly one of them, in the order of FieldKind; a list of pairs [x, y].
inline constexpr std::array field_keys{
    numerics::Key{.name = "angles_deg",
                  .kind = numerics::ValueKind::list,
                  .meaning = "pairs [x, y] of angles; positive travels toward +x or +y",
                  .range = {-90, 90, true}},
    numerics::Key{.name = "object_heights_mm",
                  .kind = numerics::ValueKind::list,
                  .meaning = "pairs [x, y] of points in the object plane; finite object only"},
    numerics::Key{.name = "visual_angles_deg",
                  .kind = numerics::ValueKind::list,
                  .meaning = "pairs [x, y] of angles as the front nodal point sees them",
                  .range = {-90, 90, true}},
    numerics::Key{.name = "paraxial_image_heights_mm",
                  .kind = numerics::ValueKind::list,
                  .meaning = "pairs [x, y] of the fields' paraxial images"},
    numerics::Key{.name = "real_image_heights_mm",
                  .kind = numerics::ValueKind::list,
                  .meaning = "pairs [x, y] on the image surface that the fields' chief rays meet"}};

inline constexpr std::array object_keys{
    numerics::Key{.name = "distance_mm",
                  .meaning = "from the object to surface 1; negative for a virtual object",
                  .range = {.low = std::numeric_limits<double>::lowest(), .zero = false, .infinite = true},
                  .fallback = std::numeric_limits<double>::infinity()},
    numerics::Key{
        .name = "medium", .kind = numerics::ValueKind::homogeneous_medium, .meaning = "medium of the object; air unless given"}};

// The keys of every surface; exactly one shape may stand beside them (none: a plane).
inline constexpr std::array surface_keys{
    numerics::Key{.name = "name", .kind = numerics::ValueKind::text, .meaning = "name of the surface"},
    numerics::Key{
        .name = "stop", .kind = numerics::ValueKind::flag, .meaning = "true on exactly one surface: the aperture stop"},
    numerics::Key{.name = "thickness_mm", .meaning = "to the next vertex; on all surfaces but the last"},
    numerics::Key{
        .name = "medium",
        .kind = numerics::ValueKind::medium,
        .meaning = "what follows the surface: a name, {index: ...}, {nd: ..., vd: ...}, {grin: ...} or mirror; air unless given"},
    numerics::Key{.name = "semi_diameter_mm",
                  .meaning = "rays beyond it are clipped",
                  .range = numerics::positive,
                  .fallback = std::numeric_limits<double>::infinity()},
    numerics::Key{
        .name = "inner_semi_diameter_mm", .meaning = "rays inside it are clipped", .range = numerics::not_negative},
    numerics::Key{.name = "decenter_mm",
                  .kind = numerics::ValueKind::vector3,
                  .meaning = "[x, y, z] by which the vertex is moved off its place on the axis"},
    numerics::Key{.name = "tilt_deg",
                  .kind = numerics::ValueKind::vector3,
                  .meaning = "[x, y, z] turns about the new x, then the new y, then the new z"}};

inline constexpr numerics::Range index_range{.low = medium::least_index, .high = medium::largest_index, .reason = "beyond, directions lose their digits from one medium to the next"};

// Beside an index: how it changes with the wavelength. Both or none.
inline constexpr numerics::Key dispersion_key{.name = "dispersion",
                                              .kind = numerics::ValueKind::homogeneous_medium,
                                              .meaning = "a medium with whose index this one rises and falls; unless given it is the same at every wavelength"};
inline constexpr numerics::Key reference_key{.name = "reference_nm", .meaning = "the wavelength of the index", .range = wavelengths_nm_range};

// Either index, alone or with dispersion and reference_nm, or nd with vd, or grin.
inline constexpr std::array medium_keys{
    numerics::Key{.name = "grin", .kind = numerics::ValueKind::mapping, .meaning = "a gradient-index medium, by one of its forms"},
    numerics::Key{.name = "index", .meaning = "refractive index, at every wavelength or at reference_nm", .range = index_range},
    numerics::Key{.name = "nd", .meaning = "refractive index at 587.5618 nm", .range = index_range},
    numerics::Key{.name = "vd", .meaning = "Abbe number", .range = numerics::positive}, dispersion_key, reference_key};

// Beside one form of lib/gradient_index/forms.h, whose index it is.
inline constexpr std::array gradient_keys{dispersion_key, reference_key};

// The shapes of lib/surface/shapes.h, the gradients of lib/gradient_index/forms.h.
struct ShapeKind {
  std::string_view name;
  KeyTable keys;
};
const std::vector<ShapeKind>& shape_kinds();
const std::vector<ShapeKind>& gradient_kinds();

}  // namespace sagitta::prescription
