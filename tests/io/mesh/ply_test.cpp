#include "io/mesh/ply.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/text.h"
#include "tests/support/ply_bytes.h"
#include "tests/support/random_mesh.h"

namespace chronormal::ply_test {
namespace {

using Positions = std::vector<float>;

const std::string kRows = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n";

MeshFrame read_good(const std::string& bytes) {
  Result<MeshFrame> result = read_ply(bytes, "walk.ply");
  if (!result) {
    ADD_FAILURE() << result.error().text();
    return {};
  }
  return std::move(result).value();
}

std::string error_of(const std::string& bytes) {
  const Result<MeshFrame> result = read_ply(bytes, "walk.ply");
  if (result) return "no error";
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidInput);
  return result.error().text();
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

std::string ascii_file() { return test::ply_header("ascii", "4", "2") + kRows; }

TEST(ReadPly, reads_ascii_and_both_endians) {
  const MeshFrame ascii = read_good(ascii_file());
  EXPECT_EQ(ascii.positions, (Positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}));
  EXPECT_EQ(ascii.topology.face(1).size(), 4U);
  for (const bool big_endian : {false, true}) {
    const MeshFrame binary = read_good(test::small_binary_ply(big_endian));
    EXPECT_EQ(binary.positions, (Positions{0, 0, 0, 1, 0, 0, 0, 1, 0.5F}));
    EXPECT_EQ(binary.topology, Topology::triangles(3, {0, 1, 2}).value());
  }
}

TEST(ReadPly, passes_over_what_is_not_ours_in_any_order) {
  for (const bool big_endian : {false, true}) {
    const MeshFrame frame = read_good(test::mixed_binary_ply(big_endian));
    EXPECT_EQ(frame.positions, (Positions{0.5F, 0, 10, 1, -1, 11, 1.5F, -2, 12, 2, -3, 13}));
    EXPECT_EQ(frame.topology, Topology::polygons(4, {0, 4, 7}, {0, 1, 2, 3, 1, 2, 3}).value());
  }
  const MeshFrame ascii = read_good(
      "ply\nformat ascii 1.0\nelement face 1\nproperty list int int vertex_index\nproperty int id\nelement nothing 9\n"
      "element vertex 3\nproperty list uchar float extra\nproperty int z\nproperty uint y\nproperty double x\n"
      "element tail 2\nproperty char c\nend_header\n\n3 2 1 0 77\n0 1 2 3.5\n2 nan x 4 5 6\n\n1 abc 7 8 9\n1\n2\nrest");
  EXPECT_EQ(ascii.positions, (Positions{3.5F, 2, 1, 6, 5, 4, 9, 8, 7}));
}

// Makes an ASCII PLY file of three vertices with velocities. first, second and third are the names of the velocity
// properties, and `type` is the type of the second velocity property. Other properties are between these three.
std::string moving_file(const std::string& first, const std::string& second, const std::string& third,
                        const std::string& type = "float") {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty " + type + " " + second +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty float " + first +
         "\nproperty double " + third +
         "\nelement face 1\nproperty list uchar int vertex_indices\nproperty float vx\nend_header\n"
         "2 0 0 0 255 1 3.5\n5 1 0 0 255 4 6\n8 0 1 0 255 7 -9e3\n3 0 1 2 7\n";
}

TEST(ReadPly, velocities_are_read_where_they_are_asked_for) {
  for (const std::string& bytes :
       {moving_file("vx", "vy", "vz"), moving_file("velocity_x", "velocity_y", "velocity_z", "short")}) {
    const Result<MeshFrame> moving = read_moving_ply(bytes, "walk.ply");
    ASSERT_TRUE(moving.ok()) << moving.error().text();
    EXPECT_EQ(moving.value().velocities, (Positions{1, 2, 3.5F, 4, 5, 6, 7, 8, -9e3F}));
    EXPECT_EQ(moving.value().positions, (Positions{0, 0, 0, 1, 0, 0, 0, 1, 0}));
    EXPECT_TRUE(read_good(bytes).velocities.empty());
  }
  for (const bool big_endian : {false, true}) {
    EXPECT_TRUE(read_moving_ply(test::small_binary_ply(big_endian), "walk.ply").value().velocities.empty());
    test::ByteWriter writer(replaced(moving_file("vx", "vy", "vz").substr(0, moving_file("vx", "vy", "vz").find("2 0")),
                                     "ascii", big_endian ? "binary_big_endian" : "binary_little_endian"),
                            big_endian);
    for (int v = 0; v < 3; ++v) {
      for (const float value : {2.0F, 0.0F, 1.0F, 2.0F}) writer.add(value);
      writer.add(std::uint8_t{255}).add(1.0F).add(double{3} + v);
    }
    writer.add(std::uint8_t{3});
    for (const std::int32_t vertex : {0, 1, 2}) writer.add(vertex);
    const Result<MeshFrame> moving = read_moving_ply(writer.add(7.0F).bytes(), "walk.ply");
    ASSERT_TRUE(moving.ok()) << moving.error().text();
    EXPECT_EQ(moving.value().velocities, (Positions{1, 2, 3, 1, 2, 4, 1, 2, 5}));
  }
}

TEST(ReadPly, velocity_that_is_not_whole_or_no_number_is_an_error_where_it_is_asked_for) {
  const auto said = [](const std::string& bytes) {
    const Result<MeshFrame> moving = read_moving_ply(bytes, "walk.ply");
    return moving ? "no error" : moving.error().text();
  };
  const std::string half = moving_file("vx", "vy", "speed"),
                    list = replaced(moving_file("vx", "vy", "vz"), "float vx", "list uchar float vx"),
                    broken = replaced(moving_file("vx", "vy", "vz"), "3.5", "nan");
  EXPECT_EQ(said(half),
            "walk.ply, header: the velocity of the vertices is incomplete, since they have no property vz; add it, or "
            "leave all velocities out");
  EXPECT_EQ(said(list), "walk.ply, header: the velocity vx is a list, but must be a number; export the file again");
  EXPECT_EQ(said(broken).find("walk.ply, line 15, vertex 0: "), 0U) << said(broken);
  EXPECT_EQ(error_of(half), "no error");
  EXPECT_EQ(error_of(broken), "no error");
}

TEST(ReadPly, every_scalar_type_serves_as_coordinate_count_and_index) {
  for (const bool big_endian : {false, true}) {
    const auto file = [&](const std::string& coordinate, const std::string& count, const std::string& index, auto put) {
      test::ByteWriter writer(std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                                  "_endian 1.0\nelement vertex 3\nproperty " + coordinate + " x\nproperty " +
                                  coordinate + " y\nproperty " + coordinate + " z\nelement face 1\nproperty list " +
                                  count + " " + index + " vertex_indices\nend_header\n",
                              big_endian);
      put(writer);
      return writer.bytes();
    };
    const auto check = [&](auto zero, const char* name, const char* other_name) {
      using T = decltype(zero);
      for (const char* const type : {name, other_name}) {
        const std::string integer = std::is_integral_v<T> ? type : "uchar";
        const MeshFrame frame = read_good(file(type, integer, integer, [](test::ByteWriter& writer) {
          for (int i = 1; i <= 9; ++i) writer.add(static_cast<T>(i));
          for (const int i : {3, 0, 1, 2}) {
            if constexpr (std::is_integral_v<T>) {
              writer.add(static_cast<T>(i));
            } else {
              writer.add(static_cast<std::uint8_t>(i));
            }
          }
        }));
        EXPECT_EQ(frame.positions, (Positions{1, 2, 3, 4, 5, 6, 7, 8, 9})) << type;
        EXPECT_EQ(frame.topology, Topology::triangles(3, {0, 1, 2}).value()) << type;
      }
    };
    check(std::int8_t{}, "char", "int8");
    check(std::uint8_t{}, "uchar", "uint8");
    check(std::int16_t{}, "short", "int16");
    check(std::uint16_t{}, "ushort", "uint16");
    check(std::int32_t{}, "int", "int32");
    check(std::uint32_t{}, "uint", "uint32");
    check(float{}, "float", "float32");
    check(double{}, "double", "float64");
  }
}

TEST(ReadPly, all_line_ends_change_nothing) {
  const MeshFrame frame = read_good(ascii_file());
  for (const char* const line_end : {"\r\n", "\r"}) {
    std::string other;
    for (const char c : ascii_file()) other += c == '\n' ? std::string(line_end) : std::string(1, c);
    EXPECT_EQ(read_good(other).positions, frame.positions);
    EXPECT_EQ(read_good(other).topology, frame.topology);
  }
}

TEST(ReadPly, bytes_after_the_last_element_are_left_out) {
  EXPECT_EQ(read_good(test::small_binary_ply(true) + "trailing").positions.size(), 9U);
}

TEST(ReadPly, header_that_breaks_the_grammar_is_an_error_with_its_line) {
  const auto with = [](const std::string& what, const std::string& by) {
    return error_of(replaced(ascii_file(), what, by));
  };
  EXPECT_EQ(
      error_of("plx\n"),
      "walk.ply, line 1: this is not a PLY file, since its first line is not the word ply; export the file again");
  EXPECT_EQ(error_of("ply\nformat ascii 1.0\n"),
            "walk.ply, line 2: the header does not end, since the line end_header is missing; export the file again");
  EXPECT_EQ(error_of("ply\ncomment a\nend_header\n"),
            "walk.ply, line 3: the header has no line that begins with 'format'; export the file again");
  EXPECT_EQ(with("ascii 1.0", "ascii 1.1"),
            "walk.ply, line 2: version '1.1' of PLY cannot be read; export the file as version 1.0");
  EXPECT_TRUE(with("ascii", "binary_mixed_endian").starts_with("walk.ply, line 2: the encoding 'binary_mixed_endian'"));
  EXPECT_TRUE(with("format ascii 1.0\n", "").starts_with("walk.ply, line 2: a line that begins with 'format'"));
  EXPECT_EQ(with("element vertex 4", "element vertex 4 5"),
            "walk.ply, line 3: this line must have the form: element NAME COUNT");
  EXPECT_EQ(with("float y", "float16 y"),
            "walk.ply, line 5: the type 'float16' is not a type of PLY; export the file again");
  EXPECT_EQ(with("element face", "elements face"),
            "walk.ply, line 7: 'elements' is not a keyword of a PLY header; export the file again");
  EXPECT_TRUE(
      with("float z", "float z 1").starts_with("walk.ply, line 6: this line must have the form: property TYPE NAME"));
  EXPECT_TRUE(
      with("element vertex 4\n", "")
          .starts_with(
              "walk.ply, line 3: a line that begins with property must come after a line that begins with element"));
  EXPECT_TRUE(with("list uchar int", "list float int").starts_with("walk.ply, line 8: the length of a list must be"));
  EXPECT_TRUE(with("list uchar int", "list uchar float").find("must be a list of integers") != std::string::npos);
  EXPECT_TRUE(with("list uchar int", "int").find("must be a list of integers") != std::string::npos);
}

TEST(ReadPly, what_is_declared_twice_or_is_missing_is_an_error) {
  const auto with = [](const std::string& what, const std::string& by) {
    return error_of(replaced(ascii_file(), what, by));
  };
  EXPECT_EQ(with("float z", "float y"),
            "walk.ply, line 6: the property 'y' is declared twice; remove one of the two lines");
  EXPECT_EQ(with("element face", "element vertex"),
            "walk.ply, line 7: the element 'vertex' is declared twice; remove one of the two lines");
  EXPECT_EQ(with("format ascii 1.0", "format ascii 1.0\nformat ascii 1.0"),
            "walk.ply, line 3: the header has two lines that begin with format; remove one of them");
  EXPECT_EQ(with("vertex_indices", "vertex_indices\nproperty list uchar int vertex_index"),
            "walk.ply, line 9: the faces have both vertex_indices and vertex_index; remove one of the two properties");
  EXPECT_EQ(with("float z", "list char float z"),
            "walk.ply, line 6: the coordinate 'z' is a list, but must be a number; export the file again");
  EXPECT_EQ(with("float z", "float w"), "walk.ply, line 9: the vertices have no property z; export the file again");
  EXPECT_EQ(with("element vertex", "element point"), "walk.ply, line 9: the file has no vertices; export a mesh");
  EXPECT_EQ(with("vertex 4", "vertex 0"), "walk.ply, line 9: the file has no vertices; export a mesh");
  EXPECT_EQ(with("element face", "element edge"), "walk.ply, line 9: the file has no faces; export a mesh with faces");
  EXPECT_EQ(with("face 2", "face 0"), "walk.ply, line 9: the file has no faces; export a mesh with faces");
  EXPECT_EQ(with("vertex_indices", "corners"),
            "walk.ply, line 9: the faces have no property vertex_indices; export the file again");
  EXPECT_EQ(with("element face", "element tristrips"),
            "walk.ply, line 9: the file has triangle strips, which cannot be read; export it with faces");
}

TEST(ReadPly, absurd_counts_are_refused_before_memory_is_taken) {
  for (const char* const count : {"2147483647", "2147483648", "4294967295", "4294967296", "1537228672809129302",
                                  "4611686018427387904", "9223372036854775808", "18446744073709551615"}) {
    for (const char* const encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      const std::string vertices = error_of(test::ply_header(encoding, count, "1") + kRows);
      EXPECT_NE(vertices.find("the file is too short for the " + grouped(std::stoull(count)) +
                              " elements 'vertex' in its header; copy or export it again"),
                std::string::npos)
          << vertices;
      const std::string faces = error_of(test::ply_header(encoding, "1", count) + kRows);
      EXPECT_NE(faces.find("the file is too short for the " + grouped(std::stoull(count)) +
                           " elements 'face' in its header; copy or export it again"),
                std::string::npos)
          << faces;
    }
  }
  for (const char* const count : {"-1", "18446744073709551616", "1e3", "0x4", "4.0", "+4"})
    EXPECT_EQ(error_of(test::ply_header("ascii", count, "1")),
              std::string("walk.ply, line 3: '") + count +
                  "' is not a valid number of 'vertex' elements; correct it, or export the file again");
  // The header declares one row more than the file can hold.
  EXPECT_NE(error_of(test::ply_header("binary_little_endian", "3", "1") + std::string(35, '\0')).find("too short"),
            std::string::npos);
}

TEST(ReadPly, absurd_list_lengths_are_errors_and_not_allocations) {
  for (const bool big_endian : {false, true}) {
    for (const std::uint32_t length : {4U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
      test::ByteWriter writer(
          replaced(test::ply_header(big_endian ? "binary_big_endian" : "binary_little_endian", "1", "1"), "list uchar",
                   "list uint"),
          big_endian);
      for (int i = 0; i < 3; ++i) writer.add(0.0F);
      writer.add(length);
      for (int i = 0; i < 3; ++i) writer.add(std::int32_t{0});
      const std::string error = error_of(writer.bytes());
      EXPECT_NE(error.find("face 0: the file is cut off"), std::string::npos) << error;
    }
    test::ByteWriter skipped(std::string("ply\nformat ") + (big_endian ? "binary_big_endian" : "binary_little_endian") +
                                 " 1.0\nelement odd 1\nproperty list uint double d\nelement vertex 1\nproperty char x\n"
                                 "property char y\nproperty char z\nelement face 1\n"
                                 "property list char char vertex_index\nend_header\n",
                             big_endian);
    skipped.add(0x20000000U).add(0.0);
    EXPECT_NE(error_of(skipped.bytes()).find("'odd' 0: the file is cut off"), std::string::npos)
        << error_of(skipped.bytes());
  }
}

TEST(ReadPly, bad_ascii_rows_are_errors_with_line_element_and_index) {
  const auto with = [](const std::string& what, const std::string& by) {
    return error_of(test::ply_header("ascii", "4", "2") + replaced(kRows, what, by));
  };
  EXPECT_EQ(with("1 0 0", "1 nan 0"), "walk.ply, line 11, vertex 1: 'nan' is NaN or infinite; write a finite number");
  // The numbers of a row may continue in the next line. If a row has one number too few, the reader therefore finds the
  // error only in the next line.
  EXPECT_EQ(
      with("1 0 0", "1 0"),
      "walk.ply, line 12, vertex 1: '1' is one value more than the header declares for a row; export the file again");
  EXPECT_EQ(
      with("1 0 0", "1 0 0 0"),
      "walk.ply, line 11, vertex 1: '0' is one value more than the header declares for a row; export the file again");
  EXPECT_EQ(with("1 0 0", "1 0 1e39"),
            "walk.ply, line 11, vertex 1: '1e39' is too large for float32; write a smaller number");
  EXPECT_EQ(
      with("3 0 1 2", "3 0 1 4"),
      "walk.ply, line 14, face 0: corner 2 refers to vertex 4, but the file has 4 vertices; export the file again");
  EXPECT_EQ(
      with("3 0 1 2", "3 0 -1 2"),
      "walk.ply, line 14, face 0: corner 1 refers to vertex -1, but the file has 4 vertices; export the file again");
  EXPECT_EQ(
      with("4 0 1", "2 0 1"),
      "walk.ply, line 15, face 1: '2' is one value more than the header declares for a row; export the file again");
  EXPECT_EQ(with("4 0 1", "-4 0 1"),
            "walk.ply, line 15, face 1: a list has a negative length, -4; export the file again");
  EXPECT_EQ(with("3 0 1 2", "3 0 1.0 2"),
            "walk.ply, line 14, face 0: '1.0' is not a valid number here; correct it, or export the file again");
  EXPECT_EQ(error_of(test::ply_header("ascii", "4", "2") + replaced(kRows, "4 0 1 2 3\n", "          ")),
            "walk.ply, line 15, face 1: the file is cut off here, before this row; copy or export it again");
}

TEST(ReadPly, ascii_rows_may_go_over_several_lines_and_faces_of_two_corners_are_left_out) {
  const std::string header = test::ply_header("ascii", "4", "3");
  const Result<MeshFrame> mesh =
      read_ply(header + "0 0\n0\n1\n0\n0\n1 1 0\n0 1 0\n3 0\n1 2\n2 0 1\n4\n0 1 2 3\n", "walk.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  EXPECT_EQ(mesh.value().positions, (std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}));
  EXPECT_EQ(mesh.value().topology, Topology::polygons(4, {0, 3, 7}, {0, 1, 2, 0, 1, 2, 3}).value());
  EXPECT_EQ(mesh.value().notes, (std::vector<std::string>{"1 face has fewer than three corners and is left out"}));
}

TEST(ReadPly, double_positions_count_from_the_origin_before_they_are_rounded) {
  const std::vector<float> places = {0.25F, 0, 0, 1, 0.125F, 0, 0, 1, 0.0625F};
  const Topology triangle = Topology::triangles(3, {0, 1, 2}).value();
  const Origin origin = {452312, 5411872, 0};
  for (const PlyEncoding encoding :
       {PlyEncoding::kAscii, PlyEncoding::kBinaryLittleEndian, PlyEncoding::kBinaryBigEndian}) {
    const std::string bytes = write_ply(triangle, VectorView<const float>::packed(places.data(), 3), encoding, origin);
    EXPECT_NE(bytes.find("property double x"), std::string::npos);
    const Result<MeshFrame> mesh = read_ply(bytes, "utm.ply", origin);
    ASSERT_TRUE(mesh.ok()) << mesh.error().text();
    EXPECT_EQ(mesh.value().positions, places);
    EXPECT_TRUE(mesh.value().has_more_digits);
  }
}

TEST(ReadPly, bad_binary_values_are_errors_with_byte_element_and_index) {
  const std::size_t body = test::ply_header("binary_little_endian", "3", "1").size();
  const auto with = [&](std::size_t at, const std::string& raw) {
    std::string bytes = test::small_binary_ply(false);
    return error_of(bytes.replace(body + at, raw.size(), raw));
  };
  const auto place = [&](std::size_t at) { return "walk.ply, byte " + std::to_string(body + at); };
  EXPECT_EQ(with(16, std::string("\0\0\xC0\x7F", 4)),
            place(16) + ", vertex 1: the coordinate is NaN or infinite; export the file again");
  EXPECT_EQ(with(32, std::string("\0\0\x80\xFF", 4)),
            place(32) + ", vertex 2: the coordinate is NaN or infinite; export the file again");
  EXPECT_EQ(with(41, std::string("\3\0\0\0", 4)),
            place(45) + ", face 0: corner 1 refers to vertex 3, but the file has 3 vertices; export the file again");
  EXPECT_EQ(with(41, "\xFF\xFF\xFF\xFF"),
            place(45) + ", face 0: corner 1 refers to vertex -1, but the file has 3 vertices; export the file again");
  // The only face of the file has no corners, so the reader skips this face.
  EXPECT_EQ(with(36, std::string("\0", 1)),
            place(37) + ": no face has three or more corners, so the mesh has no normals; export a mesh with faces");
  EXPECT_EQ(
      with(36, "\4"),
      place(49) + ", face 0: the file is cut off, since only 0 bytes are left for this row; copy or export it again");
}

TEST(ReadPly, double_that_is_too_large_for_float_is_an_error) {
  test::ByteWriter writer(
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double "
      "z\nelement face 1\nproperty list uchar uchar vertex_index\nend_header\n",
      false);
  writer.add(0.1).add(-1e39).add(0.0).add(0x03U).add(0U);
  EXPECT_NE(error_of(writer.bytes()).find("vertex 0: the coordinate is too large for float32; scale the mesh down"),
            std::string::npos);
}

RC_GTEST_PROP(WritePly, what_was_written_reads_back_bit_for_bit_in_every_encoding, ()) {
  const MeshFrame frame = test::random_mesh();
  for (const PlyEncoding encoding :
       {PlyEncoding::kAscii, PlyEncoding::kBinaryLittleEndian, PlyEncoding::kBinaryBigEndian}) {
    const Result<MeshFrame> back = read_ply(write_ply(frame.topology, test::positions_of(frame), encoding), "back.ply");
    RC_ASSERT(back.ok());
    RC_ASSERT(back.value().topology == frame.topology);
    RC_ASSERT(test::same_bits(back.value().positions, frame.positions));
  }
}

TEST(WritePly, writes_the_bytes_that_were_made_by_hand) {
  const MeshFrame frame = read_good(test::small_binary_ply(false));
  const auto positions = test::positions_of(frame);
  EXPECT_EQ(write_ply(frame.topology, positions, PlyEncoding::kBinaryLittleEndian), test::small_binary_ply(false));
  EXPECT_EQ(write_ply(frame.topology, positions, PlyEncoding::kBinaryBigEndian), test::small_binary_ply(true));
  EXPECT_EQ(write_ply(frame.topology, positions, PlyEncoding::kAscii),
            test::ply_header("ascii", "3", "1") + "0 0 0\n1 0 0\n0 1 0.5\n3 0 1 2\n");
}

TEST(WritePly, faces_of_more_than_255_corners_read_back) {
  std::vector<std::uint32_t> corners(300, 0);
  const Topology topology = Topology::polygons(1, {0, 300}, std::move(corners)).value();
  const std::vector<float> point = {1, 2, 3};
  for (const PlyEncoding encoding :
       {PlyEncoding::kAscii, PlyEncoding::kBinaryLittleEndian, PlyEncoding::kBinaryBigEndian})
    EXPECT_EQ(read_good(write_ply(topology, VectorView<const float>::packed(point.data(), 1), encoding)).topology,
              topology);
}

}  // namespace
}  // namespace chronormal::ply_test
