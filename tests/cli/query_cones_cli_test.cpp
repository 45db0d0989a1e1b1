// Tests the results of `query cones` and `query shutter` that scripts and people read.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/array_file.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::query_cones_cli_test {
namespace {

using Json = nlohmann::json;

class QueryCones : public testing::Test {
 protected:
  // Writes two keyframes of two triangles. The first triangle turns by a right angle about the x axis, and the second
  // stands still.
  QueryCones() {
    folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\nf 4 5 6\n");
    folder_.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\nf 4 5 6\n");
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments) const {
    return run_shell(std::string(kProgram) + " query " + arguments, folder_.path());
  }
  [[nodiscard]] Json json_of(const std::string& arguments) const {
    const ProcessResult result = run(arguments + " --json");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out);
  }

  test::TemporaryFolder folder_;
};

TEST_F(QueryCones, have_a_row_for_each_segment_and_face) {
  const Json json = json_of("cones a.obj b.obj a.obj");
  const Json& arrays = json.at("arrays");
  EXPECT_EQ(arrays.at("segment"), Json({0, 0, 1, 1}));
  EXPECT_EQ(arrays.at("face"), Json({0, 1, 0, 1}));
  for (const std::size_t row : {0U, 2U}) {
    EXPECT_NEAR(arrays.at("half_angle")[row].get<double>(), 45, 1e-3);
    EXPECT_GE(arrays.at("half_angle")[row].get<double>(), 45);
    EXPECT_NEAR(arrays.at("axis")[row][1].get<double>(), -std::sqrt(0.5), 1e-6);
  }
  EXPECT_LT(arrays.at("half_angle")[1].get<double>(), 1e-4);
  EXPECT_EQ(arrays.at("axis")[1], Json({0.0, 0.0, 1.0}));
  EXPECT_EQ(json.at("summary").at("whole_sphere"), 0);
  EXPECT_EQ(arrays.size(), 5u);
  // In the first half of the motion, the first face turns by less than half of its whole angle.
  EXPECT_LT(json_of("cones a.obj b.obj --to 0.5").at("arrays").at("half_angle")[0].get<double>(), 30);
}

TEST_F(QueryCones, of_meshlets_are_as_meshoptimizer_has_them) {
  EXPECT_EQ(run("cones --sample cloth --to 0.5 --meshlets 32 -o found.npz").exit_code, 0);
  const auto arrays = test::parse_npz(test::read_whole(folder_ / "found.npz"));
  const std::vector<std::size_t> shape = arrays.at("meshlet_center").shape;
  ASSERT_EQ(shape.size(), 2u);
  const std::size_t rows = shape[0];
  EXPECT_GT(rows, 10u);
  for (const char* const name : {"segment", "index", "radius", "cone_cutoff", "cone_cutoff_s8"})
    EXPECT_EQ(arrays.at(std::string("meshlet_") + name).shape, std::vector<std::size_t>{rows}) << name;
  for (const char* const name : {"cone_apex", "cone_axis", "cone_axis_s8"})
    EXPECT_EQ(arrays.at(std::string("meshlet_") + name).shape, (std::vector<std::size_t>{rows, 3})) << name;
  // Every face is in one meshlet, and no meshlet has more than 32 faces.
  const auto faces = arrays.at("member_face").as<std::int64_t>(),
             meshlets = arrays.at("member_meshlet").as<std::int64_t>();
  std::vector<int> seen(faces.size()), size(rows);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    ++seen.at(static_cast<std::size_t>(faces[i]));
    ++size.at(static_cast<std::size_t>(meshlets[i]));
  }
  for (const int times : seen) EXPECT_EQ(times, 1);
  for (const int count : size) EXPECT_LE(count, 32);
  EXPECT_EQ(faces.size(), arrays.at("face").shape[0]);
}

TEST_F(QueryCones, refuse_meshlets_that_cannot_be) {
  folder_.write("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  for (const char* const wrong :
       {"a.obj b.obj --meshlets 3", "a.obj b.obj --meshlets 516", "quad.obj quad.obj --meshlets 8"}) {
    const ProcessResult result = run(std::string("cones ") + wrong);
    EXPECT_EQ(result.exit_code, 2) << wrong;
    EXPECT_NE(result.err.find("--meshlets"), std::string::npos) << result.err;
  }
  const ProcessResult other = run("collapse a.obj b.obj --meshlets 8");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("this option is only for query cones"), std::string::npos) << other.err;
}

TEST_F(QueryCones, and_shutter_are_tables_for_people) {
  const ProcessResult cones = run("cones a.obj b.obj"), shutter = run("shutter a.obj b.obj");
  EXPECT_EQ(cones.exit_code, 0);
  EXPECT_EQ(shutter.exit_code, 0);
  EXPECT_NE(cones.out.find("half angle"), std::string::npos) << cones.out;
  EXPECT_NE(shutter.out.find("ends off"), std::string::npos) << shutter.out;
}

TEST_F(QueryCones, shutter_has_the_mean_of_every_face_and_of_the_whole_span) {
  const Json json = json_of("shutter a.obj b.obj a.obj");
  const Json& arrays = json.at("arrays");
  EXPECT_EQ(arrays.at("segment"), Json({0, 0, 1, 1}));
  // n(t) = (0, -t, 1 - t). By symmetry, the mean of the unit normals points at 45 degrees between -y and z. The mean of
  // n(t) is (0, -1, 1) / 2.
  EXPECT_EQ(arrays.at("mean")[0], Json({0.0, -0.5, 0.5}));
  const double y = arrays.at("mean_unit")[0][1].get<double>(), z = arrays.at("mean_unit")[0][2].get<double>();
  EXPECT_NEAR(y, -z, 1e-9);
  EXPECT_NEAR(z, std::asinh(1.0) * std::sqrt(0.5), 1e-7);
  EXPECT_NEAR(arrays.at("length")[0].get<double>(), std::hypot(y, z), 1e-12);
  EXPECT_LT(arrays.at("ends_off")[0].get<double>(), 1e-5);
  EXPECT_NEAR(arrays.at("length")[1].get<double>(), 1, 1e-7);
  // The motion returns to its start, so the normals at both ends of the motion are equal. Interpolation between the two
  // ends therefore misses the motion.
  EXPECT_EQ(arrays.at("span_face"), Json({0, 1}));
  EXPECT_NEAR(arrays.at("span_ends_off")[0].get<double>(), 45, 1e-5);
  EXPECT_NEAR(arrays.at("span_mean_unit")[0][2].get<double>(), z, 1e-9);
  EXPECT_EQ(json_of("shutter a.obj b.obj a.obj --to 0.75").at("arrays").count("span_face"), 0u);
}

}  // namespace
}  // namespace chronormal::query_cones_cli_test
