// Tests MeshNormals, which makes the normals of a mesh from arrays: which vertices share a normal, the vertices that
// show each normal, ranges and threads, and refused input. The expected normals are sums of cross products in double or
// in integers.
#include "chronormal/normals/mesh_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iostream>
#include <limits>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/allocation_counter.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"

namespace chronormal::mesh_normals_test {
namespace {

using fixtures::Random;

// Two triangles share an edge. In one mesh, they use the same vertices (0 1 2 and 2 1 3). In the other mesh, the edge
// is a seam: vertices 4 and 5 are at the positions of vertices 1 and 2.
const std::vector<std::uint32_t> kCorners = {0, 1, 2, 5, 4, 3};
const std::vector<float> kFrom = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.5F, 1, 0, 0, 0, 1, 0};
const std::vector<float> kTo = {0, 0, 1, 1, 0.5F, 0, 0, 1, 1, 2, 1, -1, 1, 0.5F, 0, 0, 1, 1};

VectorView<const float> view(const std::vector<float>& values) {
  return VectorView<const float>::packed(values.data(), values.size() / 3);
}

Topology pair_of_triangles() { return Topology::triangles(6, kCorners).value(); }

Result<MeshNormals> normals_of(const MeshNormalsOptions& options) {
  Result<MeshNormals> made = MeshNormals::make(pair_of_triangles(), options);
  if (!made) return made;
  if (const Status status = made.value().set_segment(view(kFrom), view(kTo)); !status) return status.error();
  return made;
}

Vec3d position(std::size_t v, double t) {
  const auto at = [&](std::size_t c) { return (1 - t) * kFrom[3 * v + c] + t * kTo[3 * v + c]; };
  return {at(0), at(1), at(2)};
}

Vec3d face_normal(std::size_t f, double t) {
  const Vec3d a = position(kCorners[3 * f], t);
  return cross(position(kCorners[3 * f + 1], t) - a, position(kCorners[3 * f + 2], t) - a);
}

std::vector<float> normals_at(const MeshNormals& normals, double t) {
  std::vector<float> result(3 * normals.size(), 7.0F);
  EXPECT_EQ(normals.unit_normals(t, VectorView<float>::packed(result.data(), normals.size())), 0U);
  return result;
}

void expect_direction(const std::vector<float>& normals, std::size_t i, const Vec3d& right) {
  const Vec3d shown = to_double(view(normals)[i]);
  EXPECT_LT(length(shown - unit(right)), 1e-6) << "output " << i;
}

TEST(MeshNormals, faces_have_their_own_normals) {
  const Result<MeshNormals> normals = normals_of({{ElementKind::kFaces}});
  ASSERT_EQ(normals.value().size(), 2U);
  for (const double t : {0.0, 0.3, 1.0})
    for (std::size_t f = 0; f < 2; ++f) expect_direction(normals_at(normals.value(), t), f, face_normal(f, t));
}

TEST(MeshNormals, options_without_a_kind_mean_vertices) {
  const Motion motion = fixtures::smooth_morph(3);
  const std::size_t vertices = motion.topology.vertex_count();
  EXPECT_EQ(MeshNormals::make(motion.topology).value().size(), vertices);
  EXPECT_EQ(MeshNormals::make(motion.topology, {.elements = {.weld = false}}).value().size(), vertices);
}

TEST(MeshNormals, vertices_across_a_seam_share_a_normal_unless_they_are_separate) {
  MeshNormalsOptions options;
  const Result<MeshNormals> welded = normals_of(options);
  options.elements.weld = false;
  const Result<MeshNormals> separate = normals_of(options);
  EXPECT_EQ(welded.value().element_count(), 4U);
  for (const double t : {0.0, 0.3, 1.0}) {
    const std::vector<float> one = normals_at(welded.value(), t), two = normals_at(separate.value(), t);
    const Vec3d left = face_normal(0, t), right = face_normal(1, t);
    expect_direction(one, 0, left);
    expect_direction(one, 1, left + right);
    expect_direction(one, 4, left + right);
    expect_direction(one, 3, right);
    expect_direction(two, 1, left);
    expect_direction(two, 4, right);
  }
}

TEST(MeshNormals, a_motion_says_in_all_its_keyframes_which_vertices_are_one) {
  // In the third keyframe, vertices 1 and 4 are apart. Vertices share a normal only if they coincide in all keyframes,
  // so vertices 1 and 4 have separate normals in the first segment, too.
  Motion motion;
  motion.topology = pair_of_triangles();
  std::vector<float> open = kTo;
  open[3 * 4] += 1;
  motion.keyframes = {{kFrom, 0, ""}, {kTo, 1, ""}, {open, 2, ""}};
  motion.connect_as_sequence();
  MeshNormals normals = MeshNormals::make(motion).value();
  EXPECT_EQ(normals.element_count(), 5U);
  ASSERT_TRUE(normals.set_segment(motion.segment(0)));
  expect_direction(normals_at(normals, 0.3), 4, face_normal(1, 0.3));
}

TEST(MeshNormals, corners_keep_hard_edges_apart) {
  MeshNormalsOptions options{{ElementKind::kCorners}};
  options.elements.crease_angle = 1;
  const Result<MeshNormals> hard = normals_of(options);
  options.elements.crease_angle = 180;
  const Result<MeshNormals> smooth = normals_of(options);
  const std::vector<float> apart = normals_at(hard.value(), 0.5), joined = normals_at(smooth.value(), 0.5);
  const Vec3d left = face_normal(0, 0.5), right = face_normal(1, 0.5);
  expect_direction(apart, 1, left);
  expect_direction(apart, 4, right);
  expect_direction(joined, 1, left + right);
  expect_direction(joined, 4, left + right);
}

TEST(MeshNormals, hard_edges_of_the_caller_are_copied) {
  std::vector<std::uint32_t> groups = {1, 2};
  MeshNormalsOptions options{{ElementKind::kCorners}};
  options.elements.group_of_face = groups;
  Result<MeshNormals> made = MeshNormals::make(pair_of_triangles(), options);
  groups = {1, 1};
  ASSERT_TRUE(made.value().set_segment(view(kFrom), view(kTo)));
  expect_direction(normals_at(made.value(), 0.5), 1, face_normal(0, 0.5));
}

TEST(MeshNormals, the_next_segment_is_that_of_normals_made_anew) {
  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices, ElementKind::kCorners}) {
    Result<MeshNormals> reused = normals_of({{kind}}), in_slices = normals_of({{kind}});
    ASSERT_TRUE(reused.value().set_segment(view(kTo), view(kFrom)));
    const std::vector<float> before = normals_at(in_slices.value(), 0.25);
    ASSERT_TRUE(in_slices.value().begin_segment(view(kTo), view(kFrom)));
    while (!in_slices.value().prepare(0.3)) EXPECT_EQ(normals_at(in_slices.value(), 0.25), before);
    EXPECT_EQ(normals_at(in_slices.value(), 0.25), before) << "the present segment is shown until the next is finished";
    in_slices.value().finish_segment();
    Result<MeshNormals> fresh = MeshNormals::make(pair_of_triangles(), {{kind}});
    ASSERT_TRUE(fresh.value().set_segment(view(kTo), view(kFrom)));
    EXPECT_EQ(normals_at(reused.value(), 0.25), normals_at(fresh.value(), 0.25));
    EXPECT_EQ(normals_at(in_slices.value(), 0.25), normals_at(fresh.value(), 0.25));
  }
}

TEST(MeshNormals, a_fitted_weighting_states_its_bound) {
  MeshNormalsOptions options;
  options.weighting = Weighting::kAngle;
  Result<MeshNormals> normals = normals_of(options);
  EXPECT_GT(normals.value().fit_bound(), 0);
  const Vec3d left = unit(face_normal(0, 0)), right = unit(face_normal(1, 0));
  const auto angle = [](std::size_t at, std::size_t a, std::size_t b) {
    return angle_between(position(a, 0) - position(at, 0), position(b, 0) - position(at, 0));
  };
  const std::vector<float> shown = normals_at(normals.value(), 0);
  expect_direction(shown, 1, angle(1, 0, 2) * left + angle(4, 5, 3) * right);
  ASSERT_TRUE(normals.value().begin_segment(view(kFrom), view(kTo)));
  normals.value().finish_segment();
  EXPECT_EQ(normals_at(normals.value(), 0), shown);
}

// The first segment of the first object decides which vertices share a normal: there, vertices 4 and 5 coincide with
// vertices 1 and 2. In other segments, vertices that share a normal may be apart.
TEST(MeshNormals, another_object_knows_who_shares_a_normal_and_nothing_of_where_vertices_are) {
  std::vector<float> apart = kTo;
  apart[3 * 4] += 0.25F;
  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices, ElementKind::kCorners}) {
    const std::vector<std::uint32_t> groups = {1, 2};  // different smoothing groups make the edge hard
    MeshNormalsOptions options{.elements = {kind}};
    if (kind == ElementKind::kCorners) options.elements.group_of_face = groups;
    MeshNormals first = MeshNormals::make(pair_of_triangles(), options).value();
    MeshNormals early = first.another();
    ASSERT_TRUE(first.set_segment(view(kFrom), view(kTo)).ok());
    MeshNormals late = first.another();
    EXPECT_EQ(&late.topology(), &first.topology());
    EXPECT_EQ(late.element_count(), first.element_count());
    EXPECT_EQ(late.bytes(), 0U);
    std::vector<float> nothing(3 * late.size(), 7.0F);
    EXPECT_EQ(late.unit_normals(0.5, VectorView<float>::packed(nothing.data(), late.size())), late.size());
    ASSERT_TRUE(early.set_segment(view(kFrom), view(kTo)).ok());
    EXPECT_EQ(normals_at(early, 0.25), normals_at(first, 0.25));
    ASSERT_TRUE(late.set_segment(view(apart), view(kFrom)).ok());
    MeshNormals anew = MeshNormals::make(pair_of_triangles(), options).value();
    ASSERT_TRUE(anew.set_segment(view(kFrom), view(kTo)).ok());
    ASSERT_TRUE(anew.set_segment(view(apart), view(kFrom)).ok());
    EXPECT_EQ(normals_at(late, 0.75), normals_at(anew, 0.75));
    first = MeshNormals::make(pair_of_triangles()).value();  // the mesh lives as long as an object refers to it
    EXPECT_EQ(normals_at(late, 0.75), normals_at(anew, 0.75));
  }
}

TEST(MeshNormals, indices_of_16_bits_make_the_same_mesh) {
  const std::vector<std::uint16_t> corners(kCorners.begin(), kCorners.end());
  EXPECT_EQ(Topology::triangles(6, std::span(corners)).value(), pair_of_triangles());
  EXPECT_EQ(Topology::triangles(5, std::span(corners)).error().text(), Topology::triangles(5, kCorners).error().text());
}

TEST(MeshNormals, what_does_not_fit_is_refused_with_its_place) {
  std::vector<float> broken = kTo;
  broken[13] = std::numeric_limits<float>::infinity();
  const auto text_of = [](const Status& status) { return status ? std::string() : status.error().text(); };
  MeshNormals normals = normals_of({}).value();
  const std::vector<float> before = normals_at(normals, 0.5), few(15);
  EXPECT_EQ(text_of(normals.set_segment(view(kFrom), view(broken))),
            "keyframe 1, vertex 4: the position is NaN or infinite; positions must be finite numbers");
  EXPECT_EQ(text_of(normals.begin_segment(view(few), view(kTo))),
            "keyframe 0: the keyframe has 5 positions, but the mesh has 6 vertices; give one position for each vertex");
  EXPECT_EQ(normals_at(normals, 0.5), before);
  EXPECT_EQ(MeshNormals::make(Topology()).error().text(), "the mesh has no faces, so it has no normals; give it faces");
  EXPECT_EQ(MeshNormals::make(pair_of_triangles(), {{ElementKind::kFaces}, Weighting::kAngle}).error().code,
            ErrorCode::kUsage);
  MeshNormals creased = MeshNormals::make(pair_of_triangles(), {{ElementKind::kCorners, true, 181}}).value();
  EXPECT_EQ(creased.set_segment(view(kFrom), view(kTo)).error().code, ErrorCode::kUsage);

  const Topology other = Topology::triangles(6, {0, 1, 2}).value();
  EXPECT_EQ(normals.set_targets({other, kFrom, {}}).error().code, ErrorCode::kInvalidInput);
  MeshNormals weighted = MeshNormals::make(pair_of_triangles(), {.weighting = Weighting::kAngle}).value();
  EXPECT_EQ(weighted.set_targets({pair_of_triangles(), kFrom, {}}).error().code, ErrorCode::kUsage);
}

// ---- ranges of elements, threads, output formats --------------------------------------------------------------------

// Makes a mesh whose faces are in random order. At t = 1, some vertices are at the positions of other vertices, so some
// faces are thin, and some collapse.
Motion hard_mesh(Random& random, std::uint32_t cells) {
  Motion motion = fixtures::smooth_morph(cells);
  auto& from = motion.keyframes[0].positions;
  auto& to = motion.keyframes[1].positions;
  for (std::uint32_t i = 0; i < cells; ++i) {  // some faces collapse at t = 1
    const std::size_t a = random.below(from.size() / 3), b = random.below(from.size() / 3);
    std::copy_n(to.begin() + static_cast<std::ptrdiff_t>(3 * a), 3, to.begin() + static_cast<std::ptrdiff_t>(3 * b));
  }
  return test::with_faces_in_order(motion, test::shuffled_order(motion.topology.face_count(), random.below(1000)));
}

// Gives every corner its own vertex, as in a file with a seam at every edge.
Motion torn(const Motion& motion) {
  Motion result;
  std::vector<std::uint32_t> corners(motion.topology.corner_count());
  for (std::size_t c = 0; c < corners.size(); ++c) corners[c] = static_cast<std::uint32_t>(c);
  result.topology = Topology::triangles(corners.size(), corners).value();
  for (const Motion::Keyframe& keyframe : motion.keyframes) {
    std::vector<float> positions;
    for (const std::uint32_t v : motion.topology.corners())
      for (std::size_t k = 0; k < 3; ++k) positions.push_back(keyframe.positions[3 * v + k]);
    result.keyframes.push_back({positions, keyframe.time, ""});
  }
  result.connect_as_sequence();
  return result;
}

BlendSet shapes_of(const Motion& motion, Random& random) {
  BlendSet set{motion.topology, motion.keyframes[0].positions, {}};
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<float> deltas(set.base.size());
    const std::size_t band = deltas.size() / 5;
    for (std::size_t i = k * band; i < std::min(deltas.size(), (k + 2) * band); ++i)
      deltas[i] = motion.keyframes[1].positions[i] - set.base[i];
    set.targets.push_back(BlendTarget::from_dense(deltas));
  }
  (void)random;
  return set;
}

// Divides the range from 0 to `size` into parts of random sizes, and calls body(range) for each part.
template <class Body>
void for_pieces(std::size_t size, Random& random, const Body& body) {
  for (std::size_t first = 0; first < size;) {
    const std::size_t count = std::min<std::size_t>(size - first, 1 + random.below(random.below(8) == 0 ? 5000 : 90));
    body(IndexRange{first, count});
    first += count;
  }
}

TEST(MeshNormals, ranges_of_any_size_on_any_threads_have_the_bits_of_one_call) {
  constexpr std::uint64_t kSeed = 5301;
  std::cout << "seed " << kSeed << '\n';
  Random random(kSeed);
  for (int turn = 0; turn < 12; ++turn) {
    const Motion whole = hard_mesh(random, 10 + static_cast<std::uint32_t>(random.below(50)));
    const Motion motion = turn % 3 == 2 ? torn(whole) : whole;
    for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices, ElementKind::kCorners}) {
      for (const double tolerance : {kExactTolerance, kCompactTolerance}) {
        SCOPED_TRACE(std::string(element_kind_name(kind)) + ", turn " + std::to_string(turn));
        MeshNormals normals =
            MeshNormals::make(motion.topology, {.elements = {kind, true, 60}, .tolerance = tolerance}).value();
        ASSERT_TRUE(normals.set_segment(motion.segment(0)));
        ASSERT_TRUE(normals.set_targets(shapes_of(motion, random)));
        const double t = random.below(4) == 0 ? 1.0 : random.uniform(0, 1);
        const std::size_t n = normals.size();
        normals.set_weights(std::vector<double>{1, random.uniform(-1, 2), 0, random.below(2) == 0 ? 0.0 : 0.5});

        std::vector<float> all(3 * n), pieces(3 * n), blended(3 * n), blended_pieces(3 * n);
        std::vector<Octahedral> octahedral(n), octahedral_pieces(n);
        std::vector<Rgb10A2> rgb(n), rgb_pieces(n);
        std::vector<float> records(7 * n);  // records of 28 bytes, in which three floats are the normal
        const auto strided = VectorView<float>::strided(records.data(), n, 28);
        const std::size_t zeros = normals.unit_normals(t, VectorView<float>::packed(all));
        const std::size_t blended_zeros = normals.unit_normals(VectorView<float>::packed(blended));
        EXPECT_EQ(normals.unit_normals(t, std::span(octahedral)), zeros);
        EXPECT_EQ(normals.unit_normals(t, std::span(rgb)), zeros);

        // Eight threads compute the ranges. Each thread computes every eighth range.
        std::vector<IndexRange> ranges;
        for_pieces(n, random, [&](IndexRange range) { ranges.push_back(range); });
        std::atomic<std::size_t> zeros_of_pieces = 0, blended_of_pieces = 0;
        std::vector<std::thread> threads;
        for (std::size_t thread = 0; thread < 8; ++thread) {
          threads.emplace_back([&, thread] {
            for (std::size_t i = thread; i < ranges.size(); i += 8) {
              zeros_of_pieces += normals.unit_normals(t, VectorView<float>::packed(pieces), ranges[i]);
              blended_of_pieces += normals.unit_normals(VectorView<float>::packed(blended_pieces), ranges[i]);
              (void)normals.unit_normals(t, std::span(octahedral_pieces), ranges[i]);
              (void)normals.unit_normals(t, std::span(rgb_pieces), ranges[i]);
              (void)normals.unit_normals(t, strided, ranges[i]);
            }
          });
        }
        for (std::thread& thread : threads) thread.join();
        EXPECT_EQ(zeros_of_pieces, zeros);
        EXPECT_EQ(blended_of_pieces, blended_zeros);
        ASSERT_EQ(pieces, all);
        ASSERT_EQ(blended_pieces, blended);
        ASSERT_EQ(octahedral_pieces, octahedral);
        ASSERT_EQ(rgb_pieces, rgb);
        for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(strided[i], view(all)[i]) << i;
        std::size_t counted = 0;
        for (std::size_t i = 0; i < n; ++i) counted += view(all)[i] == Vec3f{} ? 1U : 0U;
        EXPECT_EQ(counted, zeros);

        // One call computes two times at once, and another call uses all threads. Both must give the same normals as a
        // call for t alone.
        std::vector<float> two(3 * n), other(3 * n);
        const double times[] = {0.5, t};
        const VectorView<float> views[] = {VectorView<float>::packed(other), VectorView<float>::packed(two)};
        (void)normals.unit_normals(times, views);
        EXPECT_EQ(two, all);
        EXPECT_EQ(normals.unit_normals(t, VectorView<float>::packed(two), Threads::kAll), zeros);
        EXPECT_EQ(two, all);
      }
    }
  }
}

TEST(MeshNormals, a_range_writes_itself_and_nothing_else) {
  const MeshNormals normals = [] {
    const Motion motion = fixtures::smooth_morph(20);
    MeshNormals made = MeshNormals::make(motion.topology).value();
    EXPECT_TRUE(made.set_segment(motion.segment(0)));
    return made;
  }();
  std::vector<float> result(3 * normals.size(), 7.0F);
  (void)normals.unit_normals(0.5, VectorView<float>::packed(result), {21, 40});
  for (std::size_t i = 0; i < normals.size(); ++i) EXPECT_EQ(result[3 * i] == 7.0F, i < 21 || i >= 61) << i;
  EXPECT_EQ(normals.unit_normals(0.5, VectorView<float>::packed(result), {normals.size(), 5}), 0U);
  EXPECT_EQ(normals.unit_normals(std::nan(""), VectorView<float>::packed(result), {3, 5}), 5U);
  EXPECT_EQ(result[9], 0.0F);
}

TEST(MeshNormals, evaluating_takes_nothing_from_the_heap) {
  if (!test::AllocationCounter::works()) GTEST_SKIP() << "operator new is a sanitizer's";
  Random random(5302);
  for (const bool is_torn : {false, true}) {
    const Motion whole = hard_mesh(random, 60), motion = is_torn ? torn(whole) : whole;
    for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices, ElementKind::kCorners}) {
      MeshNormals normals = MeshNormals::make(motion.topology, {{kind}}).value();
      ASSERT_TRUE(normals.set_segment(motion.segment(0)));
      ASSERT_TRUE(normals.set_targets(shapes_of(motion, random)));
      std::vector<float> result(3 * normals.size());
      std::vector<Octahedral> octahedral(normals.size());
      const auto view = VectorView<float>::packed(result);
      const double times[] = {0.25, 0.75};
      const VectorView<float> views[] = {view, view};
      const std::vector<double> one = {1, 0, 0, 0}, many = {0.5, 0.25, -1, 0.125};
      const test::AllocationCounter counter;
      for (const double t : {0.0, 0.3, 1.0}) {
        (void)normals.unit_normals(t, view);
        (void)normals.unit_normals(t, std::span(octahedral), {100, 333});
        (void)normals.unit_normals(times, views);
      }
      for (const std::vector<double>& weights : {std::cref(one), std::cref(many), std::cref(one)}) {
        normals.set_weights(weights);
        (void)normals.unit_normals(view);
        (void)normals.unit_normals(view, {100, 333});
        (void)normals.unit_normals(std::span(octahedral));
      }
      EXPECT_EQ(counter.allocations(), 0U) << element_kind_name(kind);
    }
  }
}

TEST(MeshNormals, blend_shapes_have_the_normals_of_their_positions) {
  MeshNormals normals = MeshNormals::make(pair_of_triangles()).value();
  std::vector<float> deltas(kTo.size());
  for (std::size_t i = 0; i < deltas.size(); ++i) deltas[i] = kTo[i] - kFrom[i];
  ASSERT_TRUE(normals.set_targets({pair_of_triangles(), kFrom, {BlendTarget::from_dense(deltas)}}));
  std::vector<float> shown(3 * normals.size());
  for (const double weight : {0.0, 0.3, 1.0}) {
    EXPECT_EQ(normals.unit_normals(std::span(&weight, 1), VectorView<float>::packed(shown)), 0U);
    expect_direction(shown, 0, face_normal(0, weight));
    expect_direction(shown, 1, face_normal(0, weight) + face_normal(1, weight));
    expect_direction(shown, 4, face_normal(0, weight) + face_normal(1, weight));
  }
}

TEST(MeshNormals, options_limit_the_memory_of_blend_shapes_and_allow_float32) {
  std::vector<float> deltas(kTo.size());
  for (std::size_t i = 0; i < deltas.size(); ++i) deltas[i] = kTo[i] - kFrom[i];
  const double weight = 0.3;
  std::vector<std::size_t> bytes;
  for (const MeshNormalsOptions& options : {MeshNormalsOptions{}, MeshNormalsOptions{.most_blend_bytes = 0},
                                            MeshNormalsOptions{.blends_in_float32 = true}}) {
    MeshNormals normals = MeshNormals::make(pair_of_triangles(), options).value();
    ASSERT_TRUE(normals.set_targets({pair_of_triangles(), kFrom, {BlendTarget::from_dense(deltas)}}));
    std::vector<float> shown(3 * normals.size());
    EXPECT_EQ(normals.unit_normals(std::span(&weight, 1), VectorView<float>::packed(shown)), 0U);
    expect_direction(shown, 1, face_normal(0, weight) + face_normal(1, weight));
    bytes.push_back(normals.bytes());
  }
  EXPECT_LT(bytes[1], bytes[0]) << "no terms";
  EXPECT_GT(bytes[2], bytes[0]) << "positions in float32 are kept as well";
}

// ---- records for vertex buffers -------------------------------------------------------------------------------------

std::int32_t signed_bits(std::uint32_t word, unsigned first, unsigned count) {
  return static_cast<std::int32_t>(word << (32 - first - count)) >> (32 - count);
}

// Decodes the record of one element's control normals as a shader does.
ControlNormals decoded(ControlFormat format, const std::byte* record) {
  std::array<double, 9> v{};
  if (format == ControlFormat::kFloat32) {
    std::array<float, 9> values{};
    std::memcpy(values.data(), record, sizeof values);
    std::copy(values.begin(), values.end(), v.begin());
  } else if (format == ControlFormat::kSnorm16) {
    std::array<std::int16_t, 9> values{};
    std::memcpy(values.data(), record, sizeof values);
    std::transform(values.begin(), values.end(), v.begin(), [](std::int16_t value) { return value / 32767.0; });
  } else {
    std::array<std::uint32_t, 3> words{};
    std::memcpy(words.data(), record, sizeof words);
    for (std::size_t k = 0; k < 3; ++k) {
      v[k] = signed_bits(words[k], 0, 11) / 1023.0;
      v[6 + k] = signed_bits(words[k], 11, 11) / 1023.0;
      v[3 + k] = signed_bits(words[k], 22, 10) / 511.0;
    }
  }
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
}

TEST(MeshNormals, vertex_buffers_hold_what_shaders_add_up) {
  const Motion motion = torn(fixtures::smooth_morph(12));
  MeshNormals normals = MeshNormals::make(motion.topology).value();
  ASSERT_TRUE(normals.set_segment(motion.segment(0)));
  std::vector<float> right(3 * normals.size());
  const std::pair<ControlFormat, double> formats[] = {
      {ControlFormat::kFloat32, 1e-6}, {ControlFormat::kSnorm16, 1e-4}, {ControlFormat::kSnorm11, 5e-3}};
  for (const auto& [format, most] : formats) {
    std::vector<std::byte> buffer(bytes_of(format) * normals.size());
    ASSERT_TRUE(normals.fill_vertex_buffer(format, buffer));
    for (const double t : {0.0, 0.4, 1.0}) {
      (void)normals.unit_normals(t, VectorView<float>::packed(right));
      for (std::size_t i = 0; i < normals.size(); ++i) {
        const Vec3d n = normal_at(decoded(format, buffer.data() + bytes_of(format) * i), t);
        ASSERT_LT(angle_between(n, to_double(view(right)[i])), most) << bytes_of(format) << " bytes, output " << i;
      }
    }
    buffer.pop_back();
    EXPECT_EQ(normals.fill_vertex_buffer(format, buffer).error().code, ErrorCode::kUsage);
  }
  MeshNormals compact = MeshNormals::make(motion.topology, {.tolerance = kCompactTolerance}).value();
  std::vector<std::byte> buffer(36 * compact.size());
  EXPECT_FALSE(compact.fill_vertex_buffer(ControlFormat::kFloat32, buffer));
  ASSERT_TRUE(compact.set_segment(motion.segment(0)));
  EXPECT_FALSE(compact.fill_vertex_buffer(ControlFormat::kFloat32, buffer));
}

}  // namespace
}  // namespace chronormal::mesh_normals_test
