// SPDX-License-Identifier: Apache-2.0
// One shape of a prescription, whatever its kind: its values are read after the shape's own table of keys.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "lib/prescription/diagnostics.h"
#include "lib/prescription/keys.h"
#include "lib/prescription/model.h"
#include "lib/prescription/yaml_tree.h"

namespace sagitta::prescription {

// What files hold, by file, format and axes: a file is read once, however many surfaces name it, and faults in it are told once.
template <class Data>
struct KnownFile {
  std::shared_ptr<const Data> data;  // null: it could not be read
  Place named_at;                    // for the first time
};
template <class Data>
using KnownFilesOf = std::map<std::tuple<std::string, std::string, bool>, KnownFile<Data>>;
struct KnownFiles {
  KnownFilesOf<PointCloud> clouds;
  KnownFilesOf<SagGrid> grids;
};

// The values of a mapping, after its table of keys.
class Section;
Parameters read_parameters(const Section& section, KeyTable keys);

// A file that the shape names is looked for first beside the file in which the name stands.
Shape read_shape(const ShapeKind& kind, const YamlNode& node, KnownFiles& known, Findings& findings);

// A shape that is asked for outside a prescription, by keys and texts: as if it stood at `place` in one.
Shape make_shape(std::string_view kind, const std::vector<std::pair<std::string, std::string>>& values, const Place& place,
                 Findings& findings);

}  // namespace sagitta::prescription
