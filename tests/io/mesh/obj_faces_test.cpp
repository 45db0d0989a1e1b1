// Tests the fast reader of positions, for files that have the same faces as an earlier file. The fast reader must
// return the same positions as the full reader.
#include "io/mesh/obj_faces.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/mesh/obj.h"
#include "tests/support/random_edits.h"
#include "tests/support/random_mesh.h"

namespace chronormal::obj_faces_test {
namespace {

const std::string kFaces = "vt 0 0\nf 1/1 2/1 3/1\ng more\nf 3 2 4\n";

std::string vertices(int of_first) {
  return "# frame\nv " + std::to_string(of_first) + " 0 0\nv 1 0 1e-3\nv 0 1 -0\nv 1 1 2.5\n";
}

std::optional<std::vector<float>> positions_like(const std::string& first, const std::string& bytes) {
  const Result<MeshFrame> read = read_obj(first, "first.obj");
  if (!read) {
    ADD_FAILURE() << read.error().text();
    return std::nullopt;
  }
  return ObjFaces(first, read.value().positions).positions_of(bytes);
}

TEST(ObjFaces, of_the_same_text_leave_only_vertices_to_read) {
  const auto positions = positions_like(vertices(0) + kFaces, vertices(7) + kFaces);
  ASSERT_TRUE(positions);
  EXPECT_TRUE(test::same_bits(*positions, read_obj(vertices(7) + kFaces, "x").value().positions));
  // A program may write other comments, normals and line ends in each file of a sequence.
  const std::string other = "# another frame\r\n" + vertices(8) + "vn 0 0 1\n" + kFaces;
  ASSERT_TRUE(positions_like(vertices(0) + kFaces, other));
}

TEST(ObjFaces, vertices_among_them_are_those_of_the_first_file) {
  const std::string tail = "f 1 2 3\nv 5 5 5\nv 6 6 6\nf -1 -2 1\n";
  const auto positions = positions_like(vertices(0) + tail, vertices(7) + tail);
  ASSERT_TRUE(positions);
  EXPECT_TRUE(test::same_bits(*positions, read_obj(vertices(7) + tail, "x").value().positions));
}

TEST(ObjFaces, whatever_takes_more_than_a_look_is_left_to_the_reader) {
  const std::string first = vertices(0) + kFaces;
  for (const std::string& bytes : {
           vertices(7) + "f 1 2 3\n" + kFaces,          // one face more
           vertices(7) + "v 0 0 0\n" + kFaces,          // one vertex more
           vertices(7) + "v 0 0 nan\n" + kFaces,        // NaN
           vertices(7) + "v 0 0 0 1\n" + kFaces,        // a fourth number
           vertices(7) + "o name \\\n" + kFaces,        // a line that continues in the next
           "\xEF\xBB\xBF" + vertices(7) + kFaces,       // a byte order mark
           vertices(7) + "vt 0 0\nf 1 2 3\nf 3 2 4\n",  // vertices and faces in other places
           std::string("v 7 0 0\n") + kFaces,           // too few vertices
           kFaces,
           std::string(),
       })
    EXPECT_FALSE(positions_like(first, bytes)) << bytes;
}

TEST(ObjFaces, after_random_edits_agree_with_the_reader_or_leave_it_to_it) {
  const std::string first = vertices(0) + kFaces;
  const Result<MeshFrame> read = read_obj(first, "first.obj");
  const ObjFaces faces(first, read.value().positions);
  std::mt19937 random(12);
  std::size_t same = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string bytes = test::with_random_edits(first, random);
    const auto positions = faces.positions_of(bytes);
    if (!positions) continue;
    ++same;
    const Result<MeshFrame> whole = read_obj(bytes, "edited.obj");
    ASSERT_TRUE(whole) << whole.error().text() << "\n" << bytes;
    EXPECT_TRUE(test::same_bits(*positions, whole.value().positions)) << bytes;
    EXPECT_EQ(whole.value().topology, read.value().topology) << bytes;
  }
  EXPECT_GT(same, 100U);
}

}  // namespace
}  // namespace chronormal::obj_faces_test
