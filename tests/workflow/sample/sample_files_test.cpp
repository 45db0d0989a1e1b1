// Tests the files to which samples are written: their names and their bytes. Also tests requests that must be refused
// before the first file is written.
#include "chronormal/workflow/sample.h"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "io/mesh/obj.h"
#include "io/mesh/ply.h"
#include "tests/support/array_file.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::sample_files_test {
namespace {

using test::TemporaryFolder;

SampleOptions options_of(ElementKind kind, double crease_angle = 180) {
  SampleOptions options;
  options.elements.kind = kind;
  options.elements.crease_angle = crease_angle;
  return options;
}

// Returns the normals that a file of samples must have at a time.
std::vector<float> normals_at(const Motion& motion, const SampleOptions& options, double time) {
  NormalSampler sampler = NormalSampler::make(motion, options).value();
  return sampler.normals_of_outputs(sampler.at_time(time).value());
}

SampleSummary write_good(const Motion& motion, const SampleOptions& options, const Moments& moments,
                         const SampleOutput& output) {
  const auto summary = write_samples(motion, options, moments, output);
  if (!summary) {
    ADD_FAILURE() << summary.error().text();
    return {};
  }
  return summary.value();
}

// The numbers in an OBJ file: positions and normals, and the indices of both for each corner.
struct ObjWords {
  std::vector<float> positions, normals;
  std::vector<std::size_t> vertex_of_corner, normal_of_corner;
};

ObjWords words_of(const std::string& text) {
  ObjWords words;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream stream(line);
    std::string word;
    stream >> word;
    if (word == "f") {
      while (stream >> word) {
        const std::size_t slashes = word.find("//");
        words.vertex_of_corner.push_back(std::stoul(word.substr(0, slashes)) - 1);
        words.normal_of_corner.push_back(std::stoul(word.substr(slashes + 2)) - 1);
      }
    } else {
      auto& values = word == "v" ? words.positions : words.normals;
      while (stream >> word) values.push_back(std::stof(word));
    }
  }
  return words;
}

TEST(WriteSamples, npy_is_one_array_of_moments_and_outputs) {
  const TemporaryFolder folder;
  const Motion motion = fixtures::smooth_morph(4);
  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices, ElementKind::kCorners}) {
    const std::size_t outputs = kind == ElementKind::kFaces ? 32 : kind == ElementKind::kVertices ? 25 : 96;
    const std::string path = folder / "n.npy";
    const SampleSummary summary =
        write_good(motion, options_of(kind), {{0.75, 0, 0.5}, {}}, {path, SampleFormat::kNpy, true});
    EXPECT_EQ(summary.normals, 3 * outputs);
    EXPECT_EQ(summary.zeros, 0U);
    const test::ArrayFile array = test::parse_npy(test::read_whole(path));
    EXPECT_EQ(array.type, "<f4");
    EXPECT_EQ(array.shape, (std::vector<std::size_t>{3, outputs, 3}));
    std::vector<float> expected;
    for (const double time : {0.75, 0.0, 0.5}) {
      const auto normals = normals_at(motion, options_of(kind), time);
      expected.insert(expected.end(), normals.begin(), normals.end());
    }
    EXPECT_EQ(array.as<float>(), expected);
  }
}

TEST(WriteSamples, npz_has_normals_times_positions_and_faces) {
  const TemporaryFolder folder;
  const Motion motion = fixtures::smooth_morph(4);
  write_good(motion, options_of(ElementKind::kVertices), {{0, 0.5}, {}}, {folder / "n.npz", SampleFormat::kNpz});
  const auto arrays = test::parse_npz(test::read_whole(folder / "n.npz"));
  ASSERT_EQ(arrays.size(), 4U);
  EXPECT_EQ(arrays.at("normals").shape, (std::vector<std::size_t>{2, 25, 3}));
  EXPECT_EQ(arrays.at("times").as<double>(), (std::vector<double>{0, 0.5}));
  EXPECT_EQ(arrays.at("positions").shape, (std::vector<std::size_t>{2, 25, 3}));
  EXPECT_EQ(arrays.at("faces").shape, (std::vector<std::size_t>{32, 3}));
  const auto positions = arrays.at("positions").as<float>();
  for (std::size_t i = 0; i < 75; ++i) {
    const float from = motion.keyframes[0].positions[i], to = motion.keyframes[1].positions[i];
    EXPECT_EQ(positions[i], from);
    EXPECT_FLOAT_EQ(positions[75 + i], static_cast<float>(0.5 * (double{from} + double{to})));
  }
}

TEST(WriteSamples, npz_of_poses_has_weights_and_no_faces_of_several_kinds) {
  const TemporaryFolder folder;
  Motion motion =
      fixtures::make_motion(fixtures::make_polygons(4, {0, 3, 7}, {0, 1, 2, 0, 1, 2, 3}),
                            {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}});
  motion.keyframes.push_back(motion.keyframes[1]);
  motion.connect_as_targets();
  write_good(motion, options_of(ElementKind::kFaces), {{}, {{0.25, 0.5}, {1, 0}, {0, 0}}},
             {folder / "n.npz", SampleFormat::kNpz});
  const auto arrays = test::parse_npz(test::read_whole(folder / "n.npz"));
  ASSERT_EQ(arrays.size(), 3U);
  EXPECT_EQ(arrays.at("weights").shape, (std::vector<std::size_t>{3, 2}));
  EXPECT_EQ(arrays.at("weights").as<double>(), (std::vector<double>{0.25, 0.5, 1, 0, 0, 0}));
  EXPECT_EQ(arrays.at("positions").as<float>()[8], 0.75F);
  EXPECT_EQ(arrays.at("normals").shape, (std::vector<std::size_t>{3, 2, 3}));
}

TEST(WriteSamples, obj_names_one_normal_for_each_vertex_face_or_corner) {
  const TemporaryFolder folder;
  const Motion motion = fixtures::shaken(fixtures::box_grid(1), 0.1, 5);
  for (const auto& [kind, crease, normals] :
       {std::tuple{ElementKind::kFaces, 180.0, 6U}, std::tuple{ElementKind::kVertices, 180.0, 8U},
        std::tuple{ElementKind::kCorners, 180.0, 8U}, std::tuple{ElementKind::kCorners, 30.0, 24U}}) {
    const SampleOptions options = options_of(kind, crease);
    write_good(motion, options, {{0.5}, {}}, {folder / "m.obj", SampleFormat::kObj, true});
    const ObjWords words = words_of(test::read_whole(folder / "m.obj"));
    EXPECT_EQ(words.normals.size(), 3 * normals);
    const auto corners = motion.topology.corners();
    EXPECT_EQ(words.vertex_of_corner, (std::vector<std::size_t>(corners.begin(), corners.end())));
    const std::vector<float> expected = normals_at(motion, options, 0.5);
    for (std::size_t c = 0; c < 24; ++c) {
      const std::size_t output = kind == ElementKind::kFaces ? c / 4 : kind == ElementKind::kVertices ? corners[c] : c;
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(words.normals.at(3 * words.normal_of_corner.at(c) + k), expected.at(3 * output + k)) << c;
    }
  }
}

TEST(WriteSamples, ply_has_normals_of_vertices_or_of_faces) {
  const TemporaryFolder folder;
  const Motion motion = fixtures::shaken(fixtures::box_grid(1), 0.1, 5);
  const std::string properties = "property float nx\nproperty float ny\nproperty float nz\n";
  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
    write_good(motion, options_of(kind), {{0.5}, {}}, {folder / "m.ply", SampleFormat::kPly, true});
    const std::string bytes = test::read_whole(folder / "m.ply");
    const bool faces = kind == ElementKind::kFaces;
    const std::size_t at = bytes.find(properties), list = bytes.find("property list"), end = bytes.find("end_header\n");
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(at > list, faces) << "after the properties of its element";
    EXPECT_EQ(bytes.find(properties, at + 1), std::string::npos);
    // A vertex has 12 bytes for x, y and z. A quad has a byte and four indices of 4 bytes.
    const std::size_t first = end + 11 + (faces ? 8 * 12 + 17 : 12), stride = faces ? 17 + 12 : 24;
    const auto expected = normals_at(motion, options_of(kind), 0.5);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      float value = 0;
      std::memcpy(&value, bytes.data() + first + i / 3 * stride + i % 3 * 4, 4);
      EXPECT_EQ(value, expected[i]) << i;
    }
    const auto back = read_ply(bytes, "m.ply");
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(back.value().topology, motion.topology);
  }
  const auto corners =
      write_samples(motion, options_of(ElementKind::kCorners), {{0.5}, {}}, {folder / "c.ply", SampleFormat::kPly});
  ASSERT_FALSE(corners.ok());
  EXPECT_EQ(corners.error().code, ErrorCode::kUsage);
}

TEST(WriteSamples, meshes_are_numbered_as_moments_are) {
  const TemporaryFolder folder;
  const Motion motion = fixtures::smooth_morph(2);
  write_good(motion, options_of(ElementKind::kVertices), {{0, 0.5, 1}, {}},
             {folder / "m_%02d.obj", SampleFormat::kObj});
  EXPECT_EQ(folder.entry_count(), 3U);
  EXPECT_EQ(words_of(test::read_whole(folder / "m_02.obj")).positions, motion.keyframes[1].positions);
  const auto no_number =
      write_samples(motion, options_of(ElementKind::kVertices), {{0, 1}, {}}, {folder / "m.obj", SampleFormat::kObj});
  EXPECT_EQ(no_number.error().code, ErrorCode::kUsage);
  EXPECT_NE(no_number.error().message.find("%d"), std::string::npos);
}

TEST(WriteSamples, nothing_is_written_where_one_moment_or_one_file_is_refused) {
  const TemporaryFolder folder;
  const Motion motion = fixtures::smooth_morph(2);
  const SampleOptions options = options_of(ElementKind::kVertices);
  const SampleOutput output{folder / "m_%d.obj", SampleFormat::kObj};
  EXPECT_EQ(write_samples(motion, options, {{0, 0.5, 1.5}, {}}, output).error().code, ErrorCode::kUsage);
  EXPECT_EQ(folder.entry_count(), 0U);
  folder.write("m_2.obj", "old");
  EXPECT_EQ(write_samples(motion, options, {{0, 0.5, 1}, {}}, output).error().code, ErrorCode::kFailed);
  EXPECT_EQ(folder.entry_count(), 1U);
}

TEST(WriteSamples, arrays_of_more_than_4_GiB_for_a_stream_are_refused_before_they_are_made) {
  const Motion motion = fixtures::smooth_morph(20);  // the mesh has 441 vertices
  const auto too_much = write_samples(motion, options_of(ElementKind::kVertices),
                                      {std::vector<double>(1000000, 0.5), {}}, {"-", SampleFormat::kNpz});
  ASSERT_FALSE(too_much.ok());
  EXPECT_EQ(too_much.error().code, ErrorCode::kUsage);
  EXPECT_NE(too_much.error().message.find("4 GiB"), std::string::npos);
}

TEST(WriteSamples, zeros_are_counted_and_progress_reaches_its_end) {
  const TemporaryFolder folder;
  Motion motion = test::still(fixtures::make_triangles(4, {0, 1, 2}), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}});
  std::vector<std::size_t> seen;
  const auto summary =
      write_samples(motion, options_of(ElementKind::kVertices), {{0, 1}, {}}, {folder / "n.npy", SampleFormat::kNpy},
                    [&seen](std::size_t done, std::size_t total) {
                      seen.push_back(done);
                      EXPECT_EQ(total, 2U);
                    });
  EXPECT_EQ(seen, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(summary.value().normals, 8U);
  EXPECT_EQ(summary.value().zeros, 2U);
  motion.segments.clear();
  motion.keyframes.resize(1);
  EXPECT_EQ(write_good(motion, options_of(ElementKind::kVertices), {}, {folder / "s.npy", SampleFormat::kNpy}).zeros,
            1U);
}

TEST(SampleFormat, is_found_by_name_or_extension) {
  EXPECT_EQ(make_sample_format("npz").value(), SampleFormat::kNpz);
  EXPECT_EQ(make_sample_format("stl").error().code, ErrorCode::kUsage);
  EXPECT_NE(make_sample_format("stl").error().message.find("npy, npz, ply, obj"), std::string::npos);
  EXPECT_EQ(find_sample_format("a/b.PLY"), SampleFormat::kPly);
  EXPECT_EQ(find_sample_format("x_%d.obj"), SampleFormat::kObj);
  for (const char* const path : {"", "npy", "a.npyx", "-"}) EXPECT_EQ(find_sample_format(path), std::nullopt) << path;
}

}  // namespace
}  // namespace chronormal::sample_files_test
