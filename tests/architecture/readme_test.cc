// SPDX-License-Identifier: Apache-2.0
// README.md is the reference of the prescription and of the outputs: it names all there is.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "lib/prescription/keys.h"
#include "lib/prescription/study_keys.h"
#include "lib/surface/status.h"

namespace {

namespace fs = std::filesystem;
using namespace sagitta;

std::string readme() {
  std::ifstream stream(fs::path(SAGITTA_SOURCE_DIR) / "README.md");
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool names(const std::string& text, std::string_view word) { return text.find("`" + std::string(word) + "`") != std::string::npos; }

TEST(Readme, NamesEveryKeyOfThePrescription) {
  const std::string text = readme();
  int checked = 0;
  const auto check = [&](prescription::KeyTable table) {
    for (const numerics::Key& key : table) {
      EXPECT_TRUE(names(text, key.name)) << key.name;
      ++checked;
    }
  };
  for (const prescription::KeyTable table :
       {prescription::KeyTable(prescription::system_keys), prescription::KeyTable(prescription::aperture_section_keys),
        prescription::KeyTable(prescription::field_keys), prescription::KeyTable(prescription::object_keys),
        prescription::KeyTable(prescription::surface_keys), prescription::KeyTable(prescription::medium_keys), prescription::KeyTable(prescription::gradient_keys),
        prescription::KeyTable(prescription::study_keys), prescription::KeyTable(prescription::variant_keys),
        prescription::KeyTable(prescription::roughness_keys), prescription::KeyTable(prescription::paper_keys)})
    check(table);
  for (const auto& shape : prescription::shape_kinds()) {
    EXPECT_TRUE(names(text, shape.name)) << shape.name;
    check(shape.keys);
  }
  for (const auto& form : prescription::gradient_kinds()) {
    EXPECT_TRUE(names(text, form.name)) << form.name;
    check(form.keys);
  }
  EXPECT_GT(checked, 50);
}

TEST(Readme, NamesEveryStatusOfARay) {
  const std::string text = readme();
  for (const std::string_view status : surface::status_names) EXPECT_TRUE(names(text, status)) << status;
}

TEST(Readme, NamesEveryFolderSystemAndScript) {
  const std::string text = readme();
  const fs::path root(SAGITTA_SOURCE_DIR);
  int checked = 0;
  for (const auto& entry : fs::directory_iterator(root / "lib")) {
    EXPECT_TRUE(names(text, "lib/" + entry.path().filename().string())) << entry.path();
    ++checked;
  }
  for (const auto& entry : fs::directory_iterator(root / "systems"))
    if (entry.path().extension() == ".yaml") {
      EXPECT_TRUE(names(text, entry.path().filename().string())) << entry.path();
      ++checked;
    }
  for (const auto& entry : fs::directory_iterator(root / "tools"))
    if (!entry.path().has_extension()) {
      EXPECT_TRUE(names(text, "tools/" + entry.path().filename().string())) << entry.path();
      ++checked;
    }
  EXPECT_GT(checked, 20);
}

TEST(Readme, LinksToFilesThatAreThere) {
  const std::string text = readme();
  int checked = 0;
  for (std::size_t at = 0; (at = text.find("](", at)) != std::string::npos; ++checked) {
    at += 2;
    const std::string target = text.substr(at, text.find(')', at) - at);
    if (target.starts_with("#") || target.starts_with("http")) continue;
    EXPECT_TRUE(fs::exists(fs::path(SAGITTA_SOURCE_DIR) / target)) << target;
  }
  EXPECT_GT(checked, 0);
}

}  // namespace
