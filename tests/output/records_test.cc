// SPDX-License-Identifier: Apache-2.0
#include "lib/output/records.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace sagitta::output {
namespace {

const std::vector<RecordColumn> columns{{"name", true}, {"value"}};
const Records records{columns, {{"a, \"b\"\nc", "1.5e-300"}, {"", ""}, {"µm", "0.1"}}};

TEST(Records, CsvQuotesWhatNeedsIt) {
  EXPECT_EQ(to_csv(records), "name,value\n\"a, \"\"b\"\"\nc\",1.5e-300\n,\nµm,0.1\n");
}

TEST(Records, CsvComesBackCellByCell) {
  const auto rows = rows_of_csv(to_csv(records), columns);
  ASSERT_TRUE(rows);
  EXPECT_EQ(*rows, records.rows);
}

TEST(Records, OtherColumnsOrHalfARowAreNone) {
  EXPECT_FALSE(rows_of_csv("", columns));
  EXPECT_FALSE(rows_of_csv("name,other\na,1\n", columns));
  EXPECT_FALSE(rows_of_csv("value,name\n1,a\n", columns));
  EXPECT_FALSE(rows_of_csv("name,value\na\n", columns));
  EXPECT_TRUE(rows_of_csv("name,value\n", columns));
}

TEST(Records, JsonHasNumbersAndNull) {
  const auto json = nlohmann::json::parse(to_json({{"title", "T"}}, records));
  EXPECT_EQ(json["title"], "T");
  ASSERT_EQ(json["rows"].size(), 3u);
  EXPECT_EQ(json["rows"][0]["value"], 1.5e-300);
  EXPECT_TRUE(json["rows"][1]["value"].is_null());
  EXPECT_EQ(json["rows"][2]["name"], "µm");
}

}  // namespace
}  // namespace sagitta::output
