// Checks every kind of memory access, on every instruction set and for every kind of block: each kind must write the
// same bits as plain stores, and must not change memory outside of the results.

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <vector>

#include "core/memory.h"
#include "normals/curves/kernels/evaluate.h"
#include "simd/targets.h"
#include "tests/support/fixtures.h"

namespace chronormal::evaluate_access_test {
namespace {

constexpr std::size_t kMost = 208;  // the largest number of elements, a multiple of all block sizes
constexpr std::size_t kGuard = 64;  // guard words on both sides of the results; the number keeps arrays aligned
constexpr std::uint32_t kMark = 0xDEADBEEF;
constexpr std::array kKinds = {BlockKind::kUnit,        BlockKind::kUnitLength,  BlockKind::kLinear16,
                               BlockKind::kQuadratic11, BlockKind::kQuadratic16, BlockKind::kScaled16,
                               BlockKind::kLinear32,    BlockKind::kQuadratic32};

bool is_float(BlockKind kind) {
  return kind == BlockKind::kUnit || kind == BlockKind::kUnitLength || kind == BlockKind::kLinear32 ||
         kind == BlockKind::kQuadratic32;
}

// Makes blocks of random bits, which in most kinds of blocks are valid directions. In blocks of floats, the floats are
// between 1 and 2.
AlignedArray<std::uint32_t> some_blocks(BlockKind kind, fixtures::Random& random) {
  AlignedArray<std::uint32_t> words(kMost * bytes_of(kind) / 4);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto bits = static_cast<std::uint32_t>(random.below(std::size_t{1} << 32));
    words[i] = is_float(kind) ? 0x3F800000u | bits >> 9 : bits;
  }
  return words;
}

// An output format: a function that evaluates a block into words, and a function that tells which words it may write.
struct Form {
  const char* name;
  std::function<void(const BlockSpan&, const CurveWeights&, float* words, MemoryAccess)> evaluate;
  std::function<bool(std::size_t word, std::size_t elements)> is_written;
};

const std::vector<Form>& forms() {
  const auto in_order = [](std::size_t each) {
    return [each](std::size_t word, std::size_t elements) { return word < each * elements; };
  };
  const auto bits = [](float* words) { return reinterpret_cast<std::uint32_t*>(words); };
  static const std::vector<Form> all = {
      {"packed",
       [](const BlockSpan& span, const CurveWeights& w, float* words, MemoryAccess access) {
         evaluate_blocks(span, w, PackedResult{words, access});
       },
       in_order(3)},
      {"planes",
       [](const BlockSpan& span, const CurveWeights& w, float* words, MemoryAccess access) {
         evaluate_blocks(span, w, PlanesResult{words, words + kMost, words + 2 * kMost, access});
       },
       [](std::size_t word, std::size_t elements) { return word < 3 * kMost && word % kMost < elements; }},
      {"octahedral",
       [bits](const BlockSpan& span, const CurveWeights& w, float* words, MemoryAccess access) {
         evaluate_blocks(span, w, OctahedralResult{bits(words), access});
       },
       in_order(1)},
      {"rgb10a2",
       [bits](const BlockSpan& span, const CurveWeights& w, float* words, MemoryAccess access) {
         evaluate_blocks(span, w, Rgb10A2Result{bits(words), access});
       },
       in_order(1)},
  };
  return all;
}

std::vector<std::uint32_t> evaluated(const Form& form, const BlockSpan& span, MemoryAccess access) {
  AlignedArray<float> words(3 * kMost + 2 * kGuard);
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = std::bit_cast<float>(kMark);
  form.evaluate(span, CurveWeights::at(0.3, true), words.data() + kGuard, access);
  flush_stream();
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < words.size(); ++i) result.push_back(std::bit_cast<std::uint32_t>(words[i]));
  return result;
}

TEST(EvaluateAccess, changes_no_bit_and_writes_nothing_else) {
  fixtures::Random random(7);
  for (const std::int64_t target : supported_targets()) {
    const ScopedTarget scope(target);
    SCOPED_TRACE(target_name(target));
    for (const BlockKind kind : kKinds) {
      const auto blocks = some_blocks(kind, random);
      for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 15, 16, 17, 31, 32, 100, 208}) {
        const BlockSpan span{reinterpret_cast<const std::byte*>(blocks.data()), kind, count};
        for (const Form& form : forms()) {
          SCOPED_TRACE(form.name);
          const std::vector<std::uint32_t> plain = evaluated(form, span, {});
          for (std::size_t i = 0; i < plain.size(); ++i) {
            const bool inside = i >= kGuard && form.is_written(i - kGuard, count);
            ASSERT_EQ(plain[i] != kMark, inside) << "word " << i << " of kind " << static_cast<int>(kind);
          }
          for (const WorkingSet set :
               {WorkingSet::kSmall, WorkingSet::kMedium, WorkingSet::kSharedCache, WorkingSet::kMemory}) {
            for (const bool stream : {false, true})
              ASSERT_EQ(evaluated(form, span, {set, stream}), plain) << static_cast<int>(kind) << ", " << count;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace chronormal::evaluate_access_test
