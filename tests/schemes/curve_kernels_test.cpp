// Checks that the formulas of curves give the same bits on every instruction set and in every layout, also if the last
// vector of elements is not full. oracle_test.cpp compares the results with an independent oracle.

#include "schemes/kernels/curve_kernels.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "chronormal/schemes/scheme.h"
#include "core/memory.h"
#include "simd/targets.h"
#include "simd/trigonometry.h"
#include "tests/support/fixtures.h"

namespace chronormal::curve_kernels_test {
namespace {

// Schemes that together use all formulas of curves, and every formula that has sequential access (playback step by
// step).
const std::vector<std::string> kSchemes = {
    "linear",          "quadratic", "cubic",         "lagrange:4",       "lagrange:9",        "linear:scaled",
    "rational",        "slerp",     "decasteljau:2", "decasteljau:4",    "decasteljau:5",     "quaternion:matrix",
    "quaternion:edge", "circle",    "circle:timed",  "quaternion:polar", "quaternion:random", "quaternion:optimal"};

constexpr std::size_t kElements = 150;

// Faces of several kinds: some move much, some move little, some rest, and some turn over. Every tenth face has no area
// at any time.
struct Subject {
  Subject() : normals(kElements) {
    fixtures::Random random(5);
    std::vector<fixtures::Point> from, to;
    for (std::size_t face = 0; face < kElements; ++face) {
      const double far = std::array<double, 5>{1, 0.1, 1e-5, 0, 3}[face % 5];
      for (int corner = 0; corner < 3; ++corner) {
        fixtures::Point a = random.in_cube(1), b = random.in_cube(far);
        for (std::size_t k = 0; k < 3; ++k) b[k] += a[k];
        if (face % 7 == 3) {  // mirrored within its plane, so its normal becomes the opposite
          a[2] = 0;
          b = {-a[0], a[1], 0};
        }
        if (face % 10 == 9) a = b = {0, 0, 0};
        from.push_back(a);
        to.push_back(b);
      }
    }
    motion = fixtures::make_motion(fixtures::make_soup(kElements), from, to);
    face_control_normals(motion.segment(0), {0, kElements}, normals);
  }

  [[nodiscard]] std::unique_ptr<Scheme> prepared(const std::string& name, std::size_t count) const {
    auto scheme = make_scheme(name).value();
    const Segment segment = motion.segment(0);
    scheme->prepare({&segment, {0, count}, std::span(normals).first(count)});
    return scheme;
  }

  Motion motion;
  std::vector<ControlNormals> normals;
};

using Bits = std::vector<std::uint32_t>;

// Returns the bits of the components x, y, z of all vectors.
Bits bits_of(VectorView<const float> view) {
  Bits bits;
  for (std::size_t i = 0; i < view.count; ++i) {
    for (const float value : {view[i].x, view[i].y, view[i].z}) bits.push_back(std::bit_cast<std::uint32_t>(value));
  }
  return bits;
}

// Memory for `count` vectors in one of several layouts. The memory is filled with a value that must not change outside
// of the vectors.
class Layout {
 public:
  static constexpr int kCount = 5;

  Layout(int layout, std::size_t count) : values_(8 * count + 16, kUntouched) {
    float* p = values_.data() + 1;  // unaligned
    switch (layout) {
      case 0:
        view_ = VectorView<float>::packed(p, count);
        break;
      case 1:
        view_ = VectorView<float>::planes(p, p + count, p + 2 * count, count);
        break;
      case 2:  // vectors of four floats, as on a graphics card
        view_ = {p, p + 1, p + 2, count, 4};
        break;
      case 3:  // in reverse order
        view_ = {p + 2, p + 1, p, count, 3};
        break;
      default:
        view_ = {p + 5, p, p + 3, count, 7};
        break;
    }
  }

  [[nodiscard]] VectorView<float> view() const { return view_; }

  // Returns the number of floats in the memory that were overwritten.
  [[nodiscard]] std::size_t touched() const {
    std::size_t count = 0;
    for (const float value : values_) count += value != kUntouched ? 1 : 0;
    return count;
  }

 private:
  static constexpr float kUntouched = 1234567;
  std::vector<float> values_;
  VectorView<float> view_;
};

class CurveKernels : public testing::TestWithParam<std::string> {};

TEST_P(CurveKernels, give_the_same_bits_on_all_targets_in_all_layouts_at_all_remainders) {
  static const Subject subject;
  const auto times = {0.0, 0.3, 0.5, 1.0};
  std::vector<Bits> expected;
  {
    const ScopedTarget target(supported_targets().back());
    const auto scheme = subject.prepared(GetParam(), kElements);
    for (const double t : times) {
      const Layout result(0, kElements);
      EXPECT_EQ(scheme->evaluate(t, result.view()), kElements / 10);
      EXPECT_EQ(result.touched(), 3 * kElements);
      expected.push_back(bits_of(result.view()));
    }
  }
  for (const std::int64_t id : supported_targets()) {
    const ScopedTarget target(id);
    for (std::size_t count = 1; count <= 40; ++count) {
      const auto scheme = subject.prepared(GetParam(), count);
      for (int layout = 0; layout < Layout::kCount; ++layout) {
        auto bits = expected.begin();
        for (const double t : times) {
          const Layout result(layout, count);
          (void)scheme->evaluate(t, result.view());
          ASSERT_EQ(bits_of(result.view()), Bits(bits->begin(), bits->begin() + static_cast<std::ptrdiff_t>(3 * count)))
              << target_name(id) << ", layout " << layout << ", " << count << " elements, t = " << t;
          ASSERT_EQ(result.touched(), 3 * count) << target_name(id) << ", layout " << layout << ", " << count;
          ++bits;
        }
      }
    }
    const auto scheme = subject.prepared(GetParam(), kElements);
    for (int layout = 0; layout < Layout::kCount; ++layout) {
      const Layout result(layout, kElements);
      (void)scheme->evaluate(0.3, result.view());
      ASSERT_EQ(bits_of(result.view()), expected[1]) << target_name(id) << ", layout " << layout;
    }
  }
}

TEST_P(CurveKernels, play_the_same_bits_on_all_targets_in_all_layouts_at_all_remainders) {
  static const Subject subject;
  constexpr std::size_t kSteps = 20;
  const auto play = [](const Scheme& scheme) { return scheme.play(0.125, 0.04, 7); };
  std::vector<Bits> expected;
  {
    const ScopedTarget target(supported_targets().back());
    const auto scheme = subject.prepared(GetParam(), kElements);
    const auto playback = play(*scheme);
    ASSERT_EQ(playback != nullptr, scheme->sequential_operations().has_value());
    if (playback == nullptr) return;
    for (std::size_t step = 0; step < kSteps; ++step) {
      const Layout result(0, kElements);
      EXPECT_EQ(playback->next(result.view()), kElements / 10);
      expected.push_back(bits_of(result.view()));
    }
  }
  for (const std::int64_t id : supported_targets()) {
    const ScopedTarget target(id);
    for (std::size_t count = 1; count <= 40; ++count) {
      const auto scheme = subject.prepared(GetParam(), count);
      for (int layout = 0; layout < Layout::kCount; ++layout) {
        const auto playback = play(*scheme);
        for (const Bits& bits : expected) {
          const Layout result(layout, count);
          (void)playback->next(result.view());
          ASSERT_EQ(bits_of(result.view()), Bits(bits.begin(), bits.begin() + static_cast<std::ptrdiff_t>(3 * count)))
              << target_name(id) << ", layout " << layout << ", " << count << " elements";
          ASSERT_EQ(result.touched(), 3 * count);
        }
      }
    }
  }
}

TEST_P(CurveKernels, give_zero_to_an_element_without_direction_at_any_place_of_a_block) {
  static const Subject subject;
  for (const std::int64_t id : supported_targets()) {
    const ScopedTarget target(id);
    const auto scheme = subject.prepared(GetParam(), kElements);
    for (const double t : {0.0, 0.4, 1.0}) {
      const Layout result(0, kElements);
      (void)scheme->evaluate(t, result.view());
      for (std::size_t i = 0; i < kElements; ++i) {
        if (i % 10 == 9)
          ASSERT_EQ(result.view()[i], Vec3f{}) << target_name(id) << ", element " << i;
        else
          ASSERT_NEAR(length(to_double(result.view()[i])), 1, 2e-6) << target_name(id) << ", element " << i;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(all, CurveKernels, testing::ValuesIn(kSchemes), [](const auto& tested) {
  std::string label = tested.param;
  for (char& c : label) c = c == ':' ? '_' : c;
  return label;
});

// Random coefficients from a seed, computed without functions of a mathematics library, so they are the same
// everywhere.
struct Blocks {
  Blocks(std::size_t plane_count, std::size_t element_count)
      : values((element_count + kBlock - 1) / kBlock * kBlock * plane_count) {
    fixtures::Random random(plane_count);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(random.uniform(-1, 1));
    curves = {values.data(), plane_count, element_count};
  }

  AlignedArray<float> values;
  CoefficientBlocks curves;
};

struct Kernel {
  Formula formula;
  std::size_t plane_count, state_planes;
};

constexpr std::array kKernels = {
    Kernel{Formula::kSumOf2, 6, 6},     Kernel{Formula::kSumOf3, 9, 9},          Kernel{Formula::kSumOf4, 12, 12},
    Kernel{Formula::kSum, 18, 0},       Kernel{Formula::kRational, 14, 0},       Kernel{Formula::kGreatArc, 7, 4},
    Kernel{Formula::kCircleArc, 10, 4}, Kernel{Formula::kTimedCircleArc, 11, 0}, Kernel{Formula::kDeCasteljau, 12, 0},
};

constexpr SharedValues kShared = {0.3f, 0.25f, 0.125f, 0.375f, 0.4f, 0.5f, 0.0625f, 0.1f};

TEST(CurveFormulas, write_past_the_caches_what_they_write_into_them) {
  constexpr std::size_t kCount = 1000;
  for (const std::int64_t id : supported_targets()) {
    const ScopedTarget target(id);
    for (const Kernel& kernel : kKernels) {
      const Blocks blocks(kernel.plane_count, kCount);
      AlignedArray<float> cached(3 * kCount), streamed(3 * kCount + 1);
      const auto expected = VectorView<float>::packed(cached.data(), kCount);
      evaluate_curves(kernel.formula, blocks.curves, kShared, expected);
      for (const std::size_t offset : {0u, 1u}) {  // aligned and unaligned
        const auto result = VectorView<float>::packed(streamed.data() + offset, kCount);
        evaluate_curves(kernel.formula, blocks.curves, kShared, result, 0);
        ASSERT_EQ(bits_of(result), bits_of(expected)) << target_name(id) << ", offset " << offset;
      }
    }
  }
}

// Compares an FNV-1a hash of results with a constant: the results of all formulas, and of three steps of each formula
// with sequential access.
TEST(CurveFormulas, give_the_bits_that_every_compiler_and_instruction_set_has_given) {
  constexpr std::size_t kCount = 777;
  for (const std::int64_t id : supported_targets()) {
    const ScopedTarget target(id);
    std::uint64_t hash = 0xCBF29CE484222325u;
    const auto add = [&hash](VectorView<const float> view) {
      for (const std::uint32_t bits : bits_of(view)) hash = (hash ^ bits) * 0x100000001B3u;
    };
    std::vector<float> values(3 * kCount);
    const auto result = VectorView<float>::packed(values.data(), kCount);
    for (const Kernel& kernel : kKernels) {
      const Blocks blocks(kernel.plane_count, kCount);
      evaluate_curves(kernel.formula, blocks.curves, kShared, result);
      add(result);
      if (kernel.state_planes == 0) continue;
      Blocks state(kernel.state_planes, kCount);
      for (int step = 0; step < 3; ++step) {
        advance_curves(kernel.formula, blocks.curves, state.values.data(), result);
        add(result);
      }
    }
    EXPECT_EQ(hash, 0x7965271CD3D48D87u) << target_name(id);
  }
}

TEST(CurveFormulas, have_the_sine_and_cosine_of_core) {
  // The arc is u(t) = cos(t A) (1, 0, 0) + sin(t A) (0, 1, 0), so its components are the cosine and the sine of t A.
  constexpr std::size_t kCount = 1 << 14;
  AlignedArray<float> planes(7 * kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    float* c = planes.data() + i / kBlock * kBlock * 7 + i % kBlock;
    for (std::size_t k = 0; k < 6; ++k) c[k * kBlock] = k == 0 || k == 4 ? 1.0f : 0.0f;
    c[6 * kBlock] = 8 * static_cast<float>(i) / kCount;
  }
  const SharedValues one = {1};
  std::vector<float> values(3 * kCount);
  const auto result = VectorView<float>::packed(values.data(), kCount);
  for (const std::int64_t id : supported_targets()) {
    const ScopedTarget target(id);
    evaluate_curves(Formula::kGreatArc, {planes.data(), 7, kCount}, one, result);
    for (std::size_t i = 0; i < kCount; ++i) {
      const auto [sine, cosine] = sin_cos(8 * static_cast<float>(i) / kCount);
      ASSERT_EQ(result[i], (Vec3f{cosine, sine, 0})) << target_name(id) << ", element " << i;
    }
  }
}

TEST(CurveFormulas, slerp_turns_between_opposite_vectors_and_stays_between_equal_ones_whatever_lies_beside_them) {
  constexpr std::size_t kCount = 96;
  const struct {
    Vec3f start, end;
    double tolerance;
  } pairs[] = {
      {{1, 0, 0}, {-1, 0, 0}, 1e-6},     {{0, 0.6f, 0.8f}, {0, -0.6f, -0.8f}, 1e-6},
      {{0, 1, 0}, {0, 1, 0}, 1e-6},      {{0, 1, 0}, {2e-5f, 1, 0}, 1e-6},
      {{0, 0, 1}, {5e-5f, 0, -1}, 1e-4},  // an error of 1e-7, divided by a sine of 5e-5
      {{0, 0, 1}, {0, 1, 0}, 1e-6},      {{}, {}, 0},
  };
  AlignedArray<float> planes(6 * kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    float* c = planes.data() + i / kBlock * kBlock * 6 + i % kBlock;
    for (const Vec3f& v : {pairs[i % std::size(pairs)].start, pairs[i % std::size(pairs)].end}) {
      for (const float value : {v.x, v.y, v.z}) {
        *c = value;
        c += kBlock;
      }
    }
  }
  std::vector<float> values(3 * kCount);
  const auto result = VectorView<float>::packed(values.data(), kCount);
  for (const std::int64_t id : supported_targets()) {
    const ScopedTarget target(id);
    for (const float t : {0.25f, 0.5f, 0.75f}) {
      evaluate_curves(Formula::kDeCasteljau, {planes.data(), 6, kCount}, {t}, result);
      for (std::size_t i = 0; i < kCount; ++i) {
        const auto& [start, end, tolerance] = pairs[i % std::size(pairs)];
        const Vec3d u = to_double(result[i]), from = to_double(start), to = to_double(end);
        if (start == Vec3f{}) {
          ASSERT_EQ(u, Vec3d{});
          continue;
        }
        const double angle = angle_between(from, to);
        ASSERT_NEAR(length(u), 1, 1e-6) << target_name(id) << ", element " << i;
        ASSERT_NEAR(angle_between(from, u), static_cast<double>(t) * angle, tolerance) << target_name(id) << ", " << i;
        ASSERT_NEAR(angle_between(u, to), (1 - static_cast<double>(t)) * angle, tolerance)
            << target_name(id) << ", " << i;
      }
    }
  }
}

TEST(CurveFormulas, take_no_elements_at_all) {
  for (const Kernel& kernel : kKernels)
    evaluate_curves(kernel.formula, {nullptr, kernel.plane_count, 0}, kShared, VectorView<float>{});
}

}  // namespace
}  // namespace chronormal::curve_kernels_test
