// SPDX-License-Identifier: Apache-2.0
// The media that one prescription names or describes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/medium/medium.h"
#include "lib/prescription/agf_reader.h"
#include "lib/prescription/check.h"
#include "lib/prescription/diagnostics.h"
#include "lib/prescription/model.h"
#include "lib/prescription/yaml_tree.h"

namespace sagitta::prescription {

class Section;

class MediumReader {
 public:
  explicit MediumReader(Findings& findings) : findings_(findings) {}

  struct Read {
    medium::Medium medium = medium::air();  // air too where there was an error
    bool is_mirror = false;
    std::optional<GradientMedium> gradient{};  // if it is one, `medium` has its dispersion
  };
  // A name, {index: ...}, {nd: ..., vd: ...}, {grin: ...} or mirror; a null pointer is the default, air.
  Read read(const YamlNode* node);

  // The catalogues in which names are looked up, from a list of files; a null pointer: none. To be called before read().
  void read_catalogs(const YamlNode* node);

  // Every medium that was read, with its place.
  const std::vector<MediumUse>& uses() const { return uses_; }

 private:
  // Media that may be used, or that others disperse as.
  medium::Medium read_one(const YamlNode& node);
  medium::Medium read_name(const YamlNode& node);
  medium::Medium read_inline(const YamlNode& node);
  Read read_gradient(const YamlNode& node);
  // dispersion with reference_nm; none where they are not given, or at fault.
  struct DispersesAs {
    medium::Medium medium;
    double reference_nm;
  };
  std::optional<DispersesAs> read_dispersion(const YamlNode& node, const Section& section, std::string_view name);

  Findings& findings_;
  std::vector<AgfCatalog> catalogs_;
  // By folder and name, since a name means a file beside the one in which it stands.
  std::map<std::string, medium::Medium> known_;  // a file is read once,
  std::map<std::string, Place> failed_;          // and faults in it are told once, for the use there
  std::vector<MediumUse> uses_;
};

}  // namespace sagitta::prescription
