#include "io/cache/md2.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/cache_bytes.h"

namespace chronormal::md2_test {
namespace {

using std::string_literals::operator""s;

std::string error_with(std::size_t at, const std::string& raw) {
  const Result<Motion> result = read_md2(test::small_md2().replace(at, raw.size(), raw), "imp.md2");
  EXPECT_FALSE(result.ok());
  return result ? "" : result.error().text();
}

TEST(ReadMd2, reads_frames_as_keyframes_and_turns_the_triangles_round) {
  const Result<Motion> result = read_md2(test::small_md2(), "imp.md2", 10);
  ASSERT_TRUE(result.ok()) << result.error().text();
  const Motion& motion = result.value();
  EXPECT_EQ(motion.topology, Topology::triangles(3, {0, 1, 2}).value());  // the file stores 0 2 1
  ASSERT_EQ(motion.keyframes.size(), 2U);
  EXPECT_EQ(motion.keyframes[0].positions, (std::vector<float>{-1, 0, 1, 126.5F, 0, 1, -1, 63.75F, 3}));
  EXPECT_EQ(motion.keyframes[1].positions, (std::vector<float>{-1, 0, 1, 126.5F, 0, 1, -1, 63.5F, 3}));
  EXPECT_EQ(motion.keyframes[0].name, "stand01");
  EXPECT_EQ(motion.keyframes[1].name, "run");
  EXPECT_EQ(motion.keyframes[1].time, 0.1);
  EXPECT_EQ(motion.segments.size(), 1U);
}

TEST(ReadMd2, clips_are_apart) {
  // Reads an MD2 model whose frames have the given names. Returns the segments and the kind of its motion as text, or
  // the error.
  const auto segments_of = [](const std::vector<std::string>& names) {
    const std::string small = test::small_md2(), head = small.substr(0, 80), frame = small.substr(80, 52);
    std::string bytes = head;
    bytes[40] = static_cast<char>(names.size());
    for (const std::string& name : names) {
      std::string own = frame;
      std::string label = name;
      label.resize(16, '\0');
      bytes += own.replace(24, 16, label);
    }
    const Result<Motion> motion = read_md2(bytes, "imp.md2", 10);
    std::string text;
    if (!motion) return motion.error().text();
    for (const auto& [from, to] : motion.value().segments) text += std::to_string(from) + std::to_string(to) + ' ';
    return text + std::string(motion_kind_name(motion.value().kind));
  };
  EXPECT_EQ(segments_of({"stand01", "stand02", "run1", "run2", "run3"}), "01 23 34 animation");
  EXPECT_EQ(segments_of({"death101", "death102", "death201", "death202"}), "01 23 animation");
  EXPECT_EQ(segments_of({"stand01", "stand02", "stand03"}), "01 12 sequence");
  EXPECT_EQ(segments_of({"frame1", "frame3", "frame5"}), "01 12 sequence");
  EXPECT_EQ(segments_of({"run1", "run3", "run4", "run6"}), "01 12 23 sequence");
  EXPECT_EQ(segments_of({"a", "b", "c"}), "01 12 sequence");
  EXPECT_EQ(segments_of({"pose1", "idle1", "idle2", "fire1"}), "12 animation");
}

TEST(ReadMd2, errors_say_where_and_what) {
  EXPECT_EQ(error_with(0, "IDP3"),
            "imp.md2, byte 0: this is not an MD2 file, since it does not begin with IDP2; name an .md2 file");
  EXPECT_EQ(error_with(4, "\x0F"), "imp.md2, byte 4: version 15 of MD2 cannot be read; export the file as version 8");
  EXPECT_EQ(
      error_with(16, "\x35"),
      "imp.md2, byte 16: the size of a frame in the header is 53, but 3 vertices take 52 bytes; export the file again");
  EXPECT_EQ(error_with(24, "\0"s),
            "imp.md2, byte 24: the number of vertices is 0, but must be at least 1; export a mesh with vertices");
  EXPECT_EQ(error_with(32, "\0"s),
            "imp.md2, byte 32: the number of triangles is 0, but must be at least 1; export at least one triangle");
  EXPECT_EQ(error_with(40, "\1"),
            "imp.md2, byte 40: the number of frames is 1, but must be at least 2; export at least two frames");
  EXPECT_EQ(error_with(40, "\xFF\xFF\xFF\x7F"),
            "imp.md2, byte 56: the file is cut off, since it should have 2,147,483,647 frames from byte 80 on, but has "
            "only 184 bytes; copy or export it again");
  EXPECT_EQ(error_with(56, "\xFF\xFF\xFF\xFF"),
            "imp.md2, byte 56: the file is cut off, since it should have 2 frames from byte -1 on, but has only 184 "
            "bytes; copy "
            "or export it again");
  EXPECT_EQ(error_with(70, "\3"),
            "imp.md2, byte 70, triangle 0: corner 1 refers to vertex 3, but the file has only 3 vertices; export the "
            "file again");
  EXPECT_EQ(error_with(80, "\0\0\x80\x7F"s),
            "imp.md2, byte 120, frame 0, vertex 0: the coordinate is NaN or infinite; export the file again");
  EXPECT_EQ(error_with(132, "\xFF\xFF\x7F\x7F"),
            "imp.md2, byte 176, frame 1, vertex 1: the coordinate is too large for float32; scale the mesh down");
}

}  // namespace
}  // namespace chronormal::md2_test
