// Checks that curves give the same bits in every output format, for one t or many at once, and on any number of
// threads.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "motion/coherence.h"
#include "normals/curves/kernels/evaluate.h"
#include "simd/targets.h"
#include "tests/support/child_process.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_normals.h"
#include "tests/support/integer_mesh.h"

namespace chronormal::outputs_test {
namespace {

constexpr std::array<double, 4> kTolerances{1e-6, 1e-3, 5e-3, 2e-2};

// Makes elements of all kinds and degrees, including flagged elements and zeros. Some runs of similar elements are
// longer than a block.
std::vector<ControlNormals> mixed_elements(std::size_t count, std::uint64_t seed) {
  fixtures::Random random(seed);
  std::vector<ControlNormals> normals;
  while (normals.size() < count) {
    const auto& families = test::hard_families();
    const auto& family = families[random.below(families.size())];
    const bool nothing = random.below(30) == 0;
    const std::size_t run = random.below(2) == 0 ? 1 : random.below(100);
    for (std::size_t i = 0; i < run && normals.size() < count; ++i)
      normals.push_back(nothing ? ControlNormals{} : family.make(random));
  }
  return normals;
}

// Memory for results, between words that must not change. The memory begins at any distance from an aligned address.
template <class T>
class Guarded {
 public:
  Guarded(std::size_t count, std::size_t offset) : words_(count + 2 * kGuard + 16), count_(count) {
    const auto address = reinterpret_cast<std::uintptr_t>(words_.data() + kGuard);
    begin_ = kGuard + (64 - address % 64) % 64 / 4 + offset;
    for (auto& word : words_) word = std::bit_cast<T>(kMark);
  }
  [[nodiscard]] T* data() { return words_.data() + begin_; }
  [[nodiscard]] std::span<T> span() { return {data(), count_}; }
  // Returns true if the words around the results are unchanged, and among the results only words have changed that
  // `may_be_written` allows.
  [[nodiscard]] bool is_intact(const std::function<bool(std::size_t)>& may_be_written = nullptr) const {
    for (std::size_t i = 0; i < words_.size(); ++i) {
      const bool inside = i >= begin_ && i < begin_ + count_ && (!may_be_written || may_be_written(i - begin_));
      if (!inside && std::bit_cast<std::uint32_t>(words_[i]) != kMark) return false;
    }
    return true;
  }

 private:
  static constexpr std::size_t kGuard = 64;
  static constexpr std::uint32_t kMark = 0xDEADBEEF;
  static_assert(sizeof(T) == 4);
  std::vector<T> words_;
  std::size_t count_, begin_ = 0;
};

bool same_bits(const Vec3f& a, const Vec3f& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// The expected results: three floats per element, at an aligned address.
struct Reference {
  std::vector<Vec3f> normals;
  std::size_t without_direction = 0;
};

Reference reference(const NormalCurves& curves, double t) {
  Guarded<float> packed(3 * curves.size(), 0);
  const auto view = VectorView<float>::packed(packed.data(), curves.size());
  Reference result;
  result.without_direction = curves.unit_normals(t, view);
  EXPECT_TRUE(packed.is_intact());
  for (std::size_t i = 0; i < curves.size(); ++i) result.normals.push_back(view[i]);
  return result;
}

void expect_all_forms_agree(const NormalCurves& curves, double t) {
  const std::size_t n = curves.size();
  const Reference expected = reference(curves, t);
  const auto expect_same = [&](const VectorView<float>& view, std::size_t count, const char* form) {
    EXPECT_EQ(count, expected.without_direction) << form;
    for (std::size_t i = 0; i < n; ++i) ASSERT_TRUE(same_bits(view[i], expected.normals[i])) << form << " " << i;
  };
  for (const std::size_t offset : {1u, 2u, 7u}) {
    Guarded<float> packed(3 * n, offset);
    const auto view = VectorView<float>::packed(packed.data(), n);
    expect_same(view, curves.unit_normals(t, view), "packed, not aligned");
    EXPECT_TRUE(packed.is_intact());
  }
  for (const std::size_t offset : {0u, 1u}) {
    Guarded<float> x(n, offset), y(n, 2 * offset), z(n, 3 * offset);
    const auto view = VectorView<float>::planes(x.data(), y.data(), z.data(), n);
    expect_same(view, curves.unit_normals(t, view), "planes");
    EXPECT_TRUE(x.is_intact() && y.is_intact() && z.is_intact());
  }
  {
    Guarded<float> four(4 * n, 1);
    const VectorView<float> view{four.data(), four.data() + 1, four.data() + 2, n, 4};
    expect_same(view, curves.unit_normals(t, view), "stride 4");
    EXPECT_TRUE(four.is_intact([](std::size_t i) { return i % 4 != 3; }));
  }
  {
    Guarded<float> seven(7 * n, 0);  // seven words per element: z, a gap, y, a gap, x, two gaps
    const VectorView<float> view{seven.data() + 4, seven.data() + 2, seven.data(), n, 7};
    expect_same(view, curves.unit_normals(t, view), "stride 7, backwards");
    EXPECT_TRUE(seven.is_intact([](std::size_t i) { return i % 7 == 0 || i % 7 == 2 || i % 7 == 4; }));
  }
  {
    Guarded<float> three(3 * n, 0);  // three words per element, with z first
    const VectorView<float> view{three.data() + 2, three.data() + 1, three.data(), n, 3};
    expect_same(view, curves.unit_normals(t, view), "stride 3, backwards");
    EXPECT_TRUE(three.is_intact());
  }
  std::vector<Octahedral> octahedral;
  for (const std::size_t offset : {0u, 1u, 5u}) {
    Guarded<Octahedral> words(n, offset);
    EXPECT_EQ(curves.unit_normals(t, words.span()), expected.without_direction);
    EXPECT_TRUE(words.is_intact());
    if (offset == 0) octahedral.assign(words.span().begin(), words.span().end());
    EXPECT_TRUE(std::equal(octahedral.begin(), octahedral.end(), words.span().begin()));
  }
  Guarded<Rgb10A2> rgb(n, 3);
  EXPECT_EQ(curves.unit_normals(t, rgb.span()), expected.without_direction);
  EXPECT_TRUE(rgb.is_intact());
  for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(rgb.span()[i], encode_rgb10a2(expected.normals[i]));
  for (std::size_t i = 0; i < n; ++i) {
    if (same_bits(expected.normals[i], {})) continue;
    EXPECT_LE(angle_between(to_double(decode(octahedral[i])), to_double(expected.normals[i])), 7e-5) << i;
  }
}

TEST(Outputs, of_every_form_and_size_are_the_same_bits_and_touch_nothing_else) {
  const auto elements = mixed_elements(4000, 92);
  for (const std::int64_t target : supported_targets()) {
    const ScopedTarget scoped(target);
    SCOPED_TRACE(target_name(target));
    for (std::size_t size = 0; size <= 70; ++size) {
      const auto some = std::span(elements).subspan(40 * size, size);
      for (const double tolerance : kTolerances)
        expect_all_forms_agree(NormalCurves(some, {tolerance}), size % 3 == 0 ? 0 : 0.37);
    }
    // The number of elements exceeds the number that the library keeps on the stack at a time.
    for (const double tolerance : kTolerances) expect_all_forms_agree(NormalCurves(elements, {tolerance}), 0.71);
  }
}

// ---- many times t in one call ---------------------------------------------------------------------------------------

void expect_many_times_equal_one(const NormalCurves& curves, const std::vector<double>& times, Threads threads) {
  const std::size_t n = curves.size(), count = times.size();
  std::vector<Guarded<float>> packed, planes;
  std::vector<Guarded<Octahedral>> octahedral;
  std::vector<VectorView<float>> packed_views, plane_views;
  std::vector<std::span<Octahedral>> spans;
  for (std::size_t k = 0; k < count; ++k) {
    packed.emplace_back(3 * n, k % 3);
    planes.emplace_back(3 * n, k % 3);
    octahedral.emplace_back(n, k % 3);
  }
  for (std::size_t k = 0; k < count; ++k) {
    packed_views.push_back(VectorView<float>::packed(packed[k].data(), n));
    float* const x = planes[k].data();
    plane_views.push_back(VectorView<float>::planes(x, x + n, x + 2 * n, n));
    spans.push_back(octahedral[k].span());
  }
  const std::size_t of_packed = curves.unit_normals(times, packed_views, threads);
  const std::size_t of_planes = curves.unit_normals(times, plane_views, threads);
  const std::size_t of_octahedral = curves.unit_normals(times, spans, threads);
  std::size_t without_direction = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Reference expected = reference(curves, times[k]);
    without_direction += expected.without_direction;
    std::vector<Octahedral> words(n);
    (void)curves.unit_normals(times[k], words);
    EXPECT_TRUE(packed[k].is_intact() && planes[k].is_intact() && octahedral[k].is_intact());
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_TRUE(same_bits(packed_views[k][i], expected.normals[i])) << "time " << k << ", element " << i;
      ASSERT_TRUE(same_bits(plane_views[k][i], expected.normals[i])) << "time " << k << ", element " << i;
      ASSERT_EQ(spans[k][i], words[i]) << "time " << k << ", element " << i;
    }
  }
  EXPECT_EQ(of_packed, without_direction);
  EXPECT_EQ(of_planes, without_direction);
  EXPECT_EQ(of_octahedral, without_direction);
}

TEST(ManyTimes, give_what_each_gives_alone) {
  const auto elements = mixed_elements(2000, 93);
  const std::vector<double> times{0, 1, 0.5, 0.5, 0.1, 1e-6, 0.9999, 0};
  for (const double tolerance : kTolerances) {
    for (const std::size_t size : {0u, 1u, 15u, 16u, 17u, 511u, 512u, 513u, 1030u, 2000u}) {
      const NormalCurves curves{std::span(elements).first(size), {tolerance}};
      for (const std::size_t count : {0u, 1u, 2u, 8u})
        expect_many_times_equal_one(curves, {times.begin(), times.begin() + static_cast<std::ptrdiff_t>(count)},
                                    Threads::kOne);
    }
  }
}

TEST(ManyTimes, may_mix_forms) {
  const auto elements = mixed_elements(333, 94);
  const NormalCurves curves(elements, {1e-3});
  std::vector<float> packed(999), planes(999), strided(4 * 333);
  const std::vector<double> times{0.2, 0.4, 0.6};
  const std::vector<VectorView<float>> views{
      VectorView<float>::packed(packed.data(), 333),
      VectorView<float>::planes(planes.data(), planes.data() + 333, planes.data() + 666, 333),
      {strided.data(), strided.data() + 1, strided.data() + 2, 333, 4}};
  (void)curves.unit_normals(times, views);
  for (std::size_t k = 0; k < 3; ++k) {
    const Reference expected = reference(curves, times[k]);
    for (std::size_t i = 0; i < 333; ++i) ASSERT_TRUE(same_bits(views[k][i], expected.normals[i])) << k << " " << i;
  }
}

// ---- any number of threads ------------------------------------------------------------------------------------------

TEST(ThreadsOfCurves, give_the_bits_of_one) {
  const auto elements = mixed_elements(100003, 95);
  for (const double tolerance : {1e-6, 1e-3}) {
    const NormalCurves curves(elements, {tolerance});
    for (const double t : {0.0, 0.3}) {
      const Reference expected = reference(curves, t);
      std::vector<Octahedral> one(curves.size());
      (void)curves.unit_normals(t, one);
      for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
        const ThreadLimit limit(threads);
        Guarded<float> packed(3 * curves.size(), 0), planes(3 * curves.size(), 0);
        const auto view = VectorView<float>::packed(packed.data(), curves.size());
        EXPECT_EQ(curves.unit_normals(t, view, Threads::kAll), expected.without_direction);
        float* const x = planes.data();
        const auto plane_view = VectorView<float>::planes(x, x + curves.size(), x + 2 * curves.size(), curves.size());
        EXPECT_EQ(curves.unit_normals(t, plane_view, Threads::kAll), expected.without_direction);
        std::vector<Octahedral> all(curves.size());
        EXPECT_EQ(curves.unit_normals(t, all, Threads::kAll), expected.without_direction);
        EXPECT_TRUE(packed.is_intact() && planes.is_intact());
        EXPECT_EQ(all, one);
        for (std::size_t i = 0; i < curves.size(); ++i) {
          ASSERT_TRUE(same_bits(view[i], expected.normals[i])) << i;
          ASSERT_TRUE(same_bits(plane_view[i], expected.normals[i])) << i;
        }
      }
    }
    const ThreadLimit limit(3);
    expect_many_times_equal_one(curves, {0.1, 0.5, 1}, Threads::kAll);
  }
}

// Selects whether a test compares the lengths of normals, too. The lengths of normals of collapsing elements are more
// precise in curves from positions than in curves from control normals, so these lengths may differ in the last bit.
enum class Say { kEverything, kNoLengths };

std::vector<std::uint32_t> everything(const NormalCurves& curves, Say say = Say::kEverything) {
  std::vector<std::uint32_t> words;
  const auto add = [&words](std::size_t v) { words.push_back(static_cast<std::uint32_t>(v)); };
  add(curves.size());
  add(curves.flagged_count());
  for (const std::size_t count : curves.degree_counts()) add(count);
  for (const auto& count : curves.byte_counts()) {
    add(count.bytes);
    add(count.elements);
  }
  std::vector<float> xyz(3 * curves.size());
  for (const double t : {0.0, 0.3, 1.0}) {
    const auto view = VectorView<float>::packed(xyz.data(), curves.size());
    add(curves.unit_normals(t, view));
    for (const float v : xyz) words.push_back(std::bit_cast<std::uint32_t>(v));
    if (!curves.keeps_lengths() || say == Say::kNoLengths) continue;
    curves.normals(t, view);
    for (const float v : xyz) words.push_back(std::bit_cast<std::uint32_t>(v));
  }
  return words;
}

TEST(ThreadsOfCurves, prepare_the_same_curves) {
  const Motion motion = test::integer_grid(260);  // 135,200 faces, prepared in sixteen parts
  const Segment segment = motion.segment(0);
  std::vector<ControlNormals> normals(motion.topology.face_count());
  face_control_normals(segment, {0, normals.size()}, normals);
  const NormalGroups groups =
      NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
  for (const double tolerance : {1e-6, 1e-3, 5e-3}) {
    const CurveOptions options{tolerance};
    const auto faces = everything(NormalCurves::of_faces(segment, options));
    const auto vertices = everything(NormalCurves::of_groups(segment, groups, options));
    // Compact curves from positions are prepared in float32 if float32 is accurate enough, but control normals are
    // always in double. Only exact curves must therefore be equal.
    if (tolerance <= kExactTolerance) {
      EXPECT_EQ(everything(NormalCurves::of_faces(segment, options), Say::kNoLengths),
                everything(NormalCurves(normals, options), Say::kNoLengths))
          << "by way of control normals";
    }
    for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
      const ThreadLimit limit(threads);
      EXPECT_EQ(faces, everything(NormalCurves::of_faces(segment, options, Threads::kAll))) << threads;
      EXPECT_EQ(vertices, everything(NormalCurves::of_groups(segment, groups, options, Threads::kAll))) << threads;
    }
  }
}

// If the neighbours of a vertex are far apart in memory, the library first copies their positions at both ends of the
// segment into one place.
TEST(ScatteredMesh, has_the_curves_of_its_control_normals) {
  const Motion motion = test::shuffled_grid(220);
  const Segment segment = motion.segment(0);
  ASSERT_GT(lines_per_face(motion.topology), 2);
  const NormalGroups groups =
      NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
  for (const double tolerance : {1e-6, 1e-3}) {
    for (const Threads threads : {Threads::kOne, Threads::kAll}) {
      EXPECT_EQ(everything(NormalCurves::of_faces(segment, {tolerance}, threads), Say::kNoLengths),
                everything(NormalCurves(all_face_control_normals(segment), {tolerance}), Say::kNoLengths));
      EXPECT_EQ(everything(NormalCurves::of_groups(segment, groups, {tolerance}, threads), Say::kNoLengths),
                everything(NormalCurves(all_group_control_normals(segment, groups), {tolerance}), Say::kNoLengths));
    }
  }
}

TEST(ReusedCurves, are_those_that_were_never_used) {
  const Motion large = test::integer_grid(260, 96), small = test::integer_grid(40, 97), other = test::integer_grid(259);
  for (const Threads threads : {Threads::kOne, Threads::kAll}) {
    NormalCurves curves;
    for (const double tolerance : {1e-3, 1e-6}) {
      for (const Motion* const motion : {&small, &large, &other, &small, &large}) {
        const Segment segment = motion->segment(0);
        curves = NormalCurves::of_faces(segment, {tolerance}, threads, &curves);
        ASSERT_EQ(everything(curves), everything(NormalCurves::of_faces(segment, {tolerance})));
      }
    }
    NormalCurves next = NormalCurves::of_faces(small.segment(0), {}, threads, &curves);
    EXPECT_EQ(curves.size(), 0u);
    EXPECT_EQ(curves.unit_normals(0.5, VectorView<float>{}), 0u);
    NormalCurves used = NormalCurves::of_faces(large.segment(0));
    EXPECT_EQ(NormalCurves::of_groups(large.segment(0), NormalGroups{}, {}, threads, &used).bytes(), 0u);
    const NormalCurves moved = std::move(next);
    EXPECT_EQ(everything(moved), everything(NormalCurves::of_faces(small.segment(0))));
  }
}

TEST(ReusedCurves, take_scratch_of_any_size_from_the_ones_before) {
  const Motion small = test::shuffled_grid(30), large = test::shuffled_grid(60), in_order = test::integer_grid(50);
  const auto vertices_of = [](const Motion& motion) {
    return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
  };
  for (const Threads threads : {Threads::kOne, Threads::kAll}) {
    NormalCurves curves;
    for (const Motion* const motion : {&small, &large, &small, &in_order, &large}) {
      const Segment segment = motion->segment(0);
      const NormalGroups groups = vertices_of(*motion);
      curves = NormalCurves::of_groups(segment, groups, {}, threads, &curves);
      ASSERT_EQ(everything(curves), everything(NormalCurves(all_group_control_normals(segment, groups), {})));
    }
  }
  EXPECT_GT(lines_per_face(small.topology), 1);
  EXPECT_GT(lines_per_face(large.topology), 1);
}

// ---- results that streaming stores write past the caches ------------------------------------------------------------

// Makes a topology with `faces` faces, by repeating the faces of a grid.
Topology repeated_grid(const Topology& grid, std::size_t faces) {
  const auto corners = grid.corners();
  std::vector<std::uint32_t> repeated;
  repeated.reserve(3 * faces);
  while (repeated.size() < 3 * faces) {
    const std::size_t count = std::min(corners.size(), 3 * faces - repeated.size());
    repeated.insert(repeated.end(), corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return fixtures::make_triangles(grid.vertex_count(), std::move(repeated));
}

// Evaluates into aligned memory, where the library may use streaming stores, with one thread and with all threads.
// Compares the results with those in memory that begins one word later, where the library never uses streaming stores.
template <class T, class Evaluate>
void expect_streamed_as_stored(std::size_t words, const Evaluate& evaluate) {
  Guarded<T> streamed(words, 0), stored(words, 1);
  const std::size_t count = evaluate(stored.data(), Threads::kOne);
  for (const Threads threads : {Threads::kOne, Threads::kAll}) {
    EXPECT_EQ(evaluate(streamed.data(), threads), count);
    EXPECT_EQ(std::memcmp(streamed.data(), stored.data(), sizeof(T) * words), 0);
    EXPECT_TRUE(streamed.is_intact() && stored.is_intact());
    std::fill_n(streamed.data(), words, T{});
  }
}

TEST(StreamedResults, at_one_t_have_the_bits_of_stored_ones) {
  for (const WorkingSet set : {WorkingSet::kSharedCache, WorkingSet::kMemory}) {
    const std::size_t faces = set == WorkingSet::kSharedCache ? 1'000'037 : 1'700'037;
    SCOPED_TRACE(faces);
    Motion motion = test::integer_grid(50);
    motion.topology = repeated_grid(motion.topology, faces);
    const NormalCurves curves = NormalCurves::of_faces(motion.segment(0), {}, Threads::kAll);
    ASSERT_EQ(curves.size(), faces);
    std::size_t blocks = 0;
    for (const auto& [bytes, elements] : curves.byte_counts()) blocks += bytes * elements;
    EXPECT_EQ(access_of_pass(blocks, 12 * faces).working_set, set) << blocks;
    EXPECT_TRUE(access_of_pass(blocks, 12 * faces).stream) << blocks;
    EXPECT_EQ(access_of_pass(blocks, 4 * faces).working_set, set) << blocks;
    EXPECT_TRUE(access_of_pass(blocks, 4 * faces).stream) << blocks;

    expect_streamed_as_stored<float>(3 * faces, [&](float* xyz, Threads threads) {
      return curves.unit_normals(0.3, VectorView<float>::packed(xyz, faces), threads);
    });
    const std::size_t plane = (faces + 15) / 16 * 16;
    expect_streamed_as_stored<float>(3 * plane, [&](float* x, Threads threads) {
      for (std::size_t k = 0; k < 3; ++k) std::fill(x + k * plane + faces, x + (k + 1) * plane, 0.0F);
      return curves.unit_normals(0.3, VectorView<float>::planes(x, x + plane, x + 2 * plane, faces), threads);
    });
    // The third plane, z, begins one word early, so it is not aligned to 64 bytes.
    expect_streamed_as_stored<float>(3 * plane, [&](float* x, Threads threads) {
      std::fill(x + faces, x + plane, 0.0F);
      std::fill(x + plane + faces, x + 2 * plane - 1, 0.0F);
      std::fill(x + 2 * plane - 1 + faces, x + 3 * plane, 0.0F);
      return curves.unit_normals(0.3, VectorView<float>::planes(x, x + plane, x + 2 * plane - 1, faces), threads);
    });
    const VectorView<float> wide{nullptr, nullptr, nullptr, faces, 4};
    // The fourth word of each element must not be written.
    expect_streamed_as_stored<float>(4 * faces, [&](float* x, Threads threads) {
      for (std::size_t i = 0; i < faces; ++i) x[4 * i + 3] = 0;
      VectorView<float> view = wide;
      view.x = x, view.y = x + 1, view.z = x + 2;
      return curves.unit_normals(0.3, view, threads);
    });
    expect_streamed_as_stored<Octahedral>(faces, [&](Octahedral* words, Threads threads) {
      return curves.unit_normals(0.3, std::span(words, faces), threads);
    });
    expect_streamed_as_stored<Rgb10A2>(faces, [&](Rgb10A2* words, Threads threads) {
      return curves.unit_normals(0.3, std::span(words, faces), threads);
    });
  }
}

TEST(StreamedResults, at_many_t_have_the_bits_of_stored_ones) {
  const auto elements = mixed_elements(70007, 98);
  constexpr std::size_t kManyVectors = 36, kManyOctahedral = 100;
  EXPECT_TRUE(access_of_pass(0, kManyVectors * 12 * elements.size()).stream);
  EXPECT_TRUE(access_of_pass(0, kManyOctahedral * 4 * elements.size()).stream);
  const std::size_t plane = (elements.size() + 15) / 16 * 16;
  for (const std::int64_t target : supported_targets()) {
    if (test::is_sanitized() && target != current_target()) continue;
    const ScopedTarget scoped(target);
    SCOPED_TRACE(target_name(target));
    for (const double tolerance : {1e-6, 5e-3}) {
      const NormalCurves curves(elements, {tolerance});
      // All times write their results to the same memory, so the results for the last t remain.
      Guarded<float> packed(3 * elements.size(), 0), planes(3 * plane, 0);
      Guarded<Octahedral> words(elements.size(), 0);
      const auto times = [](std::size_t count) {
        std::vector<double> result(count, 0.25);
        result.back() = 0.75;
        return result;
      };
      const auto packed_view = VectorView<float>::packed(packed.data(), elements.size());
      const auto planes_view =
          VectorView<float>::planes(planes.data(), planes.data() + plane, planes.data() + 2 * plane, elements.size());
      const std::vector<std::span<Octahedral>> spans(kManyOctahedral, words.span());
      (void)curves.unit_normals(times(kManyVectors), std::vector(kManyVectors, packed_view));
      (void)curves.unit_normals(times(kManyVectors), std::vector(kManyVectors, planes_view));
      (void)curves.unit_normals(times(kManyOctahedral), spans);
      EXPECT_TRUE(packed.is_intact() && planes.is_intact() && words.is_intact());
      const Reference expected = reference(curves, 0.75);
      for (std::size_t i = 0; i < elements.size(); ++i) {
        ASSERT_TRUE(same_bits(packed_view[i], expected.normals[i])) << i;
        ASSERT_TRUE(same_bits(planes_view[i], expected.normals[i])) << i;
      }
      std::vector<Octahedral> stored(elements.size());
      (void)curves.unit_normals(0.75, stored);
      EXPECT_TRUE(std::equal(stored.begin(), stored.end(), words.span().begin()));
    }
  }
}

}  // namespace
}  // namespace chronormal::outputs_test
