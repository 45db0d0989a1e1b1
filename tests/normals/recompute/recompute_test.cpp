// Compares normals that are recomputed from positions at every t with exact rational arithmetic. If several calls must
// give the same result, also compares their results with each other.

#include "normals/recompute/recompute.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/schemes/scheme.h"
#include "core/memory.h"
#include "normals/curves/kernels/evaluate.h"
#include "normals/recompute/kernels/recompute_tiles.h"
#include "simd/targets.h"
#include "tests/support/elements.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"

namespace chronormal::recompute_test {
namespace {

constexpr double kPromised = 1e-6;  // in radians, the guaranteed largest error

using Normals = std::vector<Vec3f>;

Normals vectors(const VectorView<float>& view) {
  Normals result;
  for (std::size_t i = 0; i < view.count; ++i) result.push_back(view[i]);
  return result;
}

Normals evaluate(NormalRecompute& recompute, double t, Threads threads = Threads::kOne, std::size_t* zeros = nullptr) {
  std::vector<float> packed(3 * recompute.size(), 7.0f);
  const auto view = VectorView<float>::packed(packed.data(), recompute.size());
  const std::size_t count = recompute.unit_normals(t, view, threads);
  if (zeros != nullptr) *zeros = count;
  return vectors(view);
}

Normals of_faces(const Segment& segment, double t, std::size_t* zeros = nullptr) {
  NormalRecompute recompute(segment);
  return evaluate(recompute, t, Threads::kOne, zeros);
}

Normals of_groups(const Segment& segment, const NormalGroups& groups, double t, std::size_t* zeros = nullptr) {
  NormalRecompute recompute(segment, groups);
  return evaluate(recompute, t, Threads::kOne, zeros);
}

NormalGroups vertices_of(const Motion& motion) {
  return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
}

exact::Vector exact_point(const Segment& segment, std::uint32_t vertex, double t) {
  const Vec3f a = segment.from[vertex], b = segment.to[vertex];
  const exact::Vector start = exact::vector(a.x, a.y, a.z), end = exact::vector(b.x, b.y, b.z);
  exact::Vector result;
  for (std::size_t k = 0; k < 3; ++k) result[k] = start[k] + exact::Rational(t) * (end[k] - start[k]);
  return result;
}

// Returns the exact normal at t, by the shoelace formula about the origin.
exact::Vector exact_normal(const Segment& segment, std::size_t f, double t) {
  const auto face = segment.topology->face(f);
  exact::Vector sum;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const exact::Vector product =
        exact::cross(exact_point(segment, face[i], t), exact_point(segment, face[(i + 1) % face.size()], t));
    for (std::size_t k = 0; k < 3; ++k) sum[k] += product[k];
  }
  return sum;
}

double angle(const Vec3f& u, const exact::Vector& n) { return exact::angle(u.x, u.y, u.z, n); }

struct Family {
  const char* name;
  Motion (*make)();
};

constexpr std::size_t kFaces = 203;

// Makes faces with two nearly equal sides. These sides are so long that the product of their squares exceeds the range
// of float32.
Motion soup_with_far_first_corners() {
  Motion motion = fixtures::large_soup(kFaces);
  for (Motion::Keyframe& keyframe : motion.keyframes) {
    for (std::size_t f = 0; f < kFaces; ++f) {
      for (std::size_t k = 0; k < 3; ++k) keyframe.positions[9 * f + k] *= 1e13F;
    }
  }
  return motion;
}

const std::array<Family, 18> kFamilies{
    Family{"random, independent ends", [] { return fixtures::large_soup(kFaces); }},
    Family{"random, motion 0.2", [] { return fixtures::moderate_soup(kFaces); }},
    Family{"needles", [] { return fixtures::needle_soup(kFaces); }},
    Family{"needles of 1e-6", [] { return fixtures::soup({.face_count = kFaces, .seed = 43, .needle = 1e-6}); }},
    Family{"edges of 1e-6", [] { return fixtures::tiny_soup(kFaces); }},
    Family{"edges of 1e-13", [] { return fixtures::soup({.face_count = kFaces, .seed = 44, .size = 1e-13}); }},
    Family{"edges of 1e-20", [] { return fixtures::soup({.face_count = kFaces, .seed = 47, .size = 1e-20}); }},
    Family{"edges of 1e6", [] { return fixtures::huge_soup(kFaces); }},
    Family{"edges of 1e13", [] { return fixtures::soup({.face_count = kFaces, .seed = 48, .size = 1e13}); }},
    Family{"edges of 1e18", [] { return fixtures::soup({.face_count = kFaces, .seed = 45, .size = 1e18}); }},
    Family{"edges of 1e38", [] { return fixtures::soup({.face_count = kFaces, .seed = 49, .size = 6e38}); }},
    Family{"far off the origin", [] { return fixtures::far_soup(kFaces); }},
    Family{"passing a collapse by 0.1", [] { return fixtures::collapsing_soup(0.1, kFaces); }},
    Family{"passing a collapse by 1e-3", [] { return fixtures::collapsing_soup(1e-3, kFaces); }},
    Family{"motion of 1e-9 to 1", [] { return fixtures::graded_soup(kFaces); }},
    Family{"thinnest needles", [] { return fixtures::thinnest_soup(false, kFaces); }},
    Family{"thinnest needles in a plane", [] { return fixtures::thinnest_soup(true, kFaces); }},
    Family{"first corners far away", soup_with_far_first_corners},
};

const std::array<double, 7> kTimes{0, 1, 0.5, 1.0 / 3, 0x1p-30, 0.7300000190734863, 0.9};

TEST(Recompute, faces_are_within_the_promise_of_exact_arithmetic) {
  for (const Family& family : kFamilies) {
    const Motion motion = family.make();
    const Segment segment = motion.segment(0);
    double worst = 0;
    for (const double t : kTimes) {
      const Normals normals = of_faces(segment, t);
      for (std::size_t f = 0; f < normals.size(); ++f) {
        const exact::Vector expected = exact_normal(segment, f, t);
        if (!exact::is_zero(expected)) worst = std::max(worst, angle(normals[f], expected));
        EXPECT_NEAR(length(to_double(normals[f])), 1, 3e-7) << family.name;
      }
    }
    EXPECT_LE(worst, kPromised) << family.name;
  }
}

TEST(Recompute, hard_motions_are_within_the_promise_of_whole_numbers) {
  constexpr std::size_t kFewest = 4000;  // smallest number of faces of each family
  for (const test::HardMotions& family : test::hard_motions()) {
    fixtures::Random random(8200);
    double worst = 0;
    for (std::size_t done = 0; done < kFewest;) {
      const Motion motion = family.make(random);
      const Segment segment = motion.segment(0);
      done += motion.topology.face_count();
      const test::IntegerNormals oracle(segment);
      for (const double t : {0.0, 1.0, 0.5, 1 - 0x1p-30, random.uniform(0, 1), random.uniform(0, 1)}) {
        const std::vector<test::IntegerVector> expected = oracle.at(test::IntegerTime::of(t));
        const Normals normals = of_faces(segment, t);
        for (std::size_t f = 0; f < normals.size(); ++f) {
          if (test::is_zero(expected[f])) continue;
          worst = std::max(worst, test::angle_between(normals[f], test::direction_of(expected[f])));
        }
      }
    }
    EXPECT_LE(worst, kPromised) << family.name;
  }
}

// Returns the largest error of the normals of elements, in radians. The expected normals are sums of the exact normals
// of faces.
double worst_of_groups(const Segment& segment, const NormalGroups& groups, double t) {
  const Normals normals = of_groups(segment, groups, t);
  double worst = 0;
  for (std::size_t e = 0; e < groups.size(); ++e) {
    exact::Vector sum;
    for (const std::uint32_t f : groups.faces(e)) {
      const exact::Vector n = exact_normal(segment, f, t);
      for (std::size_t k = 0; k < 3; ++k) sum[k] += n[k];
    }
    if (!exact::is_zero(sum)) worst = std::max(worst, angle(normals[e], sum));
  }
  return worst;
}

// Makes random faces with few vertices, so the normals of the faces at a vertex partly cancel.
Motion tangle(std::size_t vertex_count, std::size_t face_count, double offset, std::uint64_t seed) {
  fixtures::Random random(seed);
  std::vector<fixtures::Point> from, to;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    for (auto* points : {&from, &to}) {
      fixtures::Point point = random.in_cube(0.5);
      for (double& c : point) c += offset;
      points->push_back(point);
    }
  }
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < 3 * face_count; ++i)
    corners.push_back(static_cast<std::uint32_t>(random.below(vertex_count)));
  return fixtures::make_motion(fixtures::make_triangles(vertex_count, std::move(corners)), from, to);
}

TEST(Recompute, vertices_are_within_the_promise_of_exact_arithmetic) {
  for (const double t : {0.0, 0.37, 1.0}) {
    const Motion smooth = fixtures::smooth_morph(9);
    EXPECT_LE(worst_of_groups(smooth.segment(0), vertices_of(smooth), t), kPromised);
    for (const double offset : {0.0, 1000.0}) {
      const Motion tangled = tangle(60, 200, offset, 3);
      EXPECT_LE(worst_of_groups(tangled.segment(0), vertices_of(tangled), t), kPromised) << offset;
    }
    for (const Family& family : kFamilies) {
      const Motion motion = family.make();
      EXPECT_LE(worst_of_groups(motion.segment(0), vertices_of(motion), t), kPromised) << family.name;
    }
  }
}

TEST(Recompute, corners_across_creases_and_polygons_are_within_the_promise) {
  const Motion smooth = fixtures::smooth_morph(7);
  const auto creased =
      NormalGroups::by_crease_angle(smooth, separate_points(smooth.topology.vertex_count()), 8).value();
  EXPECT_LT(creased.size(), smooth.topology.corner_count());
  EXPECT_GT(creased.size(), smooth.topology.vertex_count());
  EXPECT_LE(worst_of_groups(smooth.segment(0), creased, 0.6), kPromised);

  Motion mixed = smooth;  // polygons with 3, 4 and 5 corners
  std::vector<std::uint32_t> offsets = {0}, corners;
  for (std::uint32_t v = 0; v + 16 < 64; v += 2) {
    for (std::uint32_t c = 0; c < 3 + v / 2 % 3; ++c)
      corners.push_back(v + std::array<std::uint32_t, 5>{0, 1, 9, 16, 8}[c]);
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  mixed.topology = fixtures::make_polygons(64, offsets, corners);
  const Segment segment = mixed.segment(0);
  EXPECT_LE(worst_of_groups(segment, vertices_of(mixed), 0.6), kPromised);
  const Normals normals = of_faces(segment, 0.6);
  for (std::size_t f = 0; f < normals.size(); ++f)
    EXPECT_LE(angle(normals[f], exact_normal(segment, f, 0.6)), kPromised);
}

// The first `count` faces of a motion. The arrays of positions end with the last vertex of these faces.
struct Part {
  Part(const Motion& motion, std::size_t count) {
    const auto corners = motion.topology.corners().subspan(0, 3 * count);
    const std::size_t vertices = 1 + *std::max_element(corners.begin(), corners.end());
    topology = fixtures::make_triangles(vertices, {corners.begin(), corners.end()});
    for (std::size_t k : {std::size_t{0}, std::size_t{1}}) {
      positions[k] = std::make_unique<float[]>(3 * vertices);
      std::copy_n(motion.keyframes[k].positions.begin(), 3 * vertices, positions[k].get());
    }
    segment.topology = &topology;
    segment.from = VectorView<const float>::packed(positions[0].get(), vertices);
    segment.to = VectorView<const float>::packed(positions[1].get(), vertices);
  }

  Topology topology;
  std::array<std::unique_ptr<float[]>, 2> positions;
  Segment segment;
};

TEST(Recompute, every_number_of_faces_gives_what_many_give_on_every_instruction_set) {
  const Motion motion = fixtures::smooth_morph(8);
  const Normals all = of_faces(motion.segment(0), 0.3);
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    for (std::size_t count = 1; count <= 70; ++count) {
      const Part part(motion, count);
      const Normals normals = of_faces(part.segment, 0.3);
      ASSERT_EQ(normals, Normals(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)))
          << target_name(target) << ", " << count;
    }
  }
}

TEST(Recompute, every_layout_of_the_result_has_the_same_bits_and_nothing_else_is_written) {
  for (const std::size_t cells : {std::size_t{1}, std::size_t{3}, std::size_t{4}, std::size_t{9}}) {
    const Motion motion = fixtures::smooth_morph(cells);
    const NormalGroups groups = vertices_of(motion);
    NormalRecompute faces(motion.segment(0)), vertices(motion.segment(0), groups);
    for (NormalRecompute* const each : {&faces, &vertices}) {
      NormalRecompute& recompute = *each;
      const Normals expected = evaluate(recompute, 0.3);
      const std::size_t n = recompute.size();
      for (const std::size_t shift : {std::size_t{0}, std::size_t{1}}) {
        std::vector<float> memory(5 * n + 40, 7.0f);
        const auto planes = VectorView<float>::planes(memory.data() + shift, memory.data() + shift + n + 3,
                                                      memory.data() + shift + 2 * n + 6, n);
        recompute.unit_normals(0.3, planes);
        EXPECT_EQ(vectors(planes), expected);
        EXPECT_EQ(memory[shift + n], 7.0f);
        EXPECT_EQ(memory[shift + 3 * n + 6], 7.0f);

        memory.assign(memory.size(), 7.0f);
        const auto packed = VectorView<float>::packed(memory.data() + shift, n);
        recompute.unit_normals(0.3, packed);
        EXPECT_EQ(vectors(packed), expected);
        EXPECT_EQ(memory[shift + 3 * n], 7.0f);

        memory.assign(memory.size(), 7.0f);
        const VectorView<float> wide{memory.data() + shift, memory.data() + shift + 2, memory.data() + shift + 3, n, 5};
        recompute.unit_normals(0.3, wide);
        EXPECT_EQ(vectors(wide), expected);
        EXPECT_EQ(memory[shift + 1], 7.0f);
      }
    }
  }
}

TEST(Recompute, results_past_the_caches_have_the_same_bits) {
  // The library uses streaming stores only for large results (kStreamFrom), so the test calls the kernel directly.
  const Motion motion = fixtures::soup({.face_count = 203, .seed = 47, .size = 1e-20});
  const Segment segment = motion.segment(0);
  const MovingTriangles triangles{.corners = motion.topology.corners().data(),
                                  .face_count = 203,
                                  .from = segment.from.x,
                                  .to = segment.to.x,
                                  .vertex_count = segment.from.count};
  AlignedArray<float> cached(3 * 203), streamed(3 * 203);
  std::vector<std::uint32_t> doubtful(203), doubtful_streamed(203);
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    const auto evaluate_to = [&](AlignedArray<float>& result, bool stream, std::vector<std::uint32_t>& places) {
      std::fill_n(result.data(), result.size(), 7.0f);
      return recompute_unit_normals(triangles, {0, 203}, 0.3, VectorView<float>::packed(result.data(), 203), stream,
                                    places.data());
    };
    const std::size_t count = evaluate_to(cached, false, doubtful);
    EXPECT_GT(count, 150u);
    EXPECT_EQ(evaluate_to(streamed, true, doubtful_streamed), count);
    flush_stream();
    EXPECT_EQ(doubtful, doubtful_streamed);
    EXPECT_TRUE(std::equal(cached.data(), cached.data() + cached.size(), streamed.data())) << target_name(target);
  }
}

TEST(Recompute, every_layout_of_the_positions_has_the_same_bits) {
  const Motion motion = fixtures::smooth_morph(9);
  const NormalGroups groups = vertices_of(motion);
  const Segment packed = motion.segment(0);
  const std::size_t n = motion.topology.vertex_count();
  std::vector<float> planes(3 * n), wide(4 * n, 3e38f);
  for (std::size_t v = 0; v < n; ++v) {
    VectorView<float>::planes(planes.data(), planes.data() + n, planes.data() + 2 * n, n).set(v, packed.from[v]);
    VectorView<float>{wide.data(), wide.data() + 1, wide.data() + 2, n, 4}.set(v, packed.to[v]);
  }
  Segment other = packed;
  other.from = VectorView<const float>::planes(planes.data(), planes.data() + n, planes.data() + 2 * n, n);
  other.to = {wide.data(), wide.data() + 1, wide.data() + 2, n, 4};
  EXPECT_EQ(of_faces(packed, 0.3), of_faces(other, 0.3));
  EXPECT_EQ(of_groups(packed, groups, 0.3), of_groups(other, groups, 0.3));
}

MovingTriangles triangles_of(const Motion& motion) {
  const Segment segment = motion.segment(0);
  return {.corners = motion.topology.corners().data(),
          .face_count = motion.topology.face_count(),
          .from = segment.from.x,
          .to = segment.to.x,
          .vertex_count = segment.from.count};
}

TEST(Recompute, thin_triangles_are_left_to_nobody) {
  // The heights of the triangles in this test are 0.05 to 1e-6 of their sides. Edges in float32 are not accurate enough
  // for such triangles.
  for (const double needle : {0.05, 1e-3, 1e-6}) {
    const Motion motion = fixtures::soup({.face_count = 203, .seed = 43, .needle = needle});
    std::vector<float> result(3 * 203);
    std::vector<std::uint32_t> doubtful(203);
    for (const auto target : supported_targets()) {
      const ScopedTarget scope(target);
      EXPECT_LE(recompute_unit_normals(triangles_of(motion), {0, 203}, 0.3,
                                       VectorView<float>::packed(result.data(), 203), false, doubtful.data()),
                3U)
          << needle << ", " << target_name(target);
    }
  }
}

TEST(Recompute, triangles_one_by_one_have_the_bits_of_those_in_lanes) {
  for (const Family& family : kFamilies) {
    const Motion motion = family.make();
    const Segment packed = motion.segment(0);
    const std::size_t n = packed.from.count;
    std::vector<float> planes(3 * n);
    const auto view = VectorView<float>::planes(planes.data(), planes.data() + n, planes.data() + 2 * n, n);
    for (std::size_t v = 0; v < n; ++v) view.set(v, packed.from[v]);
    Segment other = packed;
    other.from = view;
    const auto scheme = make_scheme("recompute").value();
    scheme->prepare({&other, {0, kFaces}, {}});
    for (const double t : kTimes) {
      std::vector<float> one_by_one(3 * kFaces);
      scheme->evaluate(t, VectorView<float>::packed(one_by_one.data(), kFaces));
      EXPECT_EQ(vectors(VectorView<float>::packed(one_by_one.data(), kFaces)), of_faces(packed, t)) << family.name;
    }
  }
}

std::vector<std::size_t> as_it_is(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

TEST(Recompute, faces_in_any_order_give_vertices_the_same_bits) {
  const Motion motion = fixtures::smooth_morph(120);  // more faces than the window, which keeps 1,024 normals
  const std::size_t count = motion.topology.face_count();
  const Normals expected = of_groups(motion.segment(0), vertices_of(motion), 0.3);
  const auto expect_same = [&](const std::vector<std::size_t>& order) {
    const Motion other = test::with_faces_in_order(motion, order);
    EXPECT_EQ(of_groups(other.segment(0), vertices_of(other), 0.3), expected);
  };
  for (const std::size_t swaps : {1U, 7U, 40U, 1000U}) {
    SCOPED_TRACE(swaps);
    std::vector<std::size_t> order = as_it_is(count);  // swaps single faces over long distances
    for (std::size_t i = 0; i < swaps; ++i) std::swap(order[3 * i], order[count - 1 - 5 * i]);
    expect_same(order);
  }
  for (const std::size_t distance : {300U, 700U, 1000U, 1500U, 2500U}) {
    SCOPED_TRACE(distance);
    std::vector<std::size_t> order = as_it_is(count);  // swaps faces just inside and just outside the window
    for (std::size_t i = 0; i + distance < count; i += 5000) std::swap(order[i], order[i + distance]);
    expect_same(order);
  }
  for (const std::size_t block : {600U, 2000U, 5000U}) {
    SCOPED_TRACE(block);
    std::vector<std::size_t> order;  // an order that jumps back and forth
    for (std::size_t end = count; end > 0; end -= std::min(block, end)) {
      for (std::size_t i = end - std::min(block, end); i < end; ++i) order.push_back(i);
    }
    expect_same(order);
  }
  expect_same(test::shuffled_order(count, 5));  // needs an array of all face normals
}

TEST(Recompute, threads_do_not_share_windows) {
  const Motion motion = fixtures::smooth_morph(500);
  const NormalGroups groups = vertices_of(motion);
  NormalRecompute recompute(motion.segment(0), groups);
  const Normals expected = evaluate(recompute, 0.3);
  const ThreadLimit limit(4);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(evaluate(recompute, 0.3, Threads::kAll), expected);
}

TEST(Recompute, a_vertex_with_faces_everywhere_does_not_slow_or_change_the_others) {
  Motion motion = fixtures::smooth_morph(100);
  std::vector<std::uint32_t> corners(motion.topology.corners().begin(), motion.topology.corners().end());
  // Vertex 5 gets thousands of faces, inside and outside of the window of face normals that the library keeps at a
  // time.
  for (std::size_t i = 0; i < corners.size(); i += 30) corners[i] = 5;
  motion.topology = fixtures::make_triangles(motion.topology.vertex_count(), corners);
  const Normals expected = of_groups(motion.segment(0), vertices_of(motion), 0.3);
  const Motion shuffled = test::with_faces_in_order(motion, test::shuffled_order(motion.topology.face_count(), 6));
  EXPECT_EQ(of_groups(shuffled.segment(0), vertices_of(shuffled), 0.3), expected);
}

TEST(Recompute, vertices_in_any_order_give_faces_the_same_bits) {
  const Motion motion = fixtures::smooth_morph(220);  // more than a megabyte of positions
  Motion shuffled = motion;
  const auto order = test::shuffled_order(motion.topology.vertex_count(), 7);
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t v = 0; v < order.size(); ++v)
      std::copy_n(motion.keyframes[k].positions.data() + 3 * v, 3,
                  shuffled.keyframes[k].positions.data() + 3 * order[v]);
  }
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t v : motion.topology.corners()) corners.push_back(static_cast<std::uint32_t>(order[v]));
  shuffled.topology = fixtures::make_triangles(order.size(), std::move(corners));
  const Normals expected = of_faces(motion.segment(0), 0.3);
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    NormalRecompute recompute(shuffled.segment(0));
    EXPECT_GT(recompute.bytes(), 0u);
    EXPECT_EQ(evaluate(recompute, 0.3), expected) << target_name(target);
  }
}

TEST(Recompute, every_instruction_set_and_number_of_threads_has_the_same_bits) {
  const Motion smooth = fixtures::smooth_morph(100), tangled = tangle(9001, 20003, 0, 8);
  for (const Motion* motion : {&smooth, &tangled}) {
    const NormalGroups groups = vertices_of(*motion);
    NormalRecompute faces(motion->segment(0)), vertices(motion->segment(0), groups);
    const Normals expected_faces = evaluate(faces, 0.3), expected_vertices = evaluate(vertices, 0.3);
    for (const auto target : supported_targets()) {
      const ScopedTarget scope(target);
      EXPECT_EQ(evaluate(faces, 0.3), expected_faces) << target_name(target);
      EXPECT_EQ(evaluate(vertices, 0.3), expected_vertices) << target_name(target);
    }
    for (const std::size_t threads : {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{8}}) {
      const ThreadLimit limit(threads);
      EXPECT_EQ(evaluate(faces, 0.3, Threads::kAll), expected_faces) << threads;
      EXPECT_EQ(evaluate(vertices, 0.3, Threads::kAll), expected_vertices) << threads;
    }
  }
}

TEST(Recompute, needles_and_collapses_have_the_same_bits_on_every_instruction_set) {
  for (const Family& family : kFamilies) {
    const Motion motion = family.make();
    const NormalGroups groups = vertices_of(motion);
    const Normals faces = of_faces(motion.segment(0), 0.3), vertices = of_groups(motion.segment(0), groups, 0.3);
    for (const auto target : supported_targets()) {
      const ScopedTarget scope(target);
      EXPECT_EQ(of_faces(motion.segment(0), 0.3), faces) << family.name << ", " << target_name(target);
      EXPECT_EQ(of_groups(motion.segment(0), groups, 0.3), vertices) << family.name << ", " << target_name(target);
    }
  }
}

TEST(Recompute, a_collapse_takes_the_limit_and_nothing_at_all_is_zero_and_counted) {
  // The first face collapses to a line at t = 1/2, the second grows out of a point, the third remains a point, and the
  // fourth is ordinary.
  const std::vector<fixtures::Point> from = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 2, 2}, {2, 2, 2}, {2, 2, 2},
                                             {3, 3, 3}, {3, 3, 3}, {3, 3, 3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<fixtures::Point> to = {{0, 0, 0}, {1, 0, 0}, {0, -1, 0}, {2, 2, 2}, {3, 2, 2}, {2, 3, 2},
                                           {4, 4, 4}, {4, 4, 4}, {4, 4, 4},  {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Motion motion = fixtures::make_motion(fixtures::make_soup(4), from, to);
  const NormalGroups groups = vertices_of(motion);
  std::size_t zeros = 0;
  const Normals middle = of_faces(motion.segment(0), 0.5, &zeros);
  EXPECT_EQ(middle, (Normals{{0, 0, 1}, {0, 0, 1}, {0, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(zeros, 1u);
  EXPECT_EQ(of_faces(motion.segment(0), 0.0)[1], (Vec3f{0, 0, 1}));
  const Normals vertices = of_groups(motion.segment(0), groups, 0.5, &zeros);
  EXPECT_EQ(zeros, 3u);
  for (std::size_t v = 0; v < 12; ++v) EXPECT_EQ(vertices[v], middle[v / 3]);
}

TEST(Recompute, a_line_for_ever_is_no_direction_made_of_rounding) {
  // Corner c is on the line through a and b at both ends, and therefore at every t. At t = 0.3, rounding in double puts
  // corner c slightly beside the line.
  const std::vector<fixtures::Point> from = {{0, 0, 0}, {1, 2, 3}, {3, 6, 9}};
  const std::vector<fixtures::Point> to = {{0, 0, 0}, {5, 7, 11}, {15, 21, 33}};
  const Motion motion = fixtures::make_motion(fixtures::make_soup(1), from, to);
  for (const double t : {0.1, 0.2, 0.3, 0.7, 0.77}) {
    std::size_t zeros = 0;
    EXPECT_EQ(of_faces(motion.segment(0), t, &zeros)[0], Vec3f{}) << t;
    EXPECT_EQ(zeros, 1u);
    (void)of_groups(motion.segment(0), vertices_of(motion), t, &zeros);
    EXPECT_EQ(zeros, 3u) << t;
  }
}

TEST(Recompute, isolated_vertices_are_zero_and_counted_wherever_they_are) {
  Motion motion = fixtures::smooth_morph(20);
  const std::size_t used = motion.topology.vertex_count();
  const Normals expected = of_groups(motion.segment(0), vertices_of(motion), 0.3);
  for (Motion::Keyframe& keyframe : motion.keyframes) keyframe.positions.resize(3 * (used + 700));
  const auto corners = motion.topology.corners();
  motion.topology = fixtures::make_triangles(used + 700, {corners.begin(), corners.end()});
  std::size_t zeros = 0;
  const Normals normals = of_groups(motion.segment(0), vertices_of(motion), 0.3, &zeros);
  EXPECT_EQ(zeros, 700u);
  EXPECT_EQ(Normals(normals.begin(), normals.begin() + static_cast<std::ptrdiff_t>(used)), expected);
  EXPECT_EQ(normals.back(), Vec3f{});
}

TEST(Recompute, positions_may_change_between_calls) {
  Motion motion = fixtures::smooth_morph(10);
  NormalRecompute recompute(motion.segment(0));
  const Normals before = evaluate(recompute, 0.3);
  for (float& c : motion.keyframes[1].positions) c = -2 * c;
  const Normals after = evaluate(recompute, 0.3);
  EXPECT_NE(before, after);
  EXPECT_EQ(after, of_faces(motion.segment(0), 0.3));
}

TEST(Recompute, the_scheme_has_the_same_bits_for_any_range_of_faces) {
  const Motion motion = fixtures::smooth_morph(30);
  const Segment segment = motion.segment(0);
  const Normals all = of_faces(segment, 0.3);
  const auto scheme = make_scheme("recompute").value();
  for (const IndexRange range : {IndexRange{0, 1800}, IndexRange{17, 1}, IndexRange{100, 1500}, IndexRange{1799, 1}}) {
    std::vector<float> packed(3 * range.count);
    const auto view = VectorView<float>::packed(packed.data(), range.count);
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(range.first);
    const Normals expected(begin, begin + static_cast<std::ptrdiff_t>(range.count));
    scheme->prepare({&segment, range, {}});
    scheme->evaluate(0.3, view);
    EXPECT_EQ(vectors(view), expected);
  }
}

TEST(Recompute, nothing_is_no_trouble) {
  NormalRecompute none;
  EXPECT_EQ(none.size(), 0u);
  EXPECT_EQ(none.unit_normals(0.5, {}), 0u);
  const Motion empty = fixtures::make_motion(fixtures::make_triangles(0, {}), {}, {});
  EXPECT_EQ(of_faces(empty.segment(0), 0.5).size(), 0u);
  const Motion points = fixtures::make_motion(fixtures::make_triangles(3, {}), std::vector<fixtures::Point>(3),
                                              std::vector<fixtures::Point>(3));
  std::size_t zeros = 0;
  EXPECT_EQ(of_groups(points.segment(0), vertices_of(points), 0.5, &zeros), Normals(3));
  EXPECT_EQ(zeros, 3u);
}

}  // namespace
}  // namespace chronormal::recompute_test
