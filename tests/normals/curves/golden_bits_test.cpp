// Compares a hash of all results with a constant. The hash must be the same for every instruction set, every number of
// threads and every compiler.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <ios>
#include <span>
#include <vector>

#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "core/bits.h"
#include "normals/recompute/recompute.h"
#include "simd/targets.h"
#include "tests/support/integer_mesh.h"

namespace chronormal::golden_bits_test {
namespace {

// A hash of 32-bit words by FNV-1a. The order of the bytes of a word in memory does not matter.
class Hash {
 public:
  void add(std::uint32_t word) { value_ = (value_ ^ word) * 0x100000001B3u; }
  void add(float v) { add(bit_cast<std::uint32_t>(v)); }
  void add(double v) {
    const auto bits = bit_cast<std::uint64_t>(v);
    add(static_cast<std::uint32_t>(bits));
    add(static_cast<std::uint32_t>(bits >> 32));
  }
  void add(std::size_t v) { add(static_cast<std::uint32_t>(v)); }
  void add(const Vec3d& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325u;
};

struct Results {
  std::vector<float> xyz, three;
  std::vector<Octahedral> octahedral;
  std::vector<Rgb10A2> rgb;
};

void add_curves(Hash& hash, const NormalCurves& curves, Results& results) {
  const std::size_t n = curves.size();
  results.xyz.resize(3 * n);
  results.octahedral.resize(n);
  results.rgb.resize(n);
  hash.add(n);
  hash.add(curves.flagged_count());
  for (const std::size_t count : curves.degree_counts()) hash.add(count);
  for (const auto& count : curves.byte_counts()) {
    hash.add(count.bytes);
    hash.add(count.elements);
  }
  float* const x = results.xyz.data();
  const auto packed = VectorView<float>::packed(x, n), planes = VectorView<float>::planes(x, x + n, x + 2 * n, n);
  hash.add(curves.unit_normals(0.34375, packed, Threads::kAll));
  for (const float v : results.xyz) hash.add(v);
  hash.add(curves.unit_normals(1, planes, Threads::kAll));
  for (const float v : results.xyz) hash.add(v);
  hash.add(curves.unit_normals(0, results.octahedral, Threads::kAll));
  for (const Octahedral v : results.octahedral) hash.add(v.bits);
  hash.add(curves.unit_normals(0.8125, results.rgb, Threads::kAll));
  for (const Rgb10A2 v : results.rgb) hash.add(v.bits);
  if (curves.keeps_lengths()) {
    curves.normals(0.34375, packed);
    for (const float v : results.xyz) hash.add(v);
  }
  results.three.resize(9 * n);
  const double times[] = {0.125, 0.5, 0.9375};
  VectorView<float> three[3];
  for (std::size_t k = 0; k < 3; ++k) three[k] = VectorView<float>::packed(results.three.data() + 3 * n * k, n);
  hash.add(curves.unit_normals(times, three, Threads::kAll));
  for (const float v : results.three) hash.add(v);
}

void add_recompute(Hash& hash, NormalRecompute recompute, Results& results) {
  results.xyz.resize(3 * recompute.size());
  const auto packed = VectorView<float>::packed(results.xyz.data(), recompute.size());
  for (const double t : {0.0, 0.34375, 1.0}) {
    hash.add(recompute.unit_normals(t, packed, Threads::kAll));
    for (const float v : results.xyz) hash.add(v);
  }
}

// The expected hash of all results. The hash changes with any bit of any result, and with the format of any block.
// Replace the hash only if the change is intended.
constexpr std::uint64_t kGolden = 0x3b625b5cb14a70ca;

TEST(GoldenBits, are_the_same_on_every_instruction_set_number_of_threads_and_compiler) {
  // The 67,712 faces are prepared in fifteen parts, and the 34,225 vertices are evaluated in three pieces.
  const Motion motion = test::integer_grid(184);
  const Segment segment = motion.segment(0);
  const NormalGroups groups =
      NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
  Results results;
  const auto targets = supported_targets();
  ASSERT_GE(targets.size(), 1u);
  for (const std::int64_t target : targets) {
    const ScopedTarget scoped(target);
    ASSERT_EQ(current_target(), target);
    for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
      const ThreadLimit limit(threads);
      Hash hash;
      std::vector<ControlNormals> normals(motion.topology.face_count());
      face_control_normals(segment, {0, normals.size()}, normals);
      for (const ControlNormals& c : normals) {
        hash.add(c.n0);
        hash.add(c.m);
        hash.add(c.n1);
      }
      for (const double tolerance : {1e-6, 1e-3, 5e-3}) {
        const CurveOptions options{tolerance};
        add_curves(hash, NormalCurves::of_faces(segment, options, Threads::kAll), results);
        add_curves(hash, NormalCurves::of_groups(segment, groups, options, Threads::kAll), results);
      }
      add_recompute(hash, NormalRecompute(segment), results);
      add_recompute(hash, NormalRecompute(segment, groups), results);
      EXPECT_EQ(hash.value(), kGolden) << std::hex << "0x" << hash.value() << std::dec << " on " << target_name(target)
                                       << " with " << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace chronormal::golden_bits_test
