#include "io/json/json_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "fuzz/json_tokens.h"
#include "io/json/json.h"
#include "io/json/json_writer.h"

namespace chronormal::json_text_test {
namespace {

struct Change {
  std::string pointer, value;
  bool append = false;
};

// Applies several changes to a text and returns the result. Each change must succeed.
std::string changed(const std::string& text, const std::vector<Change>& changes) {
  JsonText json(text);
  for (const auto& [pointer, value, append] : changes) {
    const Status status = append ? json.append(pointer, value) : json.set(pointer, value);
    EXPECT_TRUE(status.ok()) << status.error().text();
  }
  std::string result = join(json.pieces());
  EXPECT_EQ(fuzz::difference_beside(fuzz::JsonTokens(text), fuzz::JsonTokens(result), json.pointers()), "")
      << text << " -> " << result;
  return result;
}
std::string set(const std::string& text, const std::string& pointer, const std::string& value) {
  return changed(text, {{pointer, value, false}});
}
std::string append(const std::string& text, const std::string& pointer, const std::string& value) {
  return changed(text, {{pointer, value, true}});
}

std::string found(const std::string& text, const std::string& pointer) {
  return std::string(JsonText(text).find(pointer).value_or("nothing"));
}

TEST(JsonText, value_is_found_by_its_pointer_as_it_is_written) {
  const std::string text = " { \"a\" : [ 1, {\"b\":  [ ] }, \"x]\\\"}\" ] ,\"\":{\"\":1e400}, \"m~n/o\": -0.0E+1 }\r\n";
  EXPECT_EQ(found(text, ""), text.substr(1, text.size() - 3));
  EXPECT_EQ(found(text, "/a/0"), "1");
  EXPECT_EQ(found(text, "/a/1"), "{\"b\":  [ ] }");
  EXPECT_EQ(found(text, "/a/1/b"), "[ ]");
  EXPECT_EQ(found(text, "/a/2"), "\"x]\\\"}\"");
  EXPECT_EQ(found(text, "//"), "1e400");
  EXPECT_EQ(found(text, "/m~0n~1o"), "-0.0E+1");
  for (const char* const pointer : {"a", "/b", "/a/3", "/a/00", "/a/+1", "/a/-", "/a/1e0", "/a/", "/a/0/0", "/a/2/0",
                                    "/m~n~1o", "/m~2", "/m~", "/a/18446744073709551616"})
    EXPECT_EQ(found(text, pointer), "nothing") << pointer;
}

TEST(JsonText, names_may_be_escaped_and_the_last_of_equal_ones_counts) {
  EXPECT_EQ(found(R"({"a":1,"\u0061":2,"b":3})", "/a"), "2");
  EXPECT_EQ(found(R"({"\u0061":2,"a":1})", "/a"), "1");
  EXPECT_EQ(set(R"({"a":1,"\u0061":2,"a":{},"b":3})", "/a", "4"), R"({"a":1,"\u0061":2,"a":4,"b":3})");
  EXPECT_EQ(set(R"({"a":{"x":1},"a":{}})", "/a/x", "4"), R"({"a":{"x":1},"a":{"x":4}})");
  EXPECT_EQ(found(R"({"\"\\\/\b\f\n\r\t":1})", "/\"\\~1\b\f\n\r\t"), "1");
  EXPECT_EQ(found(R"({"\u00e9\u20AC\uD834\udd1e":1})", "/é€𝄞"), "1");
  EXPECT_EQ(found("{\"é€𝄞\":1}", "/é€𝄞"), "1");
}

TEST(JsonText, strings_decode_and_quote_as_the_parser_does) {
  const std::string all = std::string("\0\x01\x1f \"\\/\x7f", 8) + "é€𝄞\xEF\xBF\xBF";
  EXPECT_EQ(nlohmann::json::parse(quote_json(all)).get<std::string>(), all);
  for (const bool only_ascii : {false, true})
    EXPECT_EQ(decode_json_string(nlohmann::json(all).dump(-1, ' ', only_ascii)), all);
}

TEST(JsonText, replaced_value_leaves_all_around_it) {
  EXPECT_EQ(set("\xEF\xBB\xBF { \"a\" :\t[1 , 2] }\r\n ", "/a/1", " null\n"),
            "\xEF\xBB\xBF { \"a\" :\t[1 , null] }\r\n ");
  EXPECT_EQ(set(R"({"a":{"b":1}})", "/a", "[]"), R"({"a":[]})");
  EXPECT_EQ(set("[1e400,9007199254740993,-0]", "/1", "7"), "[1e400,7,-0]");
}

TEST(JsonText, added_members_and_items_take_the_blanks_of_the_last_sibling) {
  EXPECT_EQ(set(R"({"a": 1})", "/b", "2"), R"({"a": 1,"b": 2})");
  EXPECT_EQ(set("{\r\n  \"a\" : 1\r\n}", "/b", "2"), "{\r\n  \"a\" : 1,\r\n  \"b\" : 2\r\n}");
  EXPECT_EQ(append("[1, 2]", "", "3"), "[1, 2, 3]");
  EXPECT_EQ(append("{\"w\":[\n\t0\n]}", "/w", "3"), "{\"w\":[\n\t0,\n\t3\n]}");
  EXPECT_EQ(append("[ ]", "", "3"), "[3 ]");
  EXPECT_EQ(changed("{ }", {{"/a", "1"}, {"/b", "2"}}), R"({"a":1,"b":2 })");
  EXPECT_EQ(changed("[]", {{"", "1", true}, {"", "2", true}}), "[1,2]");
  // append() puts as many blanks before a new element as the array has before its other elements, unless this number of
  // blanks is very large.
  const std::string long_one = "[" + std::string(1000, ' ') + "1]";
  EXPECT_EQ(append(long_one, "", "3"), long_one.substr(0, 1002) + ",3]");
}

TEST(JsonText, missing_parents_are_objects_and_a_missing_array_is_made) {
  EXPECT_EQ(set("{}", "/a/b/0", "1"), R"({"a":{"b":{"0":1}}})");
  EXPECT_EQ(append("{}", "/a/b", "1"), R"({"a":{"b":[1]}})");
  EXPECT_EQ(changed("{}", {{"/a", "1", true}, {"/a", "[]", true}, {"/a/1", "2", true}}), R"({"a":[1,[2]]})");
  EXPECT_EQ(set("{}", "/a\"\\\n~1", "1"), "{\"a\\\"\\\\\\u000a/\":1}");
}

TEST(JsonText, what_was_changed_can_be_changed_again) {
  EXPECT_EQ(changed(R"({"a":1})", {{"/a", "2"}, {"/a", "3"}}), R"({"a":3})");
  EXPECT_EQ(changed(R"({"a":1})", {{"/a", "{\"b\":[1]}"}, {"/a/b", "2", true}, {"/a/b/0", "{}"}, {"/a/b/0/c", "0"}}),
            R"({"a":{"b":[{"c":0},2]}})");
  EXPECT_EQ(changed(R"([[1]])", {{"/0", "2", true}, {"/0/1", "[3]"}, {"/0/1/0", "4"}, {"/0/0", "5"}}), "[[5,[4]]]");
  EXPECT_EQ(changed(R"([[1]])", {{"/0", "2", true}, {"/0", "{}"}}), "[{}]");
}

TEST(JsonText, pointers_are_the_outermost_of_what_changed) {
  const std::string text = R"({"a":{"x":1,"y":[0]},"b":1})";
  JsonText json(text);
  ASSERT_TRUE(json.append("/a/y", "7").ok());
  ASSERT_TRUE(json.set("/a/y/1", "8").ok());
  ASSERT_TRUE(json.set("/a/z/deep~1er", "8").ok());
  ASSERT_TRUE(json.set("/a/z/other", "8").ok());
  ASSERT_TRUE(json.set("/b", "{}").ok());
  ASSERT_TRUE(json.set("/b/c", "1").ok());
  ASSERT_TRUE(json.set("/~0~1", "1").ok());
  EXPECT_EQ(json.pointers(), (std::vector<std::string>{"/a/y/1", "/a/z", "/b", "/~0~1"}));
  EXPECT_TRUE(JsonText(text).pointers().empty());
}

TEST(JsonText, change_that_is_not_possible_is_refused_and_changes_nothing) {
  const std::string text = R"({"a":[1],"n":1,"s":"x"})";
  JsonText json(text);
  const auto refused = [&](const std::string& pointer, bool append) {
    const Status status = append ? json.append(pointer, "0") : json.set(pointer, "0");
    EXPECT_FALSE(status.ok()) << pointer;
    if (status.ok()) return;
    EXPECT_EQ(status.error().code, ErrorCode::kInvalidInput);
    EXPECT_EQ(status.error().place, pointer);
  };
  for (const char* const pointer : {"a", "/a/1", "/a/-", "/a/x", "/a/1/b", "/n/x", "/s/0", "/~", "/n/x/y"}) {
    refused(pointer, false);
    refused(pointer, true);
  }
  refused("", false);
  for (const char* const pointer : {"", "/n", "/s", "/a/0"}) refused(pointer, true);
  EXPECT_EQ(join(json.pieces()), text);
  EXPECT_TRUE(json.pointers().empty());
}

// Makes a random JSON value. The value may have blanks, repeated or escaped names, and numbers of all kinds.
std::string random_value(std::mt19937& random, int depth) {
  const auto pick = [&](const std::vector<std::string>& from) { return from[random() % from.size()]; };
  const auto blanks = [&] { return pick({"", "", " ", "\n  ", "\r\n", "\t"}); };
  const std::size_t kind = random() % (depth > 3 ? 4 : 8);
  if (kind < 4)
    return pick({"1e400", "-1E+999", "9007199254740993", "18446744073709551615", "0", "-0.0", "null", "true", "false",
                 "\"\"", "\"\\u00e9 \\\" ] }\"", "1.50", "[]", "{}", "[ ]", "{\n}"});
  std::string text(1, kind < 6 ? '[' : '{');
  const std::size_t count = 1 + random() % 4;
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text += ',';
    text += blanks();
    if (kind >= 6) {
      text += pick({"\"a\"", "\"\\u0061\"", "\"b\"", "\"c/~\"", "\"\"", "\"é\""});
      text += blanks().append(":").append(blanks());
    }
    text += random_value(random, depth + 1) + blanks();
  }
  text += kind < 6 ? ']' : '}';
  return text;
}

TEST(JsonText, random_changes_of_random_text_touch_nothing_else) {
  std::mt19937 random(7);
  std::size_t done = 0;
  for (int round = 0; round < 3000; ++round) {
    const std::string text = std::string("{\"r\": ").append(random_value(random, 0)).append("}");
    ASSERT_TRUE(parse_json(text, "", 0, {"", [](std::size_t, const nlohmann::json&) {}}).ok()) << text;
    JsonText json(text);
    std::string last;
    for (int k = 0; k < 4; ++k) {
      const std::string before = join(json.pieces());
      const fuzz::JsonTokens tokens(before);
      std::string pointer = tokens.all()[random() % tokens.all().size()].pointer;
      if (pointer.find(fuzz::kHidden) != std::string::npos) continue;
      if (random() % 3 == 0) pointer += random() % 2 == 0 ? "/a" : "/new/é";
      const std::string value = random_value(random, 2);
      const bool append = random() % 2 == 0;
      if (!(append ? json.append(pointer, value) : json.set(pointer, value)).ok()) continue;
      ++done;
      const std::string after = join(json.pieces());
      ASSERT_EQ(fuzz::difference_beside(fuzz::JsonTokens(text), fuzz::JsonTokens(after), json.pointers()), "")
          << text << "\n"
          << after;
      if (append) {
        EXPECT_TRUE(after.find(value) != std::string::npos);
      } else {
        EXPECT_EQ(fuzz::JsonTokens(after).value(pointer), value) << text << "\n" << after;
      }
    }
  }
  EXPECT_GT(done, 4000U);
}

TEST(ParseJson, numbers_beyond_double_are_infinite_and_all_others_what_they_are) {
  const auto parse = [](const std::string& text) {
    return parse_json(text, "a", 0, {"", [](std::size_t, const nlohmann::json&) {}});
  };
  const std::string zeros(400, '0');
  const std::vector<std::string> infinite = {"1e309",
                                             "-1e309",
                                             "1E+400",
                                             "1e99999999999999999999",
                                             "1" + zeros,
                                             "0.001e320",
                                             "2e308",
                                             "1.7976931348623159e308",
                                             "1" + zeros + ".5",
                                             "1" + zeros + "e-5",
                                             "-9" + zeros};
  for (const std::string& number : infinite) {
    const auto parsed = parse("[null,\"1e400 null\"," + number + ",null, " + number + " ]");
    ASSERT_TRUE(parsed.ok()) << number << ": " << parsed.error().text();
    const nlohmann::json& all = parsed.value();
    EXPECT_TRUE(all[0].is_null() && all[3].is_null() && all[1] == "1e400 null") << number;
    EXPECT_TRUE(all[2].is_number_float() && std::isinf(all[2].get<double>())) << number;
    EXPECT_TRUE(all[4].is_number_float() && std::isinf(all[4].get<double>())) << number;
  }
  const std::vector<std::string> finite = {"1e308",
                                           "1.7976931348623157e308",
                                           "1e-400",
                                           "1e-99999999999999999999",
                                           "0e999",
                                           "0." + zeros + "1",
                                           "0." + zeros + "1e401",
                                           "1" + zeros + "e-400",
                                           "-0.0e+999999999999999999999"};
  for (const std::string& number : finite) {
    const auto parsed = parse(number);
    ASSERT_TRUE(parsed.ok()) << number << ": " << parsed.error().text();
    EXPECT_EQ(parsed.value().get<double>(), std::strtod(number.c_str(), nullptr)) << number;
  }
  // The parser must refuse a malformed number and not repair it.
  for (const char* const number : {"1e400.5", "01e400", "-e400", "1.e400", ".1e400", "1e400-", "+1e400", "1e4001e400",
                                   "1e400x", "1e+-400", "[1e400"}) {
    const auto parsed = parse(number);
    EXPECT_FALSE(parsed.ok()) << number;
    if (!parsed.ok()) {
      EXPECT_TRUE(parsed.error().place.starts_with("a, byte ")) << parsed.error().text();
    }
  }
}

}  // namespace
}  // namespace chronormal::json_text_test
