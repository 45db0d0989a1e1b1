// The kernel of degree 6 has the bits of plain C++ on every instruction set, for packed results and planes, past the
// caches or not.

#include "normals/curves/kernels/evaluate_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/memory.h"
#include "simd/targets.h"
#include "tests/support/fixtures.h"

namespace chronormal::evaluate_path_test {
namespace {

constexpr std::size_t kBlocks = 37;

// Evaluates one element, in the order of additions that the kernel promises.
float sum_of(const float* c, const PathWeights& w) {
  const auto term = [&](std::size_t k) { return w[k] * c[3 * k * kTile]; };
  const float first = (term(0) + term(1)) + (term(2) + term(3)), last = (term(4) + term(5)) + term(6);
  return first + last;
}

TEST(EvaluatePath, is_plain_arithmetic_on_every_instruction_set_and_in_every_form) {
  fixtures::Random random(7);
  AlignedArray<float> blocks(kBlocks * kPathBlock);
  for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i] = static_cast<float>(random.uniform(-1, 1));
  const PathWeights weights = {0.01F, 0.06F, 0.2F, 0.33F, 0.25F, 0.1F, 0.05F};
  constexpr std::size_t kCount = kBlocks * kTile;
  std::vector<float> right;
  for (std::size_t i = 0; i < kCount; ++i) {
    const float* const c = blocks.data() + i / kTile * kPathBlock + i % kTile;
    const float x = sum_of(c, weights), y = sum_of(c + kTile, weights), z = sum_of(c + 2 * kTile, weights);
    const float scale = 1 / std::sqrt((x * x + y * y) + z * z);
    right.insert(right.end(), {scale * x, scale * y, scale * z});
  }
  for (const std::int64_t target : supported_targets()) {
    const ScopedTarget scoped(target);
    for (const bool stream : {false, true}) {
      const MemoryAccess access{WorkingSet::kMemory, stream};
      AlignedArray<float> packed(3 * kCount), x(kCount), y(kCount), z(kCount);
      evaluate_path_blocks(blocks.data(), kBlocks, weights, PackedResult{packed.data(), access});
      evaluate_path_blocks(blocks.data(), kBlocks, weights, PlanesResult{x.data(), y.data(), z.data(), access});
      flush_stream();
      for (std::size_t i = 0; i < kCount; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
          ASSERT_EQ(packed[3 * i + c], right[3 * i + c]) << target_name(target) << ' ' << i << " streamed: " << stream;
        ASSERT_EQ(x[i], right[3 * i]) << target_name(target) << ' ' << i;
        ASSERT_EQ(y[i], right[3 * i + 1]) << target_name(target) << ' ' << i;
        ASSERT_EQ(z[i], right[3 * i + 2]) << target_name(target) << ' ' << i;
      }
    }
  }
}

}  // namespace
}  // namespace chronormal::evaluate_path_test
