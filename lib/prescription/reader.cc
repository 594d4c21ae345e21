// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "lib/prescription/check.h"
#include "lib/prescription/documents.h"
#include "lib/prescription/extends.h"
#include "lib/prescription/keys.h"
#include "lib/prescription/medium_reader.h"
#include "lib/prescription/surface_reader.h"
#include "lib/prescription/value_reader.h"

namespace sagitta::prescription {
namespace {

// The place of a key in its table, which is the enumerator's value.
template <class Kind>
Kind kind_of(const std::string& key, KeyTable table) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const numerics::Key& one) { return one.name == key; });
  return static_cast<Kind>(found - table.begin());
}

// A list that is not empty; its items are read by read_item(item).
template <class ReadItem>
void read_list(const YamlNode& node, const std::string& label, const std::string& items, Findings& findings,
               ReadItem&& read_item) {
  if (node.kind != YamlNode::Kind::sequence || node.items.empty())
    refuse(node, label, "a list of " + items, findings);
  else
    for (const YamlNode::Pointer& item : node.items) read_item(*item);
}

std::vector<double> read_wavelengths(const YamlNode& node, Findings& findings) {
  std::vector<double> wavelengths;
  std::set<double> seen;
  if (node.items.size() > most_wavelengths) {
    findings.error(node.place, fmt::format("{} wavelengths are more than {}", node.items.size(), most_wavelengths), "trace them in several systems");
    return wavelengths;
  }
  read_list(node, "wavelengths_nm", "at least one wavelength", findings, [&](const YamlNode& item) {
    const auto wavelength = read_number(item, "each of wavelengths_nm", wavelengths_nm_range, findings);
    if (!wavelength) return;
    if (seen.insert(*wavelength).second)
      wavelengths.push_back(*wavelength);
    else
      findings.error(item.place, fmt::format("the wavelength '{}' is repeated", excerpt(item.text)), "leave it out");
  });
  return wavelengths;
}

Aperture read_aperture(const YamlNode& node, Findings& findings) {
  const Section section(node, "aperture", aperture_section_keys, findings);
  const YamlNode::Entry* given = section.one_of(aperture_keys, true);
  Aperture aperture;
  if (!given) return aperture;
  // A value that is not legal is reported here, and gives no further finding: 0 is less than any index.
  aperture = {kind_of<ApertureKind>(given->key, aperture_keys), section.number(given->key).value_or(0),
              section.text("aim").value_or("") == "stop", given->value->place};
  return aperture;
}

Fields read_fields(const YamlNode& node, Findings& findings) {
  const Section section(node, "fields", field_keys, findings);
  const YamlNode::Entry* given = section.one_of(field_keys, true);
  Fields fields;
  if (!given) return fields;
  fields.kind = kind_of<FieldKind>(given->key, field_keys), fields.points.clear(), fields.place = given->value->place;
  const numerics::Range& range = field_keys[static_cast<std::size_t>(fields.kind)].range;
  read_list(*given->value, given->key, "at least one pair [x, y]", findings, [&](const YamlNode& item) {
    if (const auto xy = read_tuple(item, "each of " + given->key, "xy", range, findings))
      fields.points.push_back({(*xy)[0], (*xy)[1]});
  });
  return fields;
}

Object read_object(const YamlNode& node, MediumReader& media, Findings& findings) {
  const Section section(node, "object", object_keys, findings);
  Object object;
  object.place = node.place;
  if (section.find("distance_mm"))
    object.distance_mm = section.number("distance_mm").value_or(std::numeric_limits<double>::quiet_NaN());
  const MediumReader::Read before = media.read(section.find("medium"));
  if (before.is_mirror || before.gradient) refuse(*section.find("medium"), "medium of the object", before.gradient ? "a medium of one index" : "a medium", findings);
  object.medium = before.medium;
  return object;
}

Model read_model(const YamlNode& root, const std::vector<Document>& documents, Findings& findings) {
  const Section section(root, "the prescription", system_keys, findings);
  MediumReader media(findings);
  Model model;
  model.file = documents.front().file;
  model.documents = documents;
  model.place = root.place;
  section.number("sagitta");
  model.name = section.text("name").value_or("");
  model.source = section.text("source").value_or("");
  model.eye = section.text("eye").value_or("");
  if (const YamlNode* node = section.find("wavelengths_nm")) model.wavelengths_nm = read_wavelengths(*node, findings);
  model.primary_nm = section.number("primary_nm");
  media.read_catalogs(section.find("catalogs"));
  if (const YamlNode* node = section.find("aperture")) model.aperture = read_aperture(*node, findings);
  if (const YamlNode* node = section.find("fields")) model.fields = read_fields(*node, findings);
  if (const YamlNode* node = section.find("object")) model.object = read_object(*node, media, findings);
  if (const YamlNode* node = section.find("surfaces")) model.surfaces = read_surfaces(*node, media, findings);
  if (section.find("tolerance_mm")) model.tolerance_mm = section.number("tolerance_mm").value_or(model.tolerance_mm);
  check_model(model, media.uses(), findings);
  return model;
}

}  // namespace

ReadResult read_prescription(const std::string& file, const Settings& settings) {
  Findings findings;
  std::optional<Model> model;
  const ExtendedTree tree = read_extended(file, findings);
  if (tree.root) {
    ComputedTree computed = with_arithmetic(tree.root, file, settings, findings);
    model = read_model(*computed.root, tree.documents, findings);
    model->parameters = std::move(computed.parameters);
  }
  if (findings.has_errors()) model.reset();
  return {std::move(model), in_order(findings, tree.documents)};
}

}  // namespace sagitta::prescription
