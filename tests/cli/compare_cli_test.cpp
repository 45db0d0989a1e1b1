// Checks that `compare` prints each figure under its own name in the table, the JSON and the CSV. The expected figures
// were computed by hand.

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::compare_cli_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Three triangles move in the first of two segments. The first triangle has no area. The normal of the second triangle
// turns over at t = 1/4. The normal of the third triangle turns from z to -y, where linear interpolation has an error
// of 45 - atan(1/2) degrees at t = 1/2. There are 18 samples: 3 faces, 2 segments, and 3 times in each segment. For 6
// of these samples, there is no exact normal. Linear interpolation has errors at two samples: the error of the third
// triangle, and 180 degrees where the opposite end normals of the second triangle cancel.
class CompareFigures : public testing::Test {
 protected:
  CompareFigures() {
    const std::string line = "v 0 0 0\nv 1 0 0\nv 2 0 0\n", faces = "f 1 2 3\nf 4 5 6\nf 7 8 9\n";
    const std::string end = line + "v 0 0 0\nv 1 0 0\nv 0 -3 0\nv 0 0 0\nv 1 0 0\nv 0 0 2\n" + faces;
    folder_.write("1.obj", line + "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\n" + faces);
    folder_.write("2.obj", end);
    folder_.write("3.obj", end);
  }
  [[nodiscard]] ProcessResult run(const std::string& form) const {
    return run_shell(
        std::string(kProgram) + " compare 1.obj 2.obj 3.obj --samples 3 --schemes linear,slerp --no-times " + form,
        folder_.path());
  }
  [[nodiscard]] std::string output(const std::string& form) const { return run(form).out; }
  [[nodiscard]] int exit_code_of(const std::string& form) const { return run(form).exit_code; }

  static constexpr double kLess = 18.43494882292201;  // 45 - atan(1/2), in degrees
  static constexpr double kSum = 180 + kLess;
  static constexpr double kMean = kSum / 12;
  static constexpr double kRms = 52.23332855092279;  // sqrt((180^2 + kLess^2) / 12)

  test::TemporaryFolder folder_;
};

TEST_F(CompareFigures, csv_has_each_figure_in_the_column_of_its_name) {
  std::istringstream lines(output("--csv"));
  std::string header, row;
  std::getline(lines, header);
  std::getline(lines, row);
  std::istringstream names(header), values(row);
  std::map<std::string, std::string> field;
  for (std::string name, value; std::getline(names, name, ',') && std::getline(values, value, ',');)
    field[name] = value;
  EXPECT_EQ(field["scheme"], "linear");
  EXPECT_NEAR(std::stod(field["sum_degrees"]), kSum, 1e-4);
  EXPECT_NEAR(std::stod(field["mean_degrees"]), kMean, 1e-5);
  EXPECT_NEAR(std::stod(field["rms_degrees"]), kRms, 1e-5);
  EXPECT_NEAR(std::stod(field["max_degrees"]), 180, 1e-5);
  EXPECT_EQ(field["max_segment"], "0");
  EXPECT_EQ(field["max_element"], "1");
  EXPECT_EQ(field["max_t"], "0.5");
  EXPECT_EQ(field["degenerate"], "6");
  EXPECT_EQ(field["missing"], "0");
  EXPECT_EQ(field["fallbacks"], "0");
  EXPECT_EQ(field["flagged"], "0");
  EXPECT_EQ(field["segments"], "2");
}

TEST_F(CompareFigures, json_has_each_figure_under_its_name) {
  const Json rows = Json::parse(output("--json"))["schemes"];
  EXPECT_NEAR(rows[0]["mean_degrees"], kMean, 1e-5);
  EXPECT_NEAR(rows[0]["rms_degrees"], kRms, 1e-5);
  EXPECT_NEAR(rows[0]["max_degrees"], 180, 1e-5);
  for (const Json& row : rows) {
    EXPECT_EQ(row["degenerate"], 6);
    EXPECT_EQ(row["missing"], 0);
  }
  EXPECT_EQ(rows[0]["fallbacks"], 0);
  EXPECT_EQ(rows[1]["fallbacks"], 1) << "of slerp between opposite normals";
}

TEST_F(CompareFigures, errors_of_several_motions_or_in_the_place_of_the_output_are_refused) {
  EXPECT_EQ(exit_code_of("--each --errors e.npz"), 2);
  EXPECT_EQ(exit_code_of("--errors same.npz -o same.npz"), 2);
  EXPECT_EQ(exit_code_of("--errors e.npz"), 0);
}

TEST_F(CompareFigures, operations_stand_in_the_table_where_they_are_asked_for) {
  const std::string text = output("--table operations");
  for (const char* const line : {"operations", "add  mul  div  sqrt  trig", "     5   12    1     1     0\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line << "\nin\n" << text;
  EXPECT_EQ(output("--table text"), output(""));
  EXPECT_EQ(output("").find("operations"), std::string::npos);
}

TEST_F(CompareFigures, latex_has_the_figures_of_both_tables) {
  const std::string text = output("--table latex");
  for (const char* const line : {"\nLinear & 198.4 & 1.0000 \\\\\n", "\nVector SLERP & ", "\\label{tab:quality}",
                                 "\nLinear & 5 & 12 & 1 & 1 & 0 & ", "\\label{tab:cost}"})
    EXPECT_NE(text.find(line), std::string::npos) << line << "\nin\n" << text;
  for (const char* const wrong : {"--table pdf", "--table latex --json", "--table latex --csv",
                                  "--table latex --shard 1/1", "--table latex --truth 2"})
    EXPECT_EQ(exit_code_of(wrong), 2) << wrong;
}

// Returns the cells of the table row that begins with the given name, in LaTeX or in the text table.
std::vector<std::string> cells_after(const std::string& text, const std::string& name, char separator) {
  const std::size_t begin = text.find('\n' + name + ' ');
  if (begin == std::string::npos) {
    ADD_FAILURE() << "no row " << name << " in\n" << text;
    return {};
  }
  std::istringstream row(text.substr(begin + 1 + name.size(), text.find('\n', begin + 1) - begin - 1 - name.size()));
  std::vector<std::string> cells;
  for (std::string word; row >> word;) {
    if (separator == ' ')
      cells.push_back(word);
    else if (word[0] != separator && word != "\\\\")
      cells.push_back(word);
  }
  return cells;
}

std::string with_groups(double value) {
  std::ostringstream text;
  text.precision(1);
  text << std::fixed << value;
  std::string digits = text.str();
  for (std::size_t at = digits.find('.'); at > 3; at -= 3) digits.insert(at - 3, ",");
  return digits;
}

std::string with_decimals(double value, int digits) {
  std::ostringstream text;
  text.precision(digits);
  text << std::fixed << value;
  return text.str();
}

TEST_F(CompareFigures, latex_and_operations_have_the_numbers_of_json_each_in_its_place) {
  const std::vector<std::pair<std::string, std::string>> names = {{"linear", "Linear"},
                                                                  {"quadratic", "Quadratic"},
                                                                  {"cubic", "Cubic"},
                                                                  {"slerp", "Vector SLERP"},
                                                                  {"decasteljau:4", "Spherical deCasteljau"},
                                                                  {"quaternion:matrix", "Quaternion SLERP"},
                                                                  {"lagrange:5", "\\texttt{lagrange:5}"},
                                                                  {"circle", "\\texttt{circle}"}};
  std::string schemes;
  for (const auto& [scheme, name] : names) schemes += (schemes.empty() ? "" : ",") + scheme;
  // Makes motions with different figures. The name of the first motion has characters that are special in LaTeX.
  fs::create_directory(folder_.path() + "/a_b 10%");
  fs::copy(folder_.path() + "/1.obj", folder_.path() + "/a_b 10%/1.obj");
  fs::copy(folder_.path() + "/2.obj", folder_.path() + "/a_b 10%/2.obj");
  const auto compare = [&](const std::string& form) {
    const ProcessResult result = run_shell(std::string(kProgram) +
                                               " compare --each 'a_b 10%' --sample soup --samples 7 "
                                               "--no-times --schemes " +
                                               schemes + " " + form,
                                           folder_.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  const std::string latex = compare("--table latex");
  EXPECT_NE(latex.find("\\multicolumn{2}{r}{a\\_b 10\\%} & \\multicolumn{2}{r}{soup}"), std::string::npos) << latex;
  EXPECT_NE(latex.find("a\\_b 10\\% with 3 in 1 segment, soup with 5,000 in 1 segment"), std::string::npos) << latex;
  const Json random = Json::parse(compare("--json"))["inputs"],
             played = Json::parse(compare("--json --access sequential"))["inputs"];
  const std::string cost = latex.substr(latex.find("sequential access"));
  const std::string text =
      run_shell("COLUMNS=200 " + std::string(kProgram) +
                    " compare --sample soup --samples 7 --no-times --table operations --schemes " + schemes,
                folder_.path())
          .out;
  for (std::size_t r = 0; r < names.size(); ++r) {
    const auto& [scheme, name] = names[r];
    SCOPED_TRACE(scheme);
    std::vector<std::string> expected;
    for (const Json& input : random) {
      const Json& row = input["schemes"][r];
      expected.push_back(with_groups(row["sum_degrees"]));
      expected.push_back(with_decimals(row["relative_to_linear"], 4));
    }
    EXPECT_EQ(cells_after(latex, name, '&'), expected);
    expected.clear();
    std::vector<std::string> of_text;
    for (const Json* const inputs : {&random, &played}) {
      const Json& row = (*inputs)[1]["schemes"][r];
      const bool is_there = inputs == &random || row["access"] == "sequential";
      for (const char* const key : {"add", "multiply", "divide", "sqrt", "trigonometric"}) {
        const std::string count = std::to_string(row["operations"][key].get<int>());
        expected.push_back(is_there ? count : "--");
        if (inputs == &random) of_text.push_back(count);
      }
    }
    expected.push_back(with_decimals(random[1]["schemes"][r]["bytes"], 0));
    EXPECT_EQ(cells_after(cost, name, '&'), expected);
    const std::vector<std::string> cells = cells_after(text, scheme, ' ');
    ASSERT_GT(cells.size(), 5U);
    EXPECT_EQ(std::vector<std::string>(cells.end() - 5, cells.end()), of_text);
  }
  EXPECT_NE(cells_after(cost, "Spherical deCasteljau", '&')[5], cells_after(cost, "Linear", '&')[5]);
}

TEST_F(CompareFigures, a_weighting_is_that_of_the_figures_and_not_of_their_name_alone) {
  std::map<double, std::string> sums;
  for (const std::string weighting :
       {"area", "angle", "uniform", "area-angle", "max", "inverse-edges", "inverse-roots"}) {
    // Two triangles of different shapes meet at each of two vertices, so every weighting gives a different sum.
    folder_.write("h0.obj", "v 0 0 0\nv 3 0 0\nv 0 1 0\nv 4 2 1\nf 1 2 3\nf 3 2 4\n");
    folder_.write("h1.obj", "v 0 0 0\nv 3 0 1\nv 0 2 0\nv 4 2 -3\nf 1 2 3\nf 3 2 4\n");
    const std::string own =
        " compare h0.obj h1.obj --elements vertices --samples 5 --schemes linear,quadratic --no-times --weighting " +
        weighting;
    const Json json = Json::parse(run_shell(std::string(kProgram) + own + " --json", folder_.path()).out);
    EXPECT_EQ(json["weighting"], weighting);
    const double sum = json["schemes"][1]["sum_degrees"];
    EXPECT_TRUE(sums.emplace(sum, weighting).second) << weighting << " has the sum of " << sums[sum];
    const std::string text = run_shell(std::string(kProgram) + own, folder_.path()).out;
    EXPECT_EQ(cells_after(text, "quadratic", ' ').at(0), with_groups(sum)) << text;
  }
}

TEST_F(CompareFigures, weightings_are_named_and_are_of_vertices) {
  const std::string of_vertices = "--elements vertices --weighting inverse-edges ";
  EXPECT_NE(output(of_vertices).find("vertices, faces weighted by inverse-edges\n"), std::string::npos);
  EXPECT_NE(output(of_vertices + "--json").find("\"weighting\": \"inverse-edges\""), std::string::npos);
  for (const char* const wrong : {"--weighting angle", "--elements vertices --weighting sine",
                                  "--elements vertices --weighting angle --certify", "--weighting area --truth 2"})
    EXPECT_EQ(exit_code_of(wrong), 2) << wrong;
}

TEST_F(CompareFigures, table_counts_shares_in_pairs_of_all_segments) {
  const std::string text = output("");
  for (const char* const line :
       {"\nslerp: 1 of 6 faces in all segments (16.67 %) used another scheme, since slerp is undefined there\n",
        "\n6 samples were left out, since faces without area have no normal\n", "  16.5362  52.2333  180.0000  "})
    EXPECT_NE(text.find(line), std::string::npos) << line << "\nin\n" << text;
  EXPECT_EQ(text.find("left out, since the scheme has no normal there"), std::string::npos) << text;
}

TEST_F(CompareFigures, certificates_stand_beside_what_was_sampled) {
  const Json rows = Json::parse(output("--json --certify"))["schemes"];
  EXPECT_FALSE(Json::parse(output("--json"))["schemes"][0].contains("certified"));
  for (const Json& row : rows) {
    const Json& certified = row["certified"];
    // Element 1 of segment 0 is the face that turns over. Its error bound is 180 degrees for every scheme.
    EXPECT_EQ(certified["upper_degrees"], 180) << row;
    EXPECT_GE(certified["upper_degrees"], row["max_degrees"]);
    EXPECT_EQ(certified["upper_at"]["segment"], 0);
    EXPECT_EQ(certified["upper_at"]["element"], 1);
    EXPECT_EQ(certified["unbounded"], 1);
  }
  const std::string csv = output("--csv --certify");
  EXPECT_NE(csv.find(",trigonometric,certified_lower_degrees,certified_upper_degrees,"), std::string::npos) << csv;
  const std::string table = output("--certify");
  EXPECT_NE(table.find("at most"), std::string::npos) << table;
  EXPECT_NE(table.find("\nlinear: 1 of 6 faces in all segments (16.67 %) has no bound, since a normal vanishes between "
                       "the ends of the segment\n"),
            std::string::npos)
      << table;
}

class CompareTolerance : public testing::Test {
 protected:
  [[nodiscard]] static ProcessResult run(const std::string& arguments) {
    return run_shell(std::string(kProgram) + " compare --sample bend --no-times " + arguments, ".");
  }
};

TEST_F(CompareTolerance, the_cheapest_scheme_within_it_is_named) {
  const auto cheapest = [](const std::string& tolerance) {
    const ProcessResult result = run("--schemes linear,circle:timed,polynomial,slerp --json --tolerance " + tolerance);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out)["cheapest"];
  };
  EXPECT_EQ(cheapest("20"), "linear");
  EXPECT_EQ(cheapest("10"), "polynomial") << "which costs less than circle:timed";
  EXPECT_EQ(cheapest("0.001"), "polynomial");
  EXPECT_NE(
      run("--tolerance 20 --schemes linear")
          .out.find("\nthe cheapest scheme that is always within 20 degrees is linear, with an error of at most 19.7"),
      std::string::npos);
}

TEST_F(CompareTolerance, where_none_is_within_it_the_exit_code_is_4) {
  const ProcessResult result = run("--schemes linear,slerp --json --tolerance 1");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_EQ(result.err,
            "chronormal compare: bend: no scheme is always within the tolerance of 1 degree; compare more schemes with "
            "--schemes, or allow a larger --tolerance\n");
  EXPECT_TRUE(Json::parse(result.out)["cheapest"].is_null());
}

TEST_F(CompareTolerance, what_has_no_meaning_is_refused) {
  EXPECT_EQ(run("--tolerance -1").exit_code, 2);
  EXPECT_EQ(run("--certify --access sequential").exit_code, 2);
  EXPECT_EQ(run("--certify --blend 5").exit_code, 2);
}

}  // namespace
}  // namespace chronormal::compare_cli_test
