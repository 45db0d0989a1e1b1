// Tests the limits on the memory and the output that a small file can cause. Every file here declares far more data
// than it stores, and can be read only with a large --max-expansion.

#include "io/bytes/expansion.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "chronormal/workflow/bake.h"
#include "io/cache/npz.h"
#include "io/input/write_motion.h"
#include "tests/support/cache_bytes.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_compressed.h"
#include "tests/support/gltf_documents.h"
#include "tests/support/read_input.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::expansion_test {
namespace {

using test::GltfBuilder, test::npy, test::npy_header, test::raw;

constexpr std::size_t kEnough = 1000000;  // a value of --max-expansion that is large enough here

std::string error_of(const Status& status) { return status ? "no error" : status.error().text(); }

template <class T>
std::string error_of(const Result<T>& result) {
  return result ? "no error" : result.error().text();
}

void expect_refused(const std::string& error) { EXPECT_NE(error.find("--max-expansion "), std::string::npos) << error; }

TEST(Expansion, allows_32_mebibytes_or_so_many_times_what_was_read) {
  constexpr std::uint64_t kMebibyte = 1 << 20;
  EXPECT_EQ(Expansion(100, 0).most(), 32 * kMebibyte);
  EXPECT_EQ(Expansion(100, 335544).most(), 33554432U) << "335544 x 100 is 32 less than 32 MiB";
  EXPECT_EQ(Expansion(100, 335545).most(), 33554500U);
  EXPECT_EQ(Expansion(0, 1 << 30).most(), 32 * kMebibyte);
  EXPECT_EQ(Expansion(3, ~std::uint64_t{0} / 2).most(), ~std::uint64_t{0});
  EXPECT_TRUE(Expansion::unlimited().check(~std::uint64_t{0}, "").ok());
  Expansion expansion(100, 335544);
  EXPECT_TRUE(expansion.check(33554432, "a").ok());
  EXPECT_FALSE(expansion.check(33554433, "a").ok());
  expansion.add_read(1);
  EXPECT_TRUE(expansion.check(33554500, "a").ok());
}

TEST(Expansion, names_the_option_that_allows_what_was_asked_for) {
  const Status refused = Expansion(100, 1000).check(50000001, "a.npz, positions");
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(refused.error().text(),
            "a.npz, positions: an input of 1,000 bytes would need 50,000,001 bytes of memory or output, which is more "
            "than the limit of 33,554,432; if you trust the file, add --max-expansion 50001");
  EXPECT_TRUE(Expansion(50001, 1000).check(50000001, "").ok());
  EXPECT_FALSE(Expansion(50000, 1000).check(50000001, "").ok());
}

TEST(Expansion, of_deflated_arrays_is_asked_for_before_they_are_unpacked) {
  const std::string faces = npy(npy_header("<i4", "(1, 3)"), raw<std::int32_t>({0, 1, 2}));
  const auto zeros = [&](std::size_t keyframes, std::size_t vertices, bool is_deflated) {
    const std::string shape = "(" + std::to_string(keyframes) + ", " + std::to_string(vertices) + ", 3)";
    return test::zip(
        {{"positions.npy", npy(npy_header("<f4", shape), std::string(12 * keyframes * vertices, '\0')), is_deflated},
         {"faces.npy", faces}});
  };
  const std::string bomb = zeros(2, 1000000, true);
  ASSERT_LT(bomb.size(), 30000U);
  expect_refused(error_of(read_npz(bomb, "bomb.npz")));
  EXPECT_TRUE(read_npz(bomb, "bomb.npz", 1, kEnough).ok());
  EXPECT_TRUE(read_npz(zeros(2, 1000000, false), "stored.npz").ok()) << "what is stored is there";
  // In memory, a keyframe of one vertex needs more bytes for the other fields of its struct than for its position.
  expect_refused(error_of(read_npz(zeros(400000, 3, true), "frames.npz")));
}

TEST(Expansion, of_many_targets_of_one_line_is_asked_for_one_by_one) {
  const test::TemporaryFolder folder;
  std::string base;
  for (int v = 0; v < 60000; ++v) base += "v " + std::to_string(v % 100) + " " + std::to_string(v / 100) + " 0\n";
  std::filesystem::create_directory(folder / "t");
  const std::string mesh = folder.write("base.obj", base + "f 1 2 101\n");
  for (int k = 0; k < 70; ++k) folder.write("t/t" + std::to_string(k) + ".target", "0 0 0 1\n");
  InputOptions options = test::targets_over(mesh, {folder / "t"});
  options.max_expansion = 100;
  EXPECT_EQ(error_of(test::read_motion(options)), "no error") << "51 MB of a base of 660 kB";
  options.max_expansion = 50;
  expect_refused(error_of(test::read_motion(options)));
}

// Makes a document with many targets over a base mesh. Base and targets share one accessor of zeros, which takes no
// bytes in the file.
GltfBuilder zero_targets(std::size_t vertices, std::size_t targets) {
  GltfBuilder builder;
  const auto zeros = builder.add_accessor_over(std::nullopt, "VEC3", 5126, vertices);
  builder.json["accessors"][zeros]["min"] = builder.json["accessors"][zeros]["max"] = {0, 0, 0};
  std::vector<GltfBuilder::Json> list(targets, {{"POSITION", zeros}});
  const auto mesh = builder.add_mesh(GltfBuilder::primitive(zeros, builder.add_indices<std::uint8_t>({0, 1, 2}), list));
  builder.add_node(mesh);
  return builder;
}

TEST(Expansion, of_accessors_without_bytes_is_asked_for_by_a_primitive_and_by_all) {
  const GltfBuilder one = zero_targets(7000, 500);
  const std::string bytes = one.glb();
  const GltfDocument document = GltfDocument::read(bytes, "a.glb").value();
  expect_refused(error_of(document.geometry(0, 0, {})));
  EXPECT_TRUE(document.geometry(0, 0, {.shading = false, .targets = false}).ok());
  GltfOptions enough;
  enough.max_expansion = kEnough;
  EXPECT_TRUE(GltfDocument::read(bytes, "a.glb", std::nullopt, enough).value().geometry(0, 0, {}).ok());

  GltfBuilder many = zero_targets(7000, 50);
  const GltfBuilder::Json primitive = many.json["meshes"][0]["primitives"][0];
  for (int k = 0; k < 10; ++k) many.add_primitive(0, primitive);
  const test::TemporaryFolder folder;
  InputOptions options = test::files({folder.write("many.glb", many.glb())});
  expect_refused(error_of(test::read_motion(options)));
  options.max_expansion = kEnough;
  EXPECT_EQ(error_of(test::read_motion(options)), "no error");
}

TEST(Expansion, of_compressed_views_is_asked_for_before_they_are_decompressed) {
  GltfBuilder builder;
  const std::size_t count = 3000000;
  const std::string zeros(12 * count, '\0');
  const auto view = test::add_meshopt_view(builder, test::meshopt_attributes(zeros, 12), count, 12, "ATTRIBUTES");
  const auto positions = builder.add_accessor_over(view, "VEC3", 5126, 3);
  builder.json["accessors"][positions]["min"] = builder.json["accessors"][positions]["max"] = {0, 0, 0};
  builder.add_node(builder.add_mesh(GltfBuilder::primitive(positions, builder.add_indices<std::uint8_t>({0, 1, 2}))));
  const std::string bytes = builder.glb();
  ASSERT_LT(bytes.size(), 600000U) << "of 36 million";
  GltfOptions options;
  options.max_expansion = 50;
  const GltfDocument document = GltfDocument::read(bytes, "a.glb", std::nullopt, options).value();
  const std::string error = error_of(document.geometry(0, 0, {}));
  expect_refused(error);
  EXPECT_NE(error.find("EXT_meshopt_compression"), std::string::npos) << error;
}

// The files begin with "DRACO", version 2.2, and a mesh without metadata. In the sequential encoding, the number of
// faces follows immediately. In the edgebreaker encoding, a byte and the number of vertices precede the number of
// faces.
TEST(Expansion, of_faces_that_a_draco_mesh_declares_is_asked_for_before_it_is_decoded) {
  const std::string many("\xFF\xFF\xFF\x7F", 4), few("\x03", 1), head("DRACO\x02\x02\x01", 8), no_flags("\0\0", 2);
  for (const std::string& coded :
       {head + '\0' + no_flags + many + few + "rest", head + '\1' + no_flags + '\0' + few + many}) {
    GltfBuilder builder;
    builder.add_mesh(test::draco_primitive(builder, coded, 3, 3, false, {}));
    const std::string bytes = builder.glb();
    const Result<GltfDocument> document = GltfDocument::read(bytes, "a.glb");
    ASSERT_TRUE(document.ok()) << document.error().text();
    const std::string error = error_of(document.value().geometry(0, 0, {}));
    expect_refused(error);
    EXPECT_NE(error.find("KHR_draco_mesh_compression: "), std::string::npos) << error;
    EXPECT_NE(error.find("need 17,179,869,120 bytes of"), std::string::npos) << error << ": 64 x 268,435,455";
  }
}

TEST(Expansion, counts_the_files_of_buffers_each_once) {
  const test::TemporaryFolder folder;
  GltfBuilder builder = zero_targets(3, 1);
  const GltfBuilder::Json same = {{"byteLength", builder.buffer.size()}, {"uri", "a.bin"}};
  builder.json["buffers"] = {nullptr, same, {{"byteLength", 10}, {"uri", "missing.bin"}}};
  folder.write("a.bin", std::string(1000000, '\0'));
  const std::string text = builder.gltf_with_uri("a.bin");
  const Result<GltfDocument> read = GltfDocument::read(text, "a.gltf", folder.path());
  ASSERT_TRUE(read.ok()) << read.error().text();
  const GltfDocument& document = read.value();
  EXPECT_EQ(document.expansion().most(), 100 * (text.size() + 1000000));
}

// Makes a file with a cubic spline that changes so fast that the product of the spline with itself needs very many
// keys.
std::string steep_spline(std::size_t keys) {
  GltfBuilder builder = test::quad_document();
  std::vector<float> times, values;
  for (std::size_t k = 0; k < keys; ++k) {
    times.push_back(static_cast<float>(k));
    for (const float value : {500.0F, 400.0F, 0.5F, 0.5F, -300.0F, 900.0F}) values.push_back(value);
  }
  builder.add_track(builder.add_animation("steep"), 0, times, values, "CUBICSPLINE");
  return builder.glb();
}

TEST(Expansion, of_keys_that_a_bake_inserts_is_asked_for_before_they_are_made) {
  const std::string bytes = steep_spline(2000);
  const auto error = [&](std::size_t times) {
    GltfOptions options;
    options.max_expansion = times;
    const GltfDocument document = GltfDocument::read(bytes, "a.glb", std::nullopt, options).value();
    GltfEdit edit(document);
    return error_of(bake(document, {.encoding = BakeEncoding::kExact, .smooth = true}, edit));
  };
  expect_refused(error(100));
  EXPECT_EQ(error(kEnough), "no error");
}

TEST(Expansion, of_pieces_of_splines_is_asked_for_before_they_are_made) {
  const test::TemporaryFolder folder;
  InputOptions options = test::files({folder.write("steep.glb", steep_spline(2000))});
  options.animation = "steep";
  expect_refused(error_of(test::read_motion(options)));
}

TEST(Expansion, of_a_sequence_of_many_keyframes_is_asked_for_before_its_weights_are_made) {
  const Motion motion = [] {
    Motion result;
    result.topology = Topology::triangles(3, {0, 1, 2}).value();
    for (int k = 0; k < 2000; ++k) {
      const auto t = static_cast<float>(k % 7);
      result.keyframes.push_back({{0, 0, 0, 1, 0, t, 0, 1, t * t}, static_cast<double>(k), ""});
    }
    result.connect_as_sequence();
    return result;
  }();
  std::string glb;
  BakeOptions options;
  const Expansion allowed(100, 72000);
  options.expansion = &allowed;
  const Result<SequenceBake> refused = bake_sequence(motion, options, glb);
  expect_refused(error_of(refused));
  EXPECT_TRUE(glb.empty());
}

TEST(Expansion, of_faces_that_every_file_of_a_sequence_repeats_is_asked_for_before_the_first) {
  Motion motion;
  std::vector<std::uint32_t> corners;
  for (int f = 0; f < 5000; ++f) corners.insert(corners.end(), {0, 1, 2});
  motion.topology = Topology::triangles(3, std::move(corners)).value();
  for (int k = 0; k < 1000; ++k) motion.keyframes.push_back({{0, 0, 0, 1, 0, 0, 0, 1, 0}, static_cast<double>(k), ""});
  motion.connect_as_sequence();
  const test::TemporaryFolder folder;
  MotionStream stream(motion);
  expect_refused(error_of(write_motion(stream, folder / "a_%d.obj", false, Expansion(100, 100000))));
  EXPECT_EQ(folder.entry_count(), 0U);
  EXPECT_EQ(error_of(write_motion(stream, folder / "a.npz", false, Expansion(100, 100000))), "no error");
}

}  // namespace
}  // namespace chronormal::expansion_test
