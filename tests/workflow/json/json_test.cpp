// Tests the JSON that the library makes of results, which must equal the text that the program prints.

#include "workflow/json/json.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/places.h"
#include "tests/support/process.h"

namespace chronormal::json_test {
namespace {

Input twist() {
  InputOptions options;
  options.samples = {"twist"};
  return open_input(options).value();
}

std::string printed(const std::string& arguments) {
  const ProcessResult result = run_shell(std::string(kProgram) + " " + arguments + " --sample twist --json", "/");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.out;
}

TEST(ResultJson, is_the_text_that_the_program_prints) {
  Input input = twist();
  const Motion& motion = *input.motion().value();
  const Audit found = audit(motion, *input.normals().value(), {}).value();
  EXPECT_EQ(audit_json(input.name(), found, {}), printed("audit"));
  const Comparison comparison = compare(motion, {.schemes = {"linear"}, .progress = {}}).value();
  EXPECT_EQ(compare_json({{input.name(), comparison}}, false, false), printed("compare --schemes linear --no-times"));
  EXPECT_EQ(inspect_json(inspect_input(twist(), "").value()), printed("inspect"));
}

TEST(ResultJson, passes_only_within_the_tolerance) {
  Audit found;
  found.error.worst = 2;
  found.error.judged = 1;
  EXPECT_EQ(nlohmann::json::parse(audit_json("a", found, {2}))["passed"], true);
  EXPECT_EQ(nlohmann::json::parse(audit_json("a", found, {1}))["passed"], false);
  EXPECT_TRUE(nlohmann::json::parse(audit_json("a", found, {}))["passed"].is_null());
  found.viewers.resize(2);  // from here on, the errors in the two viewers decide
  EXPECT_EQ(nlohmann::json::parse(audit_json("a", found, {1}))["passed"], true);
  found.viewers[1].beyond = 1;
  EXPECT_EQ(nlohmann::json::parse(audit_json("a", found, {1}))["passed"], false);
}

TEST(ResultJson, is_safe_to_print_and_valid_for_any_name) {
  Audit found;
  found.error.sum = std::numeric_limits<double>::quiet_NaN();
  found.error.judged = 1;
  const std::string text = audit_json("\x1b[31m\xff\xe2\x80\xae", found, {});
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
  EXPECT_EQ(text.find("\xe2\x80\xae"), std::string::npos) << "it turns the direction of writing";
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["input"]["name"], "\x1b[31m\xef\xbf\xbd\xe2\x80\xae");
  EXPECT_TRUE(json["mean_degrees"].is_null());
}

}  // namespace
}  // namespace chronormal::json_test
