// Tests all mesh readers in the table of formats. Fails if this file has no fixture for a reader, or if the reader has
// no fuzz target.
#include "io/input/formats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/cpu_time.h"
#include "tests/support/places.h"
#include "tests/support/ply_bytes.h"
#include "tests/support/random_edits.h"

namespace chronormal::formats_test {
namespace {

struct Fixture {
  std::string label;
  std::string bytes;
  // The smallest size, in bytes, to which the file can be cut and still be valid. A file that is cut off before this
  // size must give an error. The size is 0 if the format cannot detect a cut.
  std::size_t declared_end = 0;
};

Fixture whole(std::string label, std::string bytes) {
  const std::size_t size = bytes.size();
  return {std::move(label), std::move(bytes), size};
}

const std::map<std::string, std::vector<Fixture>, std::less<>>& fixture_table() {
  static const std::string ascii =
      test::ply_header("ascii", "4", "2") + "0 0 0\n1 0 .5\n1 1 -1e-3\n0 1 0\n3 0 1 2\n4 0 1 2 3\n";
  static const std::map<std::string, std::vector<Fixture>, std::less<>> table = {
      {"obj",
       {{"triangle", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 0},
        {"all forms",
         "# comment\r\nmtllib a.mtl\r\nv 0 0 0 1\r\nv 1e0 -0.5 +.25 0.1 0.2 0.3\r\nv\t1 1 0\r\nv 0 1 \\\r\n 0\r\n"
         "vt 0 0\r\nvn 0 0 1\r\ng a b\r\nusemtl red\r\nf 1/1/1 2//1 3/1 4\r\nf -4 -3 -2 # end\r\nl 1 2\r\np 1\r\n",
         0},
        {"faces first", "f 1 2 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 12.5", 0}}},
      {"ply",
       {{"ascii", ascii, ascii.size() - 1},  // the line feed at the end is optional
        whole("little endian", test::small_binary_ply(false)),
        whole("big endian", test::small_binary_ply(true)),
        whole("mixed, little endian", test::mixed_binary_ply(false)),
        whole("mixed, big endian", test::mixed_binary_ply(true))}},
  };
  return table;
}

// A fixture for the tests of one reader. The parameter of a test is the name of the reader.
class Readers : public ::testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] static const Format& reader() {
    const auto all = formats();
    return *std::find_if(all.begin(), all.end(), [](const Format& format) { return format.name == GetParam(); });
  }
  [[nodiscard]] static const std::vector<Fixture>& reader_fixtures() {
    static const std::vector<Fixture> none;
    const auto found = fixture_table().find(reader().name);
    return found == fixture_table().end() ? none : found->second;
  }

  // Reads arbitrary bytes with the tested reader, and checks the result. Returns true if the reader accepts the bytes
  // as a mesh.
  bool read_anything(const std::string& bytes) {
    ++case_count_;
    const test::CpuClock clock;
    const Result<MeshFrame> result = reader().read_mesh(bytes, "frame 3 (a.mesh)", {});
    EXPECT_LT(clock.seconds(), 1.0);
    if (!result) {
      EXPECT_EQ(result.error().code, ErrorCode::kInvalidInput);
      EXPECT_TRUE(result.error().place.starts_with("frame 3 (a.mesh), ")) << result.error().text();
      EXPECT_FALSE(result.error().message.empty());
      return false;
    }
    const MeshFrame& frame = result.value();
    EXPECT_GT(frame.topology.vertex_count(), 0U);
    EXPECT_GT(frame.topology.face_count(), 0U);
    EXPECT_LE(frame.topology.vertex_count(), bytes.size());
    EXPECT_LE(frame.topology.corner_count(), bytes.size());
    EXPECT_EQ(frame.positions.size(), 3 * frame.topology.vertex_count());
    for (const float coordinate : frame.positions) EXPECT_TRUE(std::isfinite(coordinate));
    return true;
  }

  std::size_t case_count_ = 0;
};

TEST_P(Readers, have_fixtures_that_they_read) {
  ASSERT_FALSE(reader_fixtures().empty()) << "give the reader " << reader().name << " fixtures in this file";
  for (const Fixture& fixture : reader_fixtures()) {
    SCOPED_TRACE(fixture.label);
    const Result<MeshFrame> result = reader().read_mesh(fixture.bytes, "name", {});
    EXPECT_TRUE(result.ok()) << result.error().text();
    EXPECT_TRUE(reader().recognises(fixture.bytes) || fixture.label == "faces first");
  }
}

TEST_P(Readers, have_a_fuzz_target_and_seeds) {
  const std::filesystem::path fuzz = std::filesystem::path(kSourceFolder) / "fuzz";
  const std::string name(reader().name);
  EXPECT_TRUE(std::filesystem::is_regular_file(fuzz / (name + "_fuzz.cpp")));
  ASSERT_TRUE(std::filesystem::is_directory(fuzz / "seeds" / name));
  EXPECT_FALSE(std::filesystem::is_empty(fuzz / "seeds" / name));
}

TEST_P(Readers, truncated_file_is_an_error_or_a_mesh) {
  ASSERT_FALSE(reader_fixtures().empty());
  for (const Fixture& fixture : reader_fixtures()) {
    for (std::size_t size = 0; size < fixture.bytes.size(); ++size) {
      SCOPED_TRACE(fixture.label + " cut to " + std::to_string(size) + " bytes");
      const bool is_mesh = read_anything(fixture.bytes.substr(0, size));
      EXPECT_FALSE(is_mesh && size < fixture.declared_end);
    }
  }
}

// Returns the position and the size of each number in a text.
std::vector<std::pair<std::size_t, std::size_t>> numbers_in(const std::string& text) {
  constexpr std::string_view kOfNumbers = "0123456789+-.eE";
  std::vector<std::pair<std::size_t, std::size_t>> numbers;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_begin = i == 0 || std::string_view(" \t\r\n/").find(text[i - 1]) != std::string_view::npos;
    if (!is_begin || std::string_view("0123456789+-.").find(text[i]) == std::string_view::npos) continue;
    const std::size_t end = text.find_first_not_of(kOfNumbers, i);
    numbers.emplace_back(i, (end == std::string::npos ? text.size() : end) - i);
  }
  return numbers;
}

TEST_P(Readers, boundary_numbers_in_text_are_errors_or_meshes) {
  ASSERT_FALSE(reader_fixtures().empty());
  for (const Fixture& fixture : reader_fixtures()) {
    for (const auto& [position, size] : numbers_in(fixture.bytes)) {
      for (const char* const value : {"2147483647",
                                      "2147483648",
                                      "4294967295",
                                      "4294967296",
                                      "4294967297",
                                      "4611686018427387904",
                                      "6148914691236517206",
                                      "9223372036854775807",
                                      "9223372036854775808",
                                      "18446744073709551615",
                                      "18446744073709551616",
                                      "-1",
                                      "-2147483648",
                                      "-9223372036854775808",
                                      "0",
                                      "1",
                                      "255",
                                      "256",
                                      "65536",
                                      "1e400",
                                      "-1e400",
                                      "1e-400",
                                      "1e99999999999999999999",
                                      "nan",
                                      "-inf",
                                      "0x10",
                                      "",
                                      "+",
                                      "-",
                                      ".",
                                      "1.5",
                                      "1/"}) {
        SCOPED_TRACE(fixture.label + ", byte " + std::to_string(position) + " := " + value);
        std::string bytes = fixture.bytes;
        (void)read_anything(bytes.replace(position, size, value));
      }
    }
  }
  EXPECT_GE(case_count_, 300U);
}

TEST_P(Readers, boundary_patterns_in_bytes_are_errors_or_meshes) {
  ASSERT_FALSE(reader_fixtures().empty());
  for (const Fixture& fixture : reader_fixtures()) {
    for (const std::size_t width : {std::size_t{1}, std::size_t{2}, std::size_t{4}, std::size_t{8}}) {
      std::string highest(width, '\0'), most(width, '\xFF'), infinite(width, '\0');
      highest[0] = '\x80';
      most[0] = '\x7F';
      infinite[0] = '\x7F';
      if (width > 1) infinite[1] = width == 4 ? '\x80' : '\xF0';
      for (const std::string& pattern :
           {std::string(width, '\xFF'), std::string(width, '\0'), highest,
            std::string(highest.rbegin(), highest.rend()), most, std::string(most.rbegin(), most.rend()), infinite,
            std::string(infinite.rbegin(), infinite.rend())}) {
        for (std::size_t at = 0; at + width <= fixture.bytes.size(); ++at) {
          SCOPED_TRACE(fixture.label + ", byte " + std::to_string(at) + ", width " + std::to_string(width));
          std::string bytes = fixture.bytes;
          (void)read_anything(bytes.replace(at, width, pattern));
        }
      }
    }
  }
  EXPECT_GE(case_count_, 300U);
}

TEST_P(Readers, random_edits_are_errors_or_meshes) {
  ASSERT_FALSE(reader_fixtures().empty());
  std::mt19937 random(20240601);
  for (const Fixture& fixture : reader_fixtures()) {
    for (int round = 0; round < 2000; ++round) {
      SCOPED_TRACE(fixture.label + ", round " + std::to_string(round));
      (void)read_anything(test::with_random_edits(fixture.bytes, random));
    }
  }
}

std::vector<std::string> all_reader_names() {
  std::vector<std::string> names;
  for (const Format& format : formats())
    if (format.read_mesh != nullptr) names.emplace_back(format.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Io, Readers, ::testing::ValuesIn(all_reader_names()),
                         [](const auto& param_info) { return param_info.param; });

TEST(ReadMesh, chooses_by_extension_in_upper_and_lower_case) {
  EXPECT_EQ(find_format("a.b/walk.1.OBJ")->name, "obj");
  EXPECT_EQ(find_format("walk.Ply")->name, "ply");
  EXPECT_EQ(find_format("a.obj/walk"), nullptr);
  EXPECT_EQ(find_format("obj"), nullptr);
  const Result<MeshFrame> misnamed = read_mesh(test::small_binary_ply(false), "walk.obj", "walk.obj");
  ASSERT_FALSE(misnamed.ok());
  EXPECT_EQ(misnamed.error().text(), "walk.obj: this is a PLY file, not OBJ");
}

TEST(ReadMesh, chooses_by_content_where_the_name_does_not_tell) {
  EXPECT_TRUE(read_mesh(test::small_binary_ply(true), "<stdin>", "<stdin>").ok());
  EXPECT_TRUE(read_mesh("# by hand\n\nv 0 0 0\nf 1 1 1\n", "<stdin>", "<stdin>").ok());
  EXPECT_TRUE(read_mesh("o thing\nv 0 0 0\nf 1 1 1\n", "mesh.txt", "mesh.txt").ok());
}

TEST(Formats, are_found_by_extension_in_upper_and_lower_case) {
  EXPECT_EQ(find_format("a.b/walk.NPZ")->name, "npz");
  EXPECT_EQ(find_format("walk.md2")->name, "md2");
  EXPECT_EQ(find_format("a.npz/walk"), nullptr);
  EXPECT_EQ(find_format("walk.Pc2")->name, "pc2");
  EXPECT_EQ(find_format("walk.mcx")->name, "maya");
  EXPECT_EQ(find_format("walk.xml")->name, "maya_xml");
  EXPECT_EQ(find_format("face.GLB")->name, "gltf");
  EXPECT_EQ(find_format("blink.Target.GZ")->holds, Holds::kTarget);
  EXPECT_EQ(find_format("blink.gz"), nullptr);
  EXPECT_EQ(find_format("mdd"), nullptr);
}

TEST(Formats, list_their_extensions_for_messages) {
  EXPECT_EQ(extensions_of({Holds::kMesh}, " or "), ".obj or .ply");
  EXPECT_EQ(extensions_of({Holds::kGltf, Holds::kMotion}), ".gltf, .glb, .vrm, .npz, .md2");
}

TEST(Formats, have_the_readers_and_writers_that_go_with_what_they_hold) {
  for (const Format& format : formats()) {
    SCOPED_TRACE(format.name);
    EXPECT_EQ(format.read_mesh != nullptr, format.holds == Holds::kMesh);
    EXPECT_EQ(format.read_motion != nullptr, format.holds == Holds::kMotion);
    EXPECT_FALSE(format.read_cache != nullptr && format.holds != Holds::kCache);
    EXPECT_FALSE(format.write_mesh != nullptr && format.holds != Holds::kMesh);
    EXPECT_FALSE(format.extensions.empty());
  }
}

TEST(ReadMesh, unknown_format_is_an_error_that_lists_what_can_be_read) {
  for (const char* const bytes : {"", "solid cube\n", "plywood\n", "\x89PNG\r\n"}) {
    const Result<MeshFrame> result = read_mesh(bytes, "cube.stl", "cube.stl");
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::kInvalidInput);
    EXPECT_EQ(result.error().place, "cube.stl");
    EXPECT_NE(result.error().message.find("give a mesh as .obj or .ply"), std::string::npos) << result.error().message;
  }
}

}  // namespace
}  // namespace chronormal::formats_test
