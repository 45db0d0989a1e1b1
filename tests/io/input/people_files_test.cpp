// Tests problems of real files: positions far from the origin, caches of other meshes, padded faces, loops, and formats
// of other programs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "io/bytes/binary.h"
#include "io/bytes/expansion.h"
#include "io/cache/npy.h"
#include "io/cache/npz.h"
#include "io/mesh/obj.h"
#include "tests/support/cache_bytes.h"
#include "tests/support/read_input.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::people_files_test {
namespace {

using test::TemporaryFolder;

template <class T>
std::string error_of(const Result<T>& result) {
  return result ? "" : result.error().text();
}

std::string npy_of(const std::string& type, const std::vector<std::uint64_t>& shape, const auto& values) {
  std::string bytes = npy::write_header(type, shape);
  for (const auto value : values) binary::append(bytes, value, std::endian::little);
  return bytes;
}

std::string npz_of(const std::string& positions, const std::string& faces) {
  const std::vector<NpzMember> members = {{"positions", positions}, {"faces", faces}};
  return write_npz(members);
}

// A curved sheet: the points of a square grid, and its triangles.
struct Sheet {
  std::vector<double> places;
  std::vector<std::uint32_t> corners;
};
Sheet sheet(std::size_t side, double height) {
  Sheet result;
  for (std::size_t i = 0; i < side * side; ++i) {
    const auto x = static_cast<double>(i % side), y = static_cast<double>(i / side);
    result.places.insert(result.places.end(), {x, y, height * x * y / 64});
  }
  for (std::uint32_t y = 0; y + 1 < side; ++y)
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const auto at = [&](std::uint32_t i, std::uint32_t j) { return j * static_cast<std::uint32_t>(side) + i; };
      for (const std::uint32_t v : {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y), at(x + 1, y + 1), at(x, y + 1)})
        result.corners.push_back(v);
    }
  return result;
}

std::string obj_of(const Sheet& mesh) {
  std::string text;
  for (std::size_t i = 0; i < mesh.places.size(); ++i) {
    char number[40];
    text += i % 3 == 0 ? "v " : " ";
    text.append(number, static_cast<std::size_t>(std::snprintf(number, sizeof number, "%.10f", mesh.places[i])));
    if (i % 3 == 2) text += '\n';
  }
  for (std::size_t c = 0; c < mesh.corners.size(); c += 3)
    text += "f " + std::to_string(mesh.corners[c] + 1) + ' ' + std::to_string(mesh.corners[c + 1] + 1) + ' ' +
            std::to_string(mesh.corners[c + 2] + 1) + '\n';
  return text;
}

TEST(PaddedFaces, are_refused_and_say_so) {
  const std::string positions = npy_of("<f4", {2, 5, 3}, std::vector<float>(30, 1.0F));
  const auto read = [&](const std::string& faces) {
    return error_of(read_npz(npz_of(positions, faces), "a.npz", 1, Expansion::kUsual));
  };
  const std::vector<std::int32_t> rows = {3, 0, 1, 2, 3, 0, 2, 3, 3, 0, 3, 4};
  EXPECT_NE(read(npy_of("<i4", {3, 4}, rows)).find("begins with its number of corners"), std::string::npos);
  EXPECT_NE(read(npy_of("<i4", {12}, rows)).find("begins with its number of corners"), std::string::npos);
  EXPECT_NE(read(npy_of("<i4", {2, 5}, std::vector<std::int32_t>{4, 0, 1, 2, 3, 4, 0, 4, 2, 1}))
                .find("begins with its number of corners"),
            std::string::npos);
  // An array with a single face that begins with its number of corners gives the same message as an array with several
  // such faces, although the vertices of this face do not exist.
  EXPECT_NE(
      read(npy_of("<i4", {1, 4}, std::vector<std::int32_t>{3, 7, 8, 9})).find("begins with its number of corners"),
      std::string::npos);
  // The first number of each face is a vertex, and not the number of corners, if all faces begin with vertex 3 by
  // chance, or if faces begin with different numbers.
  EXPECT_EQ(read(npy_of("<i4", {2, 4}, std::vector<std::int32_t>{3, 0, 1, 2, 3, 2, 4, 0})), "");
  EXPECT_EQ(read(npy_of("<i4", {2, 4}, std::vector<std::int32_t>{0, 1, 2, 3, 3, 2, 1, 4})), "");
  EXPECT_EQ(read(npy_of("<i4", {2, 3}, std::vector<std::int32_t>{2, 0, 1, 2, 1, 4})), "");
}

TEST(Caches, of_another_mesh_or_in_another_order_are_told) {
  constexpr std::uint32_t kSeed = 5405;
  std::cout << "seed " << kSeed << '\n';
  std::mt19937 random(kSeed);
  const TemporaryFolder folder;
  for (int round = 0; round < 40; ++round) {
    const std::size_t side = 5 + random() % 12, vertices = side * side;
    const Sheet mesh = sheet(side, 1);
    const std::string obj = folder.write("mesh.obj", obj_of(mesh));
    std::vector<std::size_t> order(vertices);
    for (std::size_t v = 0; v < vertices; ++v) order[v] = v;
    const auto notes_of = [&](double bend, double scale, bool moved) {
      std::vector<float> positions;
      for (int k = 0; k < 2; ++k)
        for (const std::size_t v : order) {
          const double x = mesh.places[3 * v], y = mesh.places[3 * v + 1], z = mesh.places[3 * v + 2];
          positions.push_back(static_cast<float>(scale * x + (moved ? 7 : 0)));
          positions.push_back(static_cast<float>(scale * y));
          positions.push_back(static_cast<float>(scale * (z + bend * x * x / 20) + k));
        }
      Result<Input> input =
          open_input(test::files({obj, folder.write("a.npy", npy_of("<f4", {2, vertices, 3}, positions))}));
      EXPECT_TRUE(input.ok()) << error_of(input);
      return input ? input.value().notes() : std::vector<std::string>{};
    };
    EXPECT_TRUE(notes_of(0, 1, false).empty());
    EXPECT_TRUE(notes_of(1, 1, false).empty()) << "bent";
    EXPECT_TRUE(notes_of(0.5, 100, true).empty()) << "in another unit, and elsewhere";
    for (std::size_t v = vertices - 1; v > 0; --v) std::swap(order[v], order[random() % (v + 1)]);
    const std::vector<std::string> shuffled = notes_of(0, 1, false);
    ASSERT_EQ(shuffled.size(), 1U) << side;
    EXPECT_NE(shuffled[0].find("another order"), std::string::npos) << shuffled[0];
    if (side < 8) continue;
    ASSERT_EQ(notes_of(1, 3, true).size(), 1U) << side << ": bent and shuffled";
  }
}

TEST(FarOrigin, a_mesh_in_a_survey_has_the_positions_that_it_has_at_the_origin) {
  constexpr std::uint32_t kSeed = 5402;
  std::cout << "seed " << kSeed << '\n';
  std::mt19937 random(kSeed);
  for (int round = 0; round < 60; ++round) {
    // The coordinates are multiples of 1/1024. Ten decimal places represent such numbers exactly, and their sums are
    // exact in double.
    const auto number = [&](std::uint32_t most) { return static_cast<double>(random() % (most * 1024)) / 1024; };
    const std::vector<double> shift = {452312 + number(10000), 5411873 + number(10000), number(100)};
    const TemporaryFolder near, far;
    std::vector<double> all;
    for (int k = 0; k < 3; ++k) {
      Sheet mesh = sheet(6, 0);
      for (double& coordinate : mesh.places) coordinate += number(1);
      (void)near.write("f_" + std::to_string(k) + ".obj", obj_of(mesh));
      for (std::size_t i = 0; i < mesh.places.size(); ++i) mesh.places[i] += shift[i % 3];
      all.insert(all.end(), mesh.places.begin(), mesh.places.end());
      (void)far.write("f_" + std::to_string(k) + ".obj", obj_of(mesh));
    }
    const std::vector<std::uint32_t> corners = sheet(6, 0).corners;
    const std::string npz =
        far.write("far.npz", npz_of(npy_of("<f8", {3, 36, 3}, all), npy_of("<u4", {corners.size() / 3, 3}, corners)));
    const Motion at_origin = test::read_motion(test::files({near.path()})).value();
    EXPECT_EQ(at_origin.origin, (std::array<double, 3>{}));
    for (const bool stream : {false, true}) {
      for (const std::string& name : {far / "f_*.obj", npz}) {
        InputOptions options = test::files({name});
        options.stream = stream;
        options.kept_bytes = 0;
        const Result<Motion> read = test::read_motion(options);
        ASSERT_TRUE(read.ok()) << error_of(read);
        const Motion& motion = read.value();
        ASSERT_NE(motion.origin, (std::array<double, 3>{}));
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t i = 0; i < motion.keyframes[k].positions.size(); ++i)
            ASSERT_EQ(double{motion.keyframes[k].positions[i]} + motion.origin[i % 3],
                      double{at_origin.keyframes[k].positions[i]} + shift[i % 3]);
        // The reader has subtracted an origin from the positions, and the writers must add this origin again.
        for (const std::string out : {"out.npz", "out_%d.obj", "out_%d.ply"}) {
          const TemporaryFolder written;
          ASSERT_TRUE(write_motion(motion, written / out, false).ok());
          const Result<Motion> back =
              test::read_motion(test::files({out == "out.npz" ? written / out : written.path()}));
          ASSERT_TRUE(back.ok()) << error_of(back);
          for (std::size_t i = 0; i < motion.keyframes[2].positions.size(); ++i)
            ASSERT_EQ(double{back.value().keyframes[2].positions[i]} + back.value().origin[i % 3],
                      double{motion.keyframes[2].positions[i]} + motion.origin[i % 3]);
        }
      }
    }
  }
}

TEST(FarOrigin, what_float32_keeps_stays_as_it_is_and_what_it_has_lost_is_said) {
  const TemporaryFolder folder;
  const auto read = [&](double x, const std::string& type) -> Result<Input> {
    std::vector<double> wide;
    std::vector<float> single;
    for (int k = 0; k < 2; ++k)
      for (const double coordinate : {x, 0.0, 0.0, x + 1, 0.0, 0.0, x, 1.0, 0.5 * k}) {
        wide.push_back(coordinate);
        single.push_back(static_cast<float>(coordinate));
      }
    const std::string positions = type == "<f8" ? npy_of(type, {2, 3, 3}, wide) : npy_of(type, {2, 3, 3}, single);
    return open_input(test::files(
        {folder.write("a.npz", npz_of(positions, npy_of("<u4", {1, 3}, std::vector<std::uint32_t>{0, 1, 2})))}));
  };
  for (const std::string type : {"<f8", "<f4"}) {
    Result<Input> near = read(512, type);  // coordinates with no more digits than float32 holds
    ASSERT_TRUE(near.ok()) << error_of(near);
    EXPECT_TRUE(near.value().notes().empty());
    EXPECT_EQ(near.value().motion().value()->origin, (std::array<double, 3>{}));
  }
  Result<Input> far = read(5411873.3, "<f4");
  ASSERT_TRUE(far.ok()) << error_of(far);
  ASSERT_EQ(far.value().notes().size(), 1U);
  EXPECT_NE(far.value().notes()[0].find("steps of 0.5"), std::string::npos) << far.value().notes()[0];
  Result<Input> kept = read(5411873.3, "<f8");
  ASSERT_TRUE(kept.ok()) << error_of(kept);
  EXPECT_TRUE(kept.value().notes().empty());
  EXPECT_NE(kept.value().motion().value()->origin[0], 0);
}

TEST(FarOrigin, any_keyframe_tells_that_there_are_more_digits) {
  constexpr std::uint32_t kSeed = 5407;
  std::cout << "seed " << kSeed << '\n';
  std::mt19937 random(kSeed);
  const std::vector<std::uint32_t> corners = {0, 1, 2};
  for (int round = 0; round < 20; ++round) {
    // Only keyframe `telling` has numbers with more digits than float32 keeps.
    const std::size_t frames = 2 + random() % 10, telling = random() % frames;
    const TemporaryFolder folder;
    std::vector<double> all;
    std::string maya = test::MayaWriter(true).header(0);
    for (std::size_t k = 0; k < frames; ++k) {
      Sheet mesh{{452312, 5411873, 0, 452313, 5411873, 0, 452312, 5411874, static_cast<double>(k)}, corners};
      if (k == telling) {
        mesh.places[0] += 0.125 + 1.0 / 1024;
        mesh.places[4] += 0.0078125;
      }
      all.insert(all.end(), mesh.places.begin(), mesh.places.end());
      (void)folder.write("f_" + std::to_string(k) + ".obj", obj_of(mesh));
      const test::MayaWriter writer(true);
      const std::string points = writer.points<double>("body", mesh.places);
      maya += writer.group("MYCH", writer.integer("TIME", 250 * static_cast<std::int32_t>(k)) + points);
      (void)folder.write("eachFrame" + std::to_string(k) + ".mcx",
                         writer.header(250 * static_cast<std::int32_t>(k)) + writer.group("MYCH", points));
    }
    const std::string first = folder / "f_0.obj", cache = folder.write("one.mcx", maya),
                      each = folder.write("each.xml", test::maya_xml("OneFilePerFrame", "mcx", 250, 0, 0)),
                      one = folder.write("one.xml", test::maya_xml("OneFile", "mcx", 250, 0, 0)),
                      npz = folder.write("f.npz",
                                         npz_of(npy_of("<f8", {frames, 3, 3}, all), npy_of("<u4", {1, 3}, corners)));
    for (const bool stream : {false, true})
      for (const std::vector<std::string>& names : std::vector<std::vector<std::string>>{
               {folder / "f_*.obj"}, {npz}, {first, cache}, {first, one}, {first, each}}) {
        InputOptions options = test::files(names);
        options.stream = stream;
        options.kept_bytes = 0;
        const Result<Motion> read = test::read_motion(options);
        ASSERT_TRUE(read.ok()) << error_of(read);
        const Motion& motion = read.value();
        ASSERT_NE(motion.origin, (std::array<double, 3>{})) << names.back() << ", keyframe " << telling;
        for (std::size_t i = 0; i < all.size(); ++i)
          ASSERT_EQ(double{motion.keyframes[i / 9].positions[i % 9]} + motion.origin[i % 3], all[i]) << names.back();
      }
  }
}

TEST(Loops, come_back_to_the_first_keyframe) {
  const TemporaryFolder folder;
  for (int k = 0; k < 4; ++k) (void)folder.write("w_" + std::to_string(k) + ".obj", obj_of(sheet(3, k * k)));
  for (const bool stream : {false, true}) {
    InputOptions options = test::files({folder.path()}, 2);
    options.loop = true;
    options.stream = stream;
    options.kept_bytes = 0;
    const Result<Motion> motion = test::read_motion(options);
    ASSERT_TRUE(motion.ok()) << error_of(motion);
    ASSERT_EQ(motion.value().keyframes.size(), 5U);
    EXPECT_EQ(motion.value().keyframes[4].time, 2.0);
    EXPECT_EQ(motion.value().keyframes[4].positions, motion.value().keyframes[0].positions);
    // On a curved path, the motion is smooth where a loop closes. The velocity there is the difference between
    // keyframes 2 and 3, the neighbours on both sides, divided by the time between them.
    options.from = 1;
    const Motion straight = test::read_motion(options).value();
    ASSERT_EQ(straight.keyframes.size(), 4U);
    options.path = "catmull-rom:0.001";
    const Motion curved = test::read_motion(options).value();
    const auto &first = curved.keyframes.front(), &next = curved.keyframes[1], &last = curved.keyframes.back(),
               &before = curved.keyframes[curved.keyframes.size() - 2];
    ASSERT_GT(curved.keyframes.size(), 20U);
    EXPECT_EQ(last.positions, first.positions);
    for (std::size_t i = 0; i < first.positions.size(); ++i) {
      const float velocity = straight.keyframes[1].positions[i] - straight.keyframes[2].positions[i];
      const double tolerance = 0.05 * (1 + std::fabs(static_cast<double>(velocity)));
      EXPECT_NEAR((next.positions[i] - first.positions[i]) / (next.time - first.time), velocity, tolerance);
      EXPECT_NEAR((last.positions[i] - before.positions[i]) / (last.time - before.time), velocity, tolerance);
    }
  }
  InputOptions one = test::files({folder.path()});
  one.loop = true;
  one.to = 0;
  EXPECT_NE(error_of(open_input(one)), "");
  one = test::files({});
  one.samples = {"bumps"};
  one.loop = true;
  EXPECT_NE(error_of(open_input(one)).find("--loop"), std::string::npos);
}

TEST(Foreign, formats_of_other_programs_are_named_with_the_way_in) {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& name, const std::string& bytes) {
    std::string text;
    for (const bool alone : {true, false}) {
      InputOptions options = test::files({folder.write(name, bytes)});
      if (!alone) options.files.push_back(options.files[0]);
      text += error_of(open_input(options)) + '\n';
    }
    return text;
  };
  for (const auto& [name, bytes, kind] :
       std::vector<std::array<std::string, 3>>{{"walk.fbx", "Kaydara FBX Binary  ", "FBX"},
                                               {"walk.FBX", "", "FBX"},
                                               {"cloth.abc", "Ogawa\xFF", "Alembic"},
                                               {"cloth", "Ogawa\xFF", "Alembic"},
                                               {"a.usd", "PXR-USDC", "USD"},
                                               {"a.usda", "#usda 1.0", "USD"},
                                               {"a.usdz", "PK\3\4", "USD"},
                                               {"mesh.vtp", "<?xml version=\"1.0\"?><VTKFile/>", "VTK"},
                                               {"mesh.vtk", "# vtk DataFile Version 3.0", "VTK"}}) {
    const std::string text = said(name, bytes);
    EXPECT_NE(text.find(kind), std::string::npos) << name << text;
    EXPECT_EQ(text.find("docs/formats.md#") == std::string::npos, false) << name << text;
  }
  const std::string wide("v\0 \0001\0 \0002\0 \0003\0\n\0f\0 \0", 22);
  EXPECT_NE(said("plain.obj", wide + wide).find("UTF-16"), std::string::npos);
}

}  // namespace
}  // namespace chronormal::people_files_test
