#include "io/json/json_writer.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace chronormal::json_writer_test {
namespace {

TEST(JsonNumber, has_the_fewest_digits_that_read_back) {
  EXPECT_EQ(json_number(0.1F), "0.1");
  EXPECT_EQ(json_number(0.1), "0.1");
  EXPECT_EQ(json_number(double{0.1F}), "0.10000000149011612") << "a float that is compared as a double";
  EXPECT_EQ(json_number(4.0), "4");
  for (const double value : {1.0 / 3, 5e-324, std::numeric_limits<double>::max(), -1e-7}) {
    EXPECT_EQ(nlohmann::json::parse(json_number(value)).get<double>(), value);
    EXPECT_EQ(nlohmann::json::parse(json_number(-value)).get<double>(), -value);
  }
}

TEST(JsonObject, keeps_its_members_in_order_and_their_text_as_it_is) {
  JsonObject object;
  EXPECT_TRUE(object.empty());
  EXPECT_EQ(object.text(), "{}");
  object.add("n", 18446744073709551615U).add("a \"name\"", "[1.0,2e400]").add("s", quote_json("x\\y\n"));
  EXPECT_FALSE(object.empty());
  EXPECT_EQ(object.text(), R"({"n":18446744073709551615,"a \"name\"":[1.0,2e400],"s":"x\\y\u000a"})");
  EXPECT_EQ(JsonObject().add("outer", JsonObject().add("inner", 0).text()).text(), R"({"outer":{"inner":0}})");
}

}  // namespace
}  // namespace chronormal::json_writer_test
