// Checks that the generator of docs/benchmarks.md makes it from bench/results/*.json, byte for byte, and that it
// refuses results that lack a baseline.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/generated_page.h"
#include "tests/support/process.h"

namespace chronormal::benchmarks_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const fs::path kResults = fs::path(kSourceFolder) / "bench" / "results";

ProcessResult generate(const std::string& results, const std::string& folder) {
  std::string command = kBuildFolder;
  command += "/tools/benchmarks/chronormal_benchmarks '" + results + "' .";
  return run_shell(command, folder);
}

// Returns any of the results, to plant faults in.
Json some_results() {
  for (const auto& entry : fs::directory_iterator(kResults)) {
    if (entry.path().extension() == ".json") return Json::parse(test::read_whole(entry.path().string()));
  }
  return {};
}

// Returns the message of the generator about results with a fault, or "" if it accepts them.
std::string refusal(const Json& results) {
  const test::TemporaryFolder from, to;
  from.write("planted.json", results.dump());
  const ProcessResult result = generate(from.path(), to.path());
  return result.exit_code == 0 ? "" : result.err;
}

void erase_rows(Json& results, const std::string& list, const auto& is_wanted) {
  Json kept = Json::array();
  for (const Json& row : results[list]) {
    if (!is_wanted(row)) kept.push_back(row);
  }
  ASSERT_LT(kept.size(), results[list].size());
  results[list] = kept;
}

TEST(Benchmarks, page_and_pictures_are_what_the_generator_makes_of_the_results) {
  const test::TemporaryFolder folder;
  const ProcessResult result = generate(kResults.string(), folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string committed = test::read_whole((test::kDocs / "benchmarks.md").string());
  test::expect_same_text(committed, test::read_whole(folder / "benchmarks.md"), "docs/benchmarks.md");
  EXPECT_GE(test::expect_same_pictures(folder, committed), 2u);
}

TEST(Benchmarks, results_without_a_rival_make_no_page) {
  const Json whole = some_results();
  ASSERT_FALSE(whole.is_null());
  ASSERT_EQ(refusal(whole), "");
  for (const std::string rival :
       {"plain C++ loop", "Eigen loop", "CGAL compute_vertex_normals", "OpenMesh calc_vertex_normal_correct",
        "VTK vtkPolyDataNormals", "VTK vtkTriangleMeshPointNormals", "recompute"}) {
    Json planted = whole;
    erase_rows(planted, "rows", [&](const Json& row) {
      return row["name"] == rival && row["group"] == "vertices" && row["size"] == "1M" && row["order"] == "grid";
    });
    EXPECT_NE(refusal(planted).find("missing: vertices, 1M, grid: " + rival), std::string::npos) << rival;
  }
}

TEST(Benchmarks, results_without_a_size_a_scheme_or_an_accuracy_make_no_page) {
  const Json whole = some_results();
  ASSERT_FALSE(whole.is_null());
  Json planted = whole;
  erase_rows(planted, "rows", [](const Json& row) { return row["order"] == "shuffled" && row["group"] == "faces"; });
  EXPECT_NE(refusal(planted).find("missing: faces, 10M, shuffled: exact to float3"), std::string::npos);
  planted = whole;
  erase_rows(planted, "rows", [](const Json& row) { return row["group"] == "schemes" && row["name"] == "slerp"; });
  EXPECT_NE(refusal(planted).find("missing: schemes, 15k, grid: slerp"), std::string::npos);
  planted = whole;
  erase_rows(planted, "qualities", [](const Json& row) { return row["scheme"] == "circle"; });
  EXPECT_NE(refusal(planted).find("missing: quality of circle"), std::string::npos);
  planted = whole;
  erase_rows(planted, "accuracies", [](const Json& row) { return row["path"] == "recompute"; });
  EXPECT_NE(refusal(planted).find("missing: accuracy, grid, faces: recompute"), std::string::npos);
}

// Adds rows like a run's, whatever the results have: a nanosecond for each way and number of active targets, and 8 for
// recompute.
Json with_blend_rows(Json results) {
  Json rows = Json::array();
  Json like;
  for (const Json& row : results["rows"]) {
    if (row["group"] == "blend") continue;
    rows.push_back(row);
    like = row;
  }
  for (const char* const size : {"15k", "45k"}) {
    for (const char* const active : {"1", "2", "4", "8", "16", "52", "100"}) {
      for (const char* const way :
           {"chosen", "terms", "touched part", "recompute in float32", "recompute", "plain C++ loop", "linear sum"}) {
        like["group"] = "blend";
        like["size"] = size;
        like["order"] = "grid";
        like["name"] = std::string(active).append(" of 100: ").append(way);
        like["median_ns"] = std::string(way).starts_with("recompute") ? 8.0 : 1.0;
        like["spread"] = 0.02;
        like["threads"] = 1;
        rows.push_back(like);
      }
    }
  }
  results["rows"] = rows;
  return results;
}

TEST(Benchmarks, blend_shapes_are_a_section_where_a_run_measured_them_and_then_whole) {
  const Json whole = some_results();
  ASSERT_FALSE(whole.is_null());
  const auto page_of = [](const Json& results) {
    const test::TemporaryFolder from, to;
    from.write("planted.json", results.dump());
    const ProcessResult result = generate(from.path(), to.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return test::read_whole(to / "benchmarks.md");
  };
  const Json with = with_blend_rows(whole);
  const std::string page = page_of(with);
  EXPECT_NE(page.find("### Blend shapes\n"), std::string::npos);
  EXPECT_NE(page.find("| active of 100, 15 k vertices | "), std::string::npos);
  EXPECT_NE(page.find("| active of 100, 45 k vertices | "), std::string::npos);
  EXPECT_NE(page.find(" 8.00 ±2 |"), std::string::npos);
  EXPECT_NE(page.find(" 8.0 |\n"), std::string::npos);
  Json without = with;
  erase_rows(without, "rows", [](const Json& row) { return row["group"] == "blend"; });
  EXPECT_EQ(page_of(without).find("Blend shapes"), std::string::npos);
  Json planted = with;
  erase_rows(planted, "rows",
             [](const Json& row) { return row["size"] == "45k" && row["name"] == "4 of 100: linear sum"; });
  EXPECT_NE(refusal(planted).find("missing: blend, 45k, grid: 4 of 100: linear sum"), std::string::npos);
}

TEST(Benchmarks, the_rival_in_float32_is_asked_of_runs_that_measured_it) {
  const std::string rival = "recompute in float32";
  Json without = some_results();
  ASSERT_FALSE(without.is_null());
  Json rows = Json::array();
  for (const Json& row : without["rows"]) {
    if (row["name"].get<std::string>().find(rival) == std::string::npos && row["group"] != "dense blend")
      rows.push_back(row);
  }
  without["rows"] = rows;
  EXPECT_EQ(refusal(without), "");
  Json with = without;
  for (const Json& row : rows) {
    Json like = row;
    const auto name = row["name"].get<std::string>();
    if (!name.starts_with("recompute") || (row["group"] != "faces" && row["group"] != "vertices")) continue;
    like["name"] = std::string(name).replace(0, 9, rival);
    with["rows"].push_back(like);
  }
  EXPECT_EQ(refusal(with), "");
  erase_rows(with, "rows", [&](const Json& row) {
    return row["name"] == rival && row["group"] == "vertices" && row["size"] == "1M";
  });
  EXPECT_NE(refusal(with).find("missing: vertices, 1M, grid: " + rival), std::string::npos);
}

TEST(Benchmarks, results_that_were_wrong_or_cannot_be_read_make_no_page) {
  Json planted = some_results();
  ASSERT_FALSE(planted.is_null());
  planted["rows"][0]["verified_error_rad"] = 1.0;
  planted["rows"][0]["limit_rad"] = 0.5;
  EXPECT_NE(refusal(planted).find("was wrong"), std::string::npos);
  EXPECT_NE(refusal(Json::array()), "");
  const test::TemporaryFolder empty;
  EXPECT_EQ(generate(empty.path(), empty.path()).exit_code, 1);
}

}  // namespace
}  // namespace chronormal::benchmarks_test
