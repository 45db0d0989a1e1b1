// Tests how OBJ files are read: the supported parts, the conversion of numbers, and refused files.
#include "io/mesh/obj.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/support/random_edits.h"
#include "tests/support/random_mesh.h"

namespace chronormal::obj_test {
namespace {

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

MeshFrame read_good(const std::string& bytes) {
  Result<MeshFrame> result = read_obj(bytes, "walk.obj");
  if (!result) {
    ADD_FAILURE() << result.error().text();
    return {};
  }
  return std::move(result).value();
}

std::string error_of(const std::string& bytes) {
  const Result<MeshFrame> result = read_obj(bytes, "walk.obj");
  if (result) return "no error";
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidInput);
  return result.error().text();
}

std::vector<std::uint32_t> corners_of(const MeshFrame& frame) {
  return {frame.topology.corners().begin(), frame.topology.corners().end()};
}

using Corners = std::vector<std::uint32_t>;
using Positions = std::vector<float>;

TEST(ReadObj, reads_every_form_of_a_corner) {
  const MeshFrame frame = read_good("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/7/9 2//-8 3/4 4/ -1 1//\nf +1 2 -1\n");
  EXPECT_EQ(corners_of(frame), (Corners{0, 1, 2, 3, 3, 0, 0, 1, 3}));
  EXPECT_EQ(frame.topology.face(0).size(), 6U);
  EXPECT_EQ(frame.topology.face(1).size(), 3U);
}

TEST(ReadObj, keeps_polygons_before_and_after_triangles) {
  const MeshFrame frame = read_good("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 1 2 3 4\nf 4 3 2\n");
  ASSERT_EQ(frame.topology.face_count(), 4U);
  EXPECT_EQ(frame.topology.face(1)[2], 3U);
  EXPECT_EQ(frame.topology.face(2).size(), 4U);
  EXPECT_EQ(frame.topology.face(3)[0], 3U);
}

TEST(ReadObj, all_line_ends_tabs_comments_and_a_byte_order_mark_change_nothing) {
  const MeshFrame frame = read_good(kTriangle);
  for (const char* const bytes :
       {"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3",
        "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "\t v\t0 \t0  0 \n\n  v 1 0 0 #x\nv 0 1 0 # y\n f 1 2 3 #\n",
        "v 0 0 0\nv 1 \\\n0 \\\r\n 0\nv 0 1 0\nf 1\\\n2 3\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 \\"}) {
    const MeshFrame other = read_good(bytes);
    EXPECT_EQ(other.topology, frame.topology) << bytes;
    EXPECT_EQ(other.positions, frame.positions) << bytes;
  }
}

TEST(ReadObj, comment_is_not_continued_by_a_backslash) {
  EXPECT_EQ(read_good("v 0 0 0\nv 1 0 0\n# from C:\\models\\\nv 0 1 0\nf 1 2 3\n").positions.size(), 9U);
}

TEST(ReadObj, other_statements_and_further_numbers_of_a_vertex_are_left_out) {
  const MeshFrame frame = read_good(
      "mtllib v.mtl\no v\ng f 1 2\nvt 9 nan\nvn x\nvp 1\nv 1 2 3 1\nv 4 5 6 0.5 0.5 0.5\nv 7 8 9 1 nan 1e99\nusemtl f\n"
      "s off\nl 1 99\np 77\ncurv 1 2\nv1 2 3\n42\nf 1 2 3\n");
  EXPECT_EQ(frame.positions, (Positions{1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(ReadObj, positive_indices_may_name_vertices_that_follow) {
  EXPECT_EQ(corners_of(read_good("f 1 2 3\nv 0 0 0\nv 1 0 0\nf -1 -2 3\nv 0 1 0\n")), (Corners{0, 1, 2, 1, 0, 2}));
}

TEST(ReadObj, numbers_are_rounded_to_the_nearest_float_and_tiny_ones_to_zero) {
  const MeshFrame frame = read_good(
      "v .5 -1. +1e+2\nv 1e-50 -1e-400 1e-46\nv 1.4e-45 1e-40 3.4028235e38\nv 0e999 00.1 0.000000000000000001e18\n"
      "f 1 2 3\n");
  EXPECT_TRUE(test::same_bits(frame.positions,
                              {0.5F, -1.0F, 100.0F, 0.0F, -0.0F, 0.0F, std::numeric_limits<float>::denorm_min(), 1e-40F,
                               std::numeric_limits<float>::max(), 0.0F, 0.1F, 1.0F}));
}

TEST(ReadObj, numbers_of_any_length_are_those_of_strtof) {
  std::mt19937_64 random(9);
  std::string bytes;
  std::vector<float> expected;
  const auto digits = [&](std::size_t count) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) text += static_cast<char>('0' + random() % 10);
    return text;
  };
  for (int i = 0; i < 30000; ++i) {
    std::string number = random() % 2 == 0 ? "-" : "";
    number += digits(random() % 12) + "." + digits(1 + random() % 12);
    if (random() % 3 == 0) number += (random() % 2 == 0 ? "e-" : "e") + std::to_string(random() % 20);
    // Every fifth number is exactly in the middle between two floats, or slightly above the middle.
    if (i % 5 == 0) {
      const auto odd = static_cast<double>((random() % (1U << 24U)) * 2 + 1);
      number = std::to_string(static_cast<long long>(odd)) + (i % 10 == 0 ? "" : ".00000000001");
    }
    bytes += (i % 3 == 0 ? "\nv " : " ") + number;
    expected.push_back(std::strtof(number.c_str(), nullptr));
  }
  EXPECT_TRUE(test::same_bits(read_good(bytes + "\nf 1 2 3\n").positions, expected));
}

TEST(ReadObj, bad_coordinates_are_errors_with_line_and_vertex) {
  EXPECT_EQ(error_of("v 0 0 0\n\nv 1 nan 0\n"),
            "walk.obj, line 3: y of vertex 1: 'nan' is NaN or infinite; write a finite number");
  EXPECT_EQ(error_of("v 0 0\n"),
            "walk.obj, line 1: z of vertex 0: a number is missing here; add it, or export the file again");
  EXPECT_EQ(error_of("v 0 0 1.5x\n"),
            "walk.obj, line 1: z of vertex 0: '1.5x' is not a valid number here; correct it, or export the file again");
  EXPECT_EQ(error_of("v 1e39 0 0\n"),
            "walk.obj, line 1: x of vertex 0: '1e39' is too large for float32; write a smaller number");
  for (const char* const word : {"inf",
                                 "-inf",
                                 "+nan",
                                 "infinity",
                                 "nan(1)",
                                 "1#x",
                                 "1e400",
                                 "-1e400",
                                 "1e999999999999999999999",
                                 "0x10",
                                 "1,5",
                                 "--1",
                                 "+-1",
                                 "+",
                                 "-",
                                 ".",
                                 "e5",
                                 "1e",
                                 "1.2.3",
                                 "1.#QNAN",
                                 "1e5e5",
                                 "100000000000000000000000000000000000000000.0"}) {
    const std::string error = error_of(std::string(kTriangle) + "v 0 " + word + " 0\n");
    EXPECT_TRUE(error.starts_with("walk.obj, line 5: y of vertex 3: ")) << error;
  }
  EXPECT_NE(error_of("v 1 2 3 4x\n").find("'4x' is not a valid number"), std::string::npos);
}

TEST(ReadObj, bad_indices_are_errors_with_line_face_and_corner) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(
      error_of(three + "f 1 2 3\nf 1 4 2\nf 1 2 3\n"),
      "walk.obj, line 5: corner 1 of face 1 refers to vertex 4, but the file has 3 vertices; export the file again");
  EXPECT_EQ(error_of(three + "f 1 2 -4\nv 0 0 0"),
            "walk.obj, line 4: corner 2 of face 0 refers to vertex -4, but the file has 3 vertices so far; export the "
            "file again");
  EXPECT_EQ(error_of(three + "f 1 0 2\n"),
            "walk.obj, line 4: corner 1 of face 0: '0' is not allowed, since vertices are counted from 1; export the "
            "file again");
  // The reader skips faces with fewer than three corners, so this file has no faces.
  EXPECT_EQ(error_of(three + "f 1 2\n"),
            "walk.obj, line 4: the file has no faces (lines that begin with f); export a mesh with faces");
  EXPECT_EQ(
      error_of(three + "f 1 5\nf 1 2 3\n"),
      "walk.obj, line 4: corner 1 of face 0 refers to vertex 5, but the file has 3 vertices; export the file again");
  EXPECT_EQ(error_of(three + "f 1 2 4294967298\n"),
            "walk.obj, line 4: corner 2 of face 0 refers to vertex 4294967298, but the file has 3 vertices; export the "
            "file again");
  EXPECT_EQ(error_of(three + "f 1 2 99999999999999999999\n"),
            "walk.obj, line 4: corner 2 of face 0: '99999999999999999999' is a larger index than a mesh can have; "
            "export the file again");
  for (const char* const word : {"1.5", "1/x", "1/2/3/4", "/1", "//", "1//1x", "a", "1/2.5", "-", "1-2"})
    EXPECT_TRUE(error_of(three + "f 1 2 " + word + "\n").starts_with("walk.obj, line 4: corner 2 of face 0: ")) << word;
}

TEST(ReadObj, place_of_a_statement_of_several_lines_is_its_first_line) {
  EXPECT_TRUE(error_of("v 0 0 0\nv 0 \\\n0 \\\nx\nf 1 1 1\n").starts_with("walk.obj, line 2: "));
  EXPECT_TRUE(error_of("v 0 0 0\nv 0 \\\n0 \\\n0\nf 1 1 9\n").starts_with("walk.obj, line 5: "));
}

TEST(ReadObj, file_without_vertices_or_faces_is_an_error) {
  EXPECT_EQ(error_of(""), "walk.obj, line 1: the file has no vertices (lines that begin with v); export a mesh");
  EXPECT_EQ(error_of("v 0 0 0\nl 1 1\n"),
            "walk.obj, line 2: the file has no faces (lines that begin with f); export a mesh with faces");
}

TEST(ReadObj, strange_bytes_do_not_reach_the_message) {
  EXPECT_EQ(
      error_of(std::string("v \x1b[31m\xff 0 0\n")),
      "walk.obj, line 1: x of vertex 0: '?[31m?' is not a valid number here; correct it, or export the file again");
  EXPECT_LT(error_of(std::string("v ").append(100000, 'a')).size(), 160U);
}

RC_GTEST_PROP(WriteObj, what_was_written_reads_back_bit_for_bit, ()) {
  const MeshFrame frame = test::random_mesh();
  const Result<MeshFrame> back = read_obj(write_obj(frame.topology, test::positions_of(frame)), "back.obj");
  RC_ASSERT(back.ok());
  RC_ASSERT(back.value().topology == frame.topology);
  RC_ASSERT(test::same_bits(back.value().positions, frame.positions));
}

TEST(WriteObj, writes_the_fewest_digits) {
  const MeshFrame frame = read_good("v 0.1 -0 1e20\nv 1 2 3\nv 4 5 16777216\nf 3 1 2\n");
  EXPECT_EQ(write_obj(frame.topology, test::positions_of(frame)), "v 0.1 -0 1e+20\nv 1 2 3\nv 4 5 16777216\nf 3 1 2\n");
}

MeshFrame shading_of(const std::string& bytes) {
  Result<MeshFrame> result = read_obj_shading(bytes, "walk.obj");
  if (!result) {
    ADD_FAILURE() << result.error().text();
    return {};
  }
  return std::move(result).value();
}

std::string shading_error_of(const std::string& bytes) {
  const Result<MeshFrame> result = read_obj_shading(bytes, "walk.obj");
  if (result) return "no error";
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidInput);
  return result.error().text();
}

TEST(ReadObj, faces_of_fewer_than_three_corners_are_left_out_and_counted) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1 2\nf 1//1 2//1 3//1\nf\nf 3 2 1\n";
  const MeshFrame mesh = read_good(text);
  EXPECT_EQ(mesh.topology, Topology::triangles(3, {0, 1, 2, 2, 1, 0}).value());
  ASSERT_EQ(mesh.notes.size(), 1U);
  EXPECT_EQ(mesh.notes[0], "2 faces have fewer than three corners and are left out");
  const MeshFrame shading = shading_of("f 1//1 2\n" + text + "s 1\nf 1 2\nf 2 1 3\n");
  EXPECT_EQ(shading.normal_of_corner.size(), 27U);
  EXPECT_EQ(shading.normal_of_corner[2], 1);
  EXPECT_EQ(shading.group_of_face, (Corners{0, 0, 1}));
}

TEST(ReadObj, positions_count_from_the_origin_before_they_are_rounded) {
  const std::string text =
      "v 452312.123 5411873.456 101.5\nv 452313.001 5411873 101\nv 452312 5411874.009 1e2\nf 1 2 3\n";
  const Result<MeshFrame> far = read_obj(text, "utm.obj", {452312, 5411873, 0});
  ASSERT_TRUE(far.ok()) << far.error().text();
  EXPECT_TRUE(far.value().has_more_digits);
  EXPECT_NEAR(far.value().positions[0], 0.123, 1e-7);
  EXPECT_NEAR(far.value().positions[7], 1.009, 1e-6);
  EXPECT_EQ(far.value().positions[2], 101.5F);
  // has_more_digits must be false if float32 would keep all digits of the numbers even without the subtraction of the
  // origin.
  EXPECT_FALSE(read_obj("v 1024.5 2048.25 4\nv 1024 2048 4\nv 1025 2049 4\nf 1 2 3\n", "a.obj", {1024, 2048, 4})
                   .value()
                   .has_more_digits);
  EXPECT_FALSE(
      read_obj("v 10.123456 0 0\nv 10.5 0 1\nv 10.25 1 0\nf 1 2 3\n", "a.obj", {10, 0, 0}).value().has_more_digits);
}

TEST(ReadObjShading, groups_are_numbered_as_the_file_names_them) {
  const MeshFrame shading = shading_of(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ns 4\nf 1 2 3\nf 1 2 3\ns off\nf 1 2 3\ns fur # no dog\nf 1 2 3\ns 04\n"
      "f 1 2 3\ns 0\nf 1 2 3\ns 4x\nf 1 2 3\n");
  EXPECT_EQ(shading.group_of_face, (Corners{0, 1, 1, 0, 2, 1, 0, 3}));
  EXPECT_TRUE(shading.normal_of_corner.empty());
  EXPECT_EQ(shading.topology.face_count(), 8U);
}

TEST(ReadObjShading, normals_are_those_of_the_corners) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(shading_of(three + "vn 1 0 0\nvn 0 2 0\nf 1//2 2//-2 3/9/3\nvn 0 0 -.5\n").normal_of_corner,
            (Positions{0, 2, 0, 1, 0, 0, 0, 0, -0.5F}));
  EXPECT_EQ(shading_of(three + "vn 1 0 0\nf 1//1 2 3/1\nf 1// 2/1/ 3//1\n").normal_of_corner,
            (Positions{1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0}))
      << "corners without a normal have (0, 0, 0)";
}

TEST(ReadObjShading, is_empty_where_the_file_says_nothing) {
  const MeshFrame shading = shading_of(std::string("vn 0 0 1\nvt 0 0\n") + kTriangle);
  EXPECT_TRUE(shading.group_of_face.empty());
  EXPECT_TRUE(shading.normal_of_corner.empty());
  EXPECT_EQ(shading.topology, read_good(kTriangle).topology);
  EXPECT_EQ(shading_of(std::string("s off\n") + kTriangle).group_of_face, (Corners{0}));
}

TEST(ReadObjShading, bad_normals_are_errors_with_line_and_corner) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(shading_error_of("vn 0 nan 1\n" + three),
            "walk.obj, line 1: y of normal 0: 'nan' is NaN or infinite; write a finite number");
  EXPECT_EQ(shading_error_of("vn 1 2 3\nvn 1 2\n"),
            "walk.obj, line 2: z of normal 1: a number is missing here; add it, or export the file again");
  EXPECT_EQ(shading_error_of(three + "f 1 2 4\n"), error_of(three + "f 1 2 4\n"));
  // The reader complains about invalid normals only if the caller asks for normals.
  EXPECT_EQ(error_of(three + "vn 0 nan\ns\nf 1//0 2//99 3//99999999999999999999\n"), "no error");
}

// A corner may refer to a normal that is missing in the file. Since other programs show such files, the reader returns
// positions and faces, and the corner has no normal.
TEST(ReadObjShading, normals_that_are_not_there_and_nameless_groups_are_counted) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto notes_of = [&](const std::string& rest) { return shading_of(three + rest).notes; };
  EXPECT_EQ(notes_of("vn 0 0 1\nf 1//1 2//2 3//1\nf 1 2 3\n"),
            (std::vector<std::string>{
                "1 corner refers to a normal that the file does not have, so this normal is left out"}));
  for (const char* const corner :
       {"3//-1", "3//0", "3//4294967296", "3//99999999999999999999", "3//4294967295", "3//-9999999999"}) {
    const MeshFrame mesh = shading_of(three + "f 1 2 " + corner + "\nvn 0 0 1\n");
    EXPECT_EQ(mesh.notes.size(), 1U) << corner;
    EXPECT_TRUE(mesh.normal_of_corner.empty()) << corner;
  }
  EXPECT_TRUE(notes_of("f 1 2 3//1\nvn 0 0 1\n").empty());
  const MeshFrame grouped = shading_of(three + "s 2\nf 1 2 3\ns\nf 1 2 3\n");
  EXPECT_EQ(grouped.group_of_face, (Corners{1, 0}));
  EXPECT_EQ(grouped.notes,
            (std::vector<std::string>{"1 line begins with s but names no smoothing group, and is read as 's off'"}));
}

TEST(ReadObjShading, damaged_bytes_give_an_error_or_what_belongs_to_the_mesh) {
  const std::string whole =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nvn 0 0 1\nvn 1 0 0\ns 1\nf 1//1 2//2 3//-1\ns off\nf 2//1 4//1 3//1 1\n";
  std::mt19937 random(5);
  std::size_t good = 0, refused = 0;
  for (int round = 0; round < 5000; ++round) {
    const std::string bytes = test::with_random_edits(whole, random);
    const Result<MeshFrame> shading = read_obj_shading(bytes, "walk.obj");
    const Result<MeshFrame> mesh = read_obj(bytes, "walk.obj");
    if (!shading) {
      EXPECT_TRUE(shading.error().place.starts_with("walk.obj, line ")) << shading.error().text();
      ++refused;
      continue;
    }
    ++good;
    ASSERT_TRUE(mesh.ok()) << bytes;
    const MeshFrame& frame = shading.value();
    EXPECT_EQ(frame.topology, mesh.value().topology);
    EXPECT_EQ(frame.positions, mesh.value().positions);
    EXPECT_TRUE(frame.group_of_face.empty() || frame.group_of_face.size() == frame.topology.face_count());
    EXPECT_TRUE(frame.normal_of_corner.empty() || frame.normal_of_corner.size() == 3 * frame.topology.corner_count());
    for (const float component : frame.normal_of_corner) EXPECT_TRUE(std::isfinite(component));
  }
  EXPECT_GT(good, 200U);
  EXPECT_GT(refused, 500U);
}

TEST(WriteObj, normals_read_back_corner_by_corner) {
  const MeshFrame frame = read_good("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 2 3 4\n");
  const Positions normals = {0, 0, 1, 0, 0.6F, 0.8F};
  const Corners of_corner = {0, 1, 0, 1, 1, 0, 0};
  const std::string text = write_obj(frame.topology, test::positions_of(frame),
                                     VectorView<const float>::packed(normals.data(), 2), of_corner);
  EXPECT_TRUE(text.ends_with("v 0 1 0\nvn 0 0 1\nvn 0 0.6 0.8\nf 1//1 2//2 3//1\nf 1//2 2//2 3//1 4//1\n")) << text;
  const MeshFrame back = shading_of(text);
  EXPECT_EQ(back.topology, frame.topology);
  for (std::size_t c = 0; c < of_corner.size(); ++c) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(back.normal_of_corner.at(3 * c + k), normals[3 * of_corner[c] + k]);
  }
}

}  // namespace
}  // namespace chronormal::obj_test
