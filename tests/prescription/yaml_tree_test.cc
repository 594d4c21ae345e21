// SPDX-License-Identifier: Apache-2.0
#include "lib/prescription/yaml_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/prescription/support.h"

namespace sagitta::prescription {
namespace {

struct Tree {
  YamlNode::Pointer root;
  Findings findings;
};

Tree read(const std::string& text) {
  const test::TemporaryFolder folder;
  Tree tree;
  tree.root = read_yaml(folder.write("tree.yaml", text), tree.findings);
  return tree;
}

void expect_place(const Place& place, int line, int column) {
  EXPECT_EQ(place.line, line);
  EXPECT_EQ(place.column, column);
}

TEST(YamlTree, EveryNodeHasItsPlace) {
  const Tree tree = read("a: 1\nlist:\n  - x\n  - {b: \"2\", c: }\n");
  ASSERT_TRUE(tree.root);
  ASSERT_EQ(tree.root->kind, YamlNode::Kind::mapping);
  ASSERT_EQ(tree.root->entries.size(), 2u);
  const YamlNode::Pointer a = tree.root->find("a");
  EXPECT_EQ(a->text, "1");
  EXPECT_FALSE(a->quoted);
  expect_place(tree.root->entries[0].key_place, 1, 1);
  expect_place(a->place, 1, 4);
  const YamlNode::Pointer list = tree.root->find("list");
  ASSERT_EQ(list->items.size(), 2u);
  expect_place(list->items[0]->place, 3, 5);
  const YamlNode::Pointer b = list->items[1]->find("b");
  EXPECT_EQ(b->text, "2");
  EXPECT_TRUE(b->quoted);
  expect_place(b->place, 4, 9);
  const YamlNode::Pointer c = list->items[1]->find("c");
  EXPECT_EQ(c->kind, YamlNode::Kind::null);
  expect_place(c->place, 4, 14);  // of its key: an empty value has no place of its own
  EXPECT_EQ(tree.root->find("d"), nullptr);
}

TEST(YamlTree, WindowsFilesAndByteOrderMarksAreRead) {
  for (const std::string text : {"a: 1\r\nb: 2\r\n",
                                 "\xef\xbb\xbf"
                                 "a: 1\nb: 2\n",
                                 "a: 1\nb: 2"}) {
    const Tree tree = read(text);
    ASSERT_TRUE(tree.root) << test::text_of(tree.findings);
    EXPECT_EQ(tree.root->find("b")->text, "2");
    expect_place(tree.root->find("b")->place, 2, 4);
  }
}

TEST(YamlTree, AnAliasIsTheNodeThatItNames) {
  const Tree tree = read("a: &glass {nd: 1.5}\nb: *glass\n");
  ASSERT_TRUE(tree.root);
  EXPECT_EQ(tree.root->find("a"), tree.root->find("b"));
}

TEST(YamlTree, OfRepeatedKeysTheFirstIsKeptAndTheSecondReported) {
  const Tree tree = read("a: 1\nb: 2\na: 3\n");
  ASSERT_TRUE(tree.root);
  EXPECT_EQ(tree.root->find("a")->text, "1");
  EXPECT_EQ(tree.findings.error_count(), 1);
  expect_place(tree.findings.all()[0].place, 3, 1);
}

TEST(YamlTree, AliasesCountTowardTheDepth) {
  const std::string deep = "a: &a " + std::string(60, '[') + std::string(60, ']') + "\n";
  EXPECT_TRUE(read(deep + "b: " + std::string(39, '[') + "*a" + std::string(39, ']') + "\n").root);
  EXPECT_FALSE(read(deep + "b: " + std::string(40, '[') + "*a" + std::string(40, ']') + "\n").root);
}

TEST(YamlTree, FilesThatCannotBeReadAreErrors) {
  const test::TemporaryFolder folder;
  for (const std::string& file : {folder.path() + "/nothing.yaml", folder.path()}) {
    Findings findings;
    EXPECT_FALSE(read_yaml(file, findings));
    EXPECT_EQ(findings.error_count(), 1);
  }
}

TEST(Numbers, AreReadWithoutTheLocale) {
  const std::vector<std::pair<std::string, double>> cases{{"1.5", 1.5},
                                                          {"-3e-4", -3e-4},
                                                          {"+2", 2},
                                                          {".5", 0.5},
                                                          {"5.", 5},
                                                          {"0", 0},
                                                          {"1E3", 1000},
                                                          {".inf", std::numeric_limits<double>::infinity()},
                                                          {"-.Inf", -std::numeric_limits<double>::infinity()},
                                                          {"0.1", 0.1},
                                                          {"4.9e-324", 4.9e-324}};
  for (const auto& [text, value] : cases) {
    const ParsedNumber parsed = parse_number(text);
    EXPECT_TRUE(parsed.ok) << text;
    EXPECT_EQ(parsed.value, value) << text;
  }
  EXPECT_TRUE(std::signbit(parse_number("-0").value));
  EXPECT_TRUE(parse_number(".nan").ok && std::isnan(parse_number(".nan").value));
}

TEST(Numbers, AreNothingElse) {
  for (const std::string text : {"", "-", "+", "+-1", "--1", "inf", "nan", "-nan(1)", "1,5", "1 ", " 1", "0x10", "1e",
                                 "1e999", "1.2.3", "7.8 mm", "one", "infinity", "1_000"})
    EXPECT_FALSE(parse_number(text).ok) << text;
}

}  // namespace
}  // namespace sagitta::prescription
