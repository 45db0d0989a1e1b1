// Tests the results of `query contain` that scripts and people read: points at rest and in motion, the arrays, and the
// reasons why a mesh or a file is refused.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/cache/npz.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::query_contain_cli_test {
namespace {

using Json = nlohmann::json;

class QueryContainCli : public testing::Test {
 protected:
  // Writes three keyframes of a tetrahedron that doubles its size and shrinks back.
  QueryContainCli() {
    const std::string faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    const std::string small = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\n", large = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\n";
    folder_.write("a.obj", small + faces);
    folder_.write("b.obj", large + faces);
    folder_.write("c.obj", small + faces);
    folder_.write("open.obj", small + "f 1 3 2\nf 1 2 4\nf 2 3 4\n");
    folder_.write("rest.npy", NpyBytes({2, 3}, std::vector<double>{0.25, 0.25, 0.25, 1, 1, 1}).bytes());
    folder_.write("move.npy", NpyBytes({1, 2, 3}, std::vector<double>{-1, 0.5, 0.5, 7, 0.5, 0.5}).bytes());
  }

  [[nodiscard]] ProcessResult run(const std::string& arguments) const {
    return run_shell(std::string(kProgram) + " query contain " + arguments, folder_.path());
  }
  [[nodiscard]] Json arrays_of(const std::string& arguments) const {
    const ProcessResult result = run(arguments + " --json");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out).at("arrays");
  }

  test::TemporaryFolder folder_;
};

TEST_F(QueryContainCli, points_that_rest_are_inside_and_pass_the_surface_at_times_of_the_motion) {
  const Json arrays = arrays_of("a.obj b.obj c.obj --points rest.npy --fps .5");
  EXPECT_EQ(arrays.at("inside"), Json({true, false}));
  EXPECT_EQ(arrays.at("crossing_point"), Json({1, 1}));
  EXPECT_EQ(arrays.at("crossing_segment"), Json({0, 1}));
  EXPECT_EQ(arrays.at("crossing_face"), Json({2, 2}));
  EXPECT_EQ(arrays.at("crossing_inward"), Json({true, false}));
  // The points cross the face x + y + z = 3 at t = 1/2 of both segments, each of which takes two seconds.
  EXPECT_NEAR(arrays.at("crossing_time").at(0).get<double>(), 1, 1e-12);
  EXPECT_NEAR(arrays.at("crossing_time").at(1).get<double>(), 3, 1e-12);
  for (const Json& x : arrays.at("crossing_normal").at(0)) EXPECT_NEAR(x.get<double>(), 0.57735026918962584, 1e-12);
}

TEST_F(QueryContainCli, points_that_move_do_so_from_the_first_keyframe_to_the_last) {
  const Json arrays = arrays_of("a.obj b.obj c.obj --points move.npy");
  EXPECT_EQ(arrays.at("inside"), Json({false}));
  EXPECT_EQ(arrays.at("crossing_inward"), Json({true, false}));
  // After s seconds, the point is at x = -1 + 4 s, with y + z = 1. The point enters the tetrahedron at x = 0. The
  // slanted face is the plane x + y + z = 2 + 2 s or, in the second segment, x + y + z = 6 - 2 s.
  EXPECT_NEAR(arrays.at("crossing_time").at(0).get<double>(), 0.25, 1e-12);
  EXPECT_NEAR(arrays.at("crossing_time").at(1).get<double>(), 1, 1e-12);
}

TEST_F(QueryContainCli, a_span_has_its_own_first_instant) {
  const Json arrays = arrays_of("a.obj b.obj c.obj --points move.npy --from 0.5");
  EXPECT_EQ(arrays.at("inside"), Json({true}));
  EXPECT_EQ(arrays.at("crossing_inward"), Json({false}));
  EXPECT_EQ(arrays_of("a.obj b.obj c.obj --points rest.npy --from .6 --to 1.4").at("crossing_point"), Json::array());
}

TEST_F(QueryContainCli, refusals_say_what_is_wrong) {
  const auto expect = [this](const std::string& arguments, int exit_code, const std::string& words) {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments;
    EXPECT_NE(result.err.find(words), std::string::npos) << words << " in " << result.err;
  };
  folder_.write("open2.obj", "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
  expect("open.obj open2.obj --points rest.npy", 3,
         "face 0: the mesh is not closed, so points cannot be inside it; 3 edges have a face on one side only (fill "
         "such holes)");
  expect("a.obj b.obj", 2, "--points: the points are missing; name a .npy file of points with --points");
  expect("a.obj b.obj --points none.npy", 1, "none.npy: ");
  expect("a.obj b.obj --points a.obj", 3, "a.obj, header: this is not a NumPy array");
  folder_.write("flat.npy", NpyBytes({3}, std::vector<double>{1, 2, 3}).bytes());
  expect("a.obj b.obj --points flat.npy", 3,
         "points must be an array of float32 or float64 with the shape (n, 3), or (n, 2, 3) if they move");
  folder_.write("far.npy", NpyBytes({1, 2, 3}, std::vector<double>{1, 2, 3, 4, 1e39, 6}).bytes());
  expect("a.obj b.obj --points far.npy", 3, "far.npy, [0, 1, 1]: ");
}

}  // namespace
}  // namespace chronormal::query_contain_cli_test
