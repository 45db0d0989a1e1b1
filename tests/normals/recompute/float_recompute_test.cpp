// Compares FloatRecompute with arithmetic in double. If several calls must give the same result, also compares their
// results with each other.

#include "chronormal/normals/float_recompute.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "core/memory.h"
#include "normals/curves/kernels/evaluate.h"
#include "normals/recompute/kernels/float_rings.h"
#include "simd/targets.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"

namespace chronormal::float_recompute_test {
namespace {

using Normals = std::vector<Vec3f>;

Normals evaluate(FloatRecompute& recompute, const Segment& segment, double t, Threads threads = Threads::kOne,
                 std::size_t* zeros = nullptr) {
  std::vector<float> packed(3 * recompute.size(), 7.0f);
  const auto view = VectorView<float>::packed(packed.data(), recompute.size());
  const std::size_t count = recompute.unit_normals(segment, t, view, threads);
  if (zeros != nullptr) *zeros = count;
  Normals result;
  for (std::size_t i = 0; i < view.count; ++i) result.push_back(view[i]);
  return result;
}

NormalGroups vertices_of(const Motion& motion) {
  return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
}

// A sum of face normals in double, computed by the shoelace formula about a point of the face, and the error in radians
// that float32 may cause. Each position is rounded a few times, in proportion to its size. The error of the direction
// is this rounding error divided by the length of the edges around the face.
struct Expected {
  Vec3d n;
  double error = 0;
};

void add_face(const Segment& segment, std::size_t f, double t, Expected& sum) {
  const auto face = segment.topology->face(f);
  const auto point = [&](std::size_t i) {
    const std::uint32_t v = face[i % face.size()];
    return (1 - t) * to_double(segment.from[v]) + t * to_double(segment.to[v]);
  };
  double size = 0, around = 0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const std::uint32_t v = face[i];
    sum.n = sum.n + cross(point(i) - point(0), point(i + 1) - point(0));
    size = std::max({size, max_abs(to_double(segment.from[v])), max_abs(to_double(segment.to[v]))});
    around += length(point(i + 1) - point(i));
  }
  sum.error += 20 * 0x1p-24 * size * around;
}

void expect_close(const Normals& normals, const std::vector<Expected>& expected, const std::string& what) {
  ASSERT_EQ(normals.size(), expected.size());
  std::size_t compared = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const double limit = expected[i].error / length(expected[i].n);
    if (!(limit < 0.1)) continue;  // float32 is not accurate enough to guarantee anything
    ++compared;
    const Vec3d u = to_double(normals[i]);
    EXPECT_NEAR(length(u), 1, 4e-7) << what << ", " << i;
    EXPECT_LE(length(cross(u, expected[i].n)) / length(expected[i].n), limit + 3e-7) << what << ", " << i;
    EXPECT_GT(dot(u, expected[i].n), 0) << what << ", " << i;
  }
  EXPECT_GT(2 * compared, normals.size()) << what;
}

void check_faces(const Motion& motion, const std::string& what) {
  FloatRecompute recompute(motion.topology);
  for (const double t : {0.0, 0.37, 1.0}) {
    std::vector<Expected> expected(motion.topology.face_count());
    for (std::size_t f = 0; f < expected.size(); ++f) add_face(motion.segment(0), f, t, expected[f]);
    expect_close(evaluate(recompute, motion.segment(0), t), expected, what);
  }
}

void check_groups(const Motion& motion, const NormalGroups& groups, const std::string& what) {
  FloatRecompute recompute(motion.topology, groups);
  for (const double t : {0.0, 0.37, 1.0}) {
    std::vector<Expected> expected(groups.size());
    for (std::size_t e = 0; e < groups.size(); ++e) {
      for (const std::uint32_t f : groups.faces(e)) add_face(motion.segment(0), f, t, expected[e]);
    }
    expect_close(evaluate(recompute, motion.segment(0), t), expected, what);
  }
}

// Makes a mesh of polygons with 3, 4 or 5 corners.
Motion polygons() {
  Motion mixed = fixtures::smooth_morph(7);
  std::vector<std::uint32_t> offsets = {0}, corners;
  for (std::uint32_t v = 0; v + 16 < 64; v += 2) {
    for (std::uint32_t c = 0; c < 3 + v / 2 % 3; ++c)
      corners.push_back(v + std::array<std::uint32_t, 5>{0, 1, 9, 16, 8}[c]);
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  mixed.topology = fixtures::make_polygons(64, offsets, corners);
  return mixed;
}

// Makes a fan of triangles around vertex 0, with the faces in random order. If is_open, one triangle is missing.
Motion fan(std::size_t faces, bool is_open) {
  std::vector<fixtures::Point> from = {{0, 0, 0.3}}, to = {{0, 0, -0.1}};
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < faces; ++i) {
    const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(faces);
    from.push_back({std::cos(angle), std::sin(angle), 0});
    to.push_back({2 * std::cos(angle), std::sin(angle), 0.2 * std::cos(2 * angle)});
  }
  for (const std::size_t i : test::shuffled_order(faces, 3)) {
    if (is_open && i + 1 == faces) continue;
    for (const std::size_t v : {std::size_t{0}, i + 1, (i + 1) % faces + 1})
      corners.push_back(static_cast<std::uint32_t>(v));
  }
  return fixtures::make_motion(fixtures::make_triangles(from.size(), std::move(corners)), from, to);
}

// Makes random faces with few vertices. The paths around a vertex may then be open, or continue in several ways.
Motion tangle(std::size_t vertex_count, std::size_t face_count) {
  fixtures::Random random(3);
  std::vector<fixtures::Point> from, to;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    from.push_back(random.in_cube(0.5));
    to.push_back(random.in_cube(0.5));
  }
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < 3 * face_count; ++i)
    corners.push_back(static_cast<std::uint32_t>(random.below(vertex_count)));
  return fixtures::make_motion(fixtures::make_triangles(vertex_count, std::move(corners)), from, to);
}

TEST(FloatRecompute, faces_are_as_right_as_float32_positions_allow) {
  check_faces(fixtures::smooth_morph(9), "smooth");
  check_faces(fixtures::moderate_soup(203), "soup");
  check_faces(fixtures::needle_soup(203), "needles");
  check_faces(fixtures::tiny_soup(203), "edges of 1e-6");
  check_faces(fixtures::huge_soup(203), "edges of 1e6");
  check_faces(polygons(), "polygons");
}

TEST(FloatRecompute, vertices_are_as_right_as_float32_positions_allow) {
  for (const Motion& motion : {fixtures::smooth_morph(9), fixtures::moderate_soup(203), polygons(), tangle(300, 700),
                               tangle(60, 200), tangle(5, 300)}) {
    check_groups(motion, vertices_of(motion), std::to_string(motion.topology.vertex_count()));
  }
  for (const std::size_t faces : {3U, 16U, 63U, 64U, 65U, 1000U}) {
    for (const bool is_open : {false, true}) {
      const Motion motion = fan(faces, is_open);
      check_groups(motion, vertices_of(motion), std::to_string(faces));
    }
  }
}

TEST(FloatRecompute, corners_across_creases_and_seams_are_as_right) {
  const Motion smooth = fixtures::smooth_morph(7);
  const auto creased =
      NormalGroups::by_crease_angle(smooth, separate_points(smooth.topology.vertex_count()), 8).value();
  ASSERT_LT(creased.size(), smooth.topology.corner_count());
  ASSERT_GT(creased.size(), smooth.topology.vertex_count());
  check_groups(smooth, creased, "creases");

  const Motion torn = test::torn(smooth);  // every face has its own vertices
  const NormalGroups welded = NormalGroups::of_vertices(torn.topology, weld_coincident(torn));
  ASSERT_EQ(welded.size(), smooth.topology.vertex_count());
  check_groups(torn, welded, "seams");

  // Each point of this mesh consists of three vertices that are at different positions.
  const Motion tangled = tangle(60, 200);
  Points points{std::vector<std::uint32_t>(60), 20};
  for (std::uint32_t v = 0; v < 60; ++v) points.point_of_vertex[v] = v / 3;
  check_groups(tangled, NormalGroups::of_vertices(tangled.topology, points), "any points");
}

TEST(FloatRecompute, a_closed_ring_of_six_has_seven_points_and_a_centre) {
  const Motion motion = fan(6, false);
  const FloatRecompute recompute(motion.topology, vertices_of(motion));
  // One slice (the paths of up to 16 elements) holds 7 elements with 7 positions. If the paths of neighbours were not
  // joined, the slice would hold 12 positions.
  EXPECT_EQ(recompute.bytes(), 16 * (1 + 7) * sizeof(std::uint32_t) + 2 * sizeof(std::size_t) + 7 * 16);
}

TEST(FloatRecompute, what_has_no_normal_in_float32_gets_zeros_and_is_counted) {
  Motion motion = fixtures::smooth_morph(7);
  std::vector<std::uint32_t> corners(motion.topology.corners().begin(), motion.topology.corners().end());
  corners[1] = corners[0];                                  // face 0 has no area
  for (std::size_t i = 9; i < 12; ++i) corners[i] = 63;     // face 3 has no area either
  motion.topology = fixtures::make_triangles(65, corners);  // vertex 64 belongs to no face
  for (auto& keyframe : motion.keyframes) keyframe.positions.insert(keyframe.positions.end(), {1, 2, 3});
  std::size_t zeros = 0;
  FloatRecompute faces(motion.topology), vertices(motion.topology, vertices_of(motion));
  const Normals of_faces = evaluate(faces, motion.segment(0), 0.5, Threads::kOne, &zeros);
  EXPECT_EQ(zeros, 2U);
  for (std::size_t f = 0; f < of_faces.size(); ++f) EXPECT_EQ(of_faces[f] == Vec3f{}, f == 0 || f == 3) << f;
  const Normals of_vertices = evaluate(vertices, motion.segment(0), 0.5, Threads::kOne, &zeros);
  EXPECT_EQ(zeros, 1U);
  EXPECT_EQ(of_vertices[64], Vec3f{});

  // An infinite coordinate must affect only the faces of its own vertex.
  motion.keyframes[0].positions[3 * 30] = std::numeric_limits<float>::infinity();
  const Normals beside = evaluate(faces, motion.segment(0), 0.5, Threads::kOne, &zeros);
  EXPECT_GT(zeros, 2U);
  for (std::size_t f = 0; f < beside.size(); ++f) {
    const auto face = motion.topology.face(f);
    const bool is_touched = std::find(face.begin(), face.end(), 30U) != face.end();
    EXPECT_EQ(beside[f], is_touched ? Vec3f{} : of_faces[f]) << f;
  }
  // The edges of the scaled meshes are so short or so long that the squares of their lengths leave the range of
  // float32.
  for (const float size : {1e-13F, 1e11F}) {
    Motion scaled = fixtures::smooth_morph(3);
    for (auto& keyframe : scaled.keyframes) {
      for (float& c : keyframe.positions) c *= size;
    }
    FloatRecompute recompute(scaled.topology);
    const Normals none = evaluate(recompute, scaled.segment(0), 0.5, Threads::kOne, &zeros);
    EXPECT_EQ(zeros, none.size());
    EXPECT_TRUE(std::all_of(none.begin(), none.end(), [](const Vec3f& n) { return n == Vec3f{}; }));
  }
}

TEST(FloatRecompute, times_outside_a_segment_are_its_ends_and_no_time_has_no_normals) {
  const Motion motion = fixtures::smooth_morph(5);
  FloatRecompute recompute(motion.topology, vertices_of(motion));
  EXPECT_EQ(evaluate(recompute, motion.segment(0), -3), evaluate(recompute, motion.segment(0), 0));
  EXPECT_EQ(evaluate(recompute, motion.segment(0), 7), evaluate(recompute, motion.segment(0), 1));
  std::size_t zeros = 0;
  const Normals none = evaluate(recompute, motion.segment(0), std::nan(""), Threads::kOne, &zeros);
  EXPECT_EQ(zeros, none.size());
  EXPECT_EQ(none, Normals(none.size()));
  EXPECT_EQ(FloatRecompute().size(), 0U);
  EXPECT_EQ(FloatRecompute().unit_normals(motion.segment(0), 0.5, {}), 0U);
}

TEST(FloatRecompute, positions_as_they_are_have_the_bits_of_a_segment_that_begins_with_them) {
  const Motion motion = fixtures::smooth_morph(9);
  for (const bool of_faces : {true, false}) {
    FloatRecompute recompute =
        of_faces ? FloatRecompute(motion.topology) : FloatRecompute(motion.topology, vertices_of(motion));
    std::vector<float> packed(3 * recompute.size());
    const auto view = VectorView<float>::packed(packed.data(), recompute.size());
    EXPECT_EQ(recompute.unit_normals(motion.segment(0).from, view), 0U);
    const Normals expected = evaluate(recompute, motion.segment(0), 0);
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(view[i], expected[i]);
  }
}

TEST(FloatRecompute, every_layout_and_number_of_elements_has_the_same_bits_and_nothing_else_is_written) {
  for (std::size_t count = 1; count <= 40; ++count) {
    Motion motion = fixtures::smooth_morph(8);
    const auto corners = motion.topology.corners().subspan(0, 3 * count);
    // Each array of positions ends with the last vertex that is used, so that a sanitizer can detect reads beyond it.
    const std::size_t vertices = 1 + *std::max_element(corners.begin(), corners.end());
    motion.topology = fixtures::make_triangles(vertices, {corners.begin(), corners.end()});
    std::array<std::unique_ptr<float[]>, 2> positions;
    for (const std::size_t k : {0U, 1U}) {
      positions[k] = std::make_unique<float[]>(3 * vertices);
      std::copy_n(motion.keyframes[k].positions.begin(), 3 * vertices, positions[k].get());
    }
    Segment segment;
    segment.topology = &motion.topology;
    segment.from = VectorView<const float>::packed(positions[0].get(), vertices);
    segment.to = VectorView<const float>::packed(positions[1].get(), vertices);
    std::vector<float> planes(3 * vertices);
    Segment other = segment;
    const auto plane = [&](std::size_t k) { return planes.data() + k * vertices; };
    for (std::size_t v = 0; v < vertices; ++v)
      VectorView<float>::planes(plane(0), plane(1), plane(2), vertices).set(v, segment.to[v]);
    other.to = VectorView<const float>::planes(plane(0), plane(1), plane(2), vertices);

    for (const bool of_faces : {true, false}) {
      FloatRecompute recompute =
          of_faces ? FloatRecompute(motion.topology) : FloatRecompute(motion.topology, vertices_of(motion));
      const std::size_t n = recompute.size();
      Normals expected;
      {
        const ScopedTarget scope(supported_targets().back());
        expected = evaluate(recompute, segment, 0.3);
      }
      EXPECT_EQ(evaluate(recompute, other, 0.3), expected);
      for (const auto target : supported_targets()) {
        const ScopedTarget scope(target);
        for (const std::size_t shift : {0U, 1U}) {
          std::vector<float> memory(5 * n + 40, 7.0f);
          float* const to = memory.data() + shift;
          const std::array<VectorView<float>, 3> views{VectorView<float>::planes(to, to + n + 3, to + 2 * n + 6, n),
                                                       VectorView<float>::packed(to, n),
                                                       VectorView<float>{to, to + 2, to + 3, n, 5}};
          const std::array<std::size_t, 3> untouched{n, 3 * n, 1};
          for (std::size_t k = 0; k < views.size(); ++k) {
            std::fill(memory.begin(), memory.end(), 7.0f);
            recompute.unit_normals(segment, 0.3, views[k]);
            for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(views[k][i], expected[i]) << target_name(target) << ", " << k;
            EXPECT_EQ(to[untouched[k]], 7.0f);
          }
        }
      }
    }
  }
}

TEST(FloatRecompute, every_instruction_set_and_number_of_threads_has_the_same_bits) {
  for (const Motion& motion : {fixtures::smooth_morph(100), tangle(9001, 20003), tangle(70001, 20003)}) {
    const NormalGroups groups = vertices_of(motion);
    FloatRecompute faces(motion.topology), vertices(motion.topology, groups);
    const Segment segment = motion.segment(0);
    const Normals expected_faces = evaluate(faces, segment, 0.3), expected_vertices = evaluate(vertices, segment, 0.3);
    for (const auto target : supported_targets()) {
      const ScopedTarget scope(target);
      EXPECT_EQ(evaluate(faces, segment, 0.3), expected_faces) << target_name(target);
      EXPECT_EQ(evaluate(vertices, segment, 0.3), expected_vertices) << target_name(target);
    }
    for (const std::size_t threads : {2U, 3U, 8U}) {
      const ThreadLimit limit(threads);
      EXPECT_EQ(evaluate(faces, segment, 0.3, Threads::kAll), expected_faces) << threads;
      EXPECT_EQ(evaluate(vertices, segment, 0.3, Threads::kAll), expected_vertices) << threads;
    }
  }
}

TEST(FloatRecompute, results_past_the_caches_have_the_same_bits) {
  // The library uses streaming stores only for large results (kStreamFrom), so the test calls the kernel directly.
  const Motion motion = fixtures::smooth_morph(10);
  const Segment segment = motion.segment(0);
  const std::size_t n = motion.topology.face_count();
  std::vector<float> rows(4 * segment.from.count);
  interpolate_points(segment.from, segment.to, 0.5f, 0.5f, {0, segment.from.count}, rows.data());
  AlignedArray<float> cached(3 * n), streamed(3 * n);
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    for (const bool stream : {false, true}) {
      auto& result = stream ? streamed : cached;
      std::fill_n(result.data(), result.size(), 7.0f);
      EXPECT_EQ(triangle_unit_normals({rows.data(), false}, motion.topology.corners().data(), n, {0, n},
                                      VectorView<float>::packed(result.data(), n), stream),
                0U);
    }
    flush_stream();
    EXPECT_TRUE(std::equal(cached.data(), cached.data() + cached.size(), streamed.data())) << target_name(target);
  }
}

}  // namespace
}  // namespace chronormal::float_recompute_test
