#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "memory/bare_loop.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace chronormal::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// For each block, reads `kRead` lines of 64 bytes, adds them up into three lines, and writes these three lines.
template <std::size_t kRead, bool kStream, std::size_t kAhead>
void Lines(const float* from, float* to, std::size_t blocks) {
  constexpr std::size_t kLine = 16, kWritten = 3;  // floats in a line, and number of lines that are written
  const hn::CappedTag<float, kLine> tag;
  const std::size_t lanes = hn::Lanes(tag);
  for (std::size_t b = 0; b < blocks; ++b) {
    const float* const block = from + b * kRead * kLine;
    float* const result = to + b * kWritten * kLine;
    for (std::size_t line = 0; line < kRead && kAhead > 0; ++line) hwy::Prefetch(block + line * kLine + kAhead / 4);
    for (std::size_t lane = 0; lane < kLine; lane += lanes) {
      const auto load = [&](std::size_t line) HWY_ATTR { return hn::Load(tag, block + line * kLine + lane); };
      for (std::size_t w = 0; w < kWritten; ++w) {
        auto sum = hn::Set(tag, 1.0f);
        for (std::size_t line = w; line < kRead; line += kWritten) sum = hn::Add(sum, load(line));
        if constexpr (kStream) {
          hn::Stream(sum, tag, result + w * kLine + lane);
        } else {
          hn::Store(sum, tag, result + w * kLine + lane);
        }
      }
    }
  }
  if constexpr (kStream) hwy::FlushStream();
}

template <std::size_t kRead>
void ByWay(int way, const float* from, float* to, std::size_t blocks) {
  switch (way) {
    case 0:
      return Lines<kRead, false, 0>(from, to, blocks);
    case 1:
      return Lines<kRead, false, 8192>(from, to, blocks);
    case 2:
      return Lines<kRead, true, 0>(from, to, blocks);
    case 3:
      return Lines<kRead, true, 8192>(from, to, blocks);
    case 4:
      return Lines<kRead, true, 16384>(from, to, blocks);
    case 5:
      return Lines<kRead, false, 2048>(from, to, blocks);
    default:
      return Lines<kRead, true, 2048>(from, to, blocks);
  }
}

void Lines0(int way, const float* from, float* to, std::size_t blocks) { ByWay<0>(way, from, to, blocks); }
void Lines5(int way, const float* from, float* to, std::size_t blocks) { ByWay<5>(way, from, to, blocks); }
void Lines9(int way, const float* from, float* to, std::size_t blocks) { ByWay<9>(way, from, to, blocks); }

}  // namespace chronormal::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>

#include "core/blocks.h"
#include "measure/timing.h"
#include "memory/bare_loop.h"

namespace chronormal::bench {
namespace {

HWY_EXPORT(Lines0);
HWY_EXPORT(Lines5);
HWY_EXPORT(Lines9);

constexpr int kWays = 7;
constexpr std::size_t kBlock = 16;   // number of elements in a block
constexpr std::size_t kPiece = 512;  // number of blocks that a thread takes at a time
// The number of floats in an array behind its data, so that prefetches beyond the end of the data stay inside the
// array.
constexpr std::size_t kFloatsBeyond = 2 * 16384 / 4;

}  // namespace

BareLoop::BareLoop(Reads reads, std::size_t count, Threads threads)
    : reads_(reads),
      blocks_((count + kBlock - 1) / kBlock),
      threads_(threads),
      from_(blocks_ * kBlock * static_cast<std::size_t>(reads) / 4 + kFloatsBeyond),
      to_(blocks_ * kBlock * 3) {
  std::fill_n(from_.data(), from_.size(), 1.0f);
  double least = 0;
  int fastest = 0;
  for (int turn = 0; turn < 3 * kWays; ++turn) {
    way_ = turn % kWays;
    const double seconds = roughly_timed([this] { run(); });
    if (turn == 0 || seconds < least) least = seconds, fastest = way_;
  }
  way_ = fastest;
}

void BareLoop::run() const {
  blocks_on(blocks_ < 2 * kPiece ? Threads::kOne : threads_, blocks_, kPiece, [this](IndexRange blocks) {
    const float* const from = from_.data() + blocks.first * kBlock * static_cast<std::size_t>(reads_) / 4;
    float* const to = to_.data() + blocks.first * kBlock * 3;
    switch (reads_) {
      case Reads::kNothing:
        return HWY_DYNAMIC_DISPATCH(Lines0)(way_, from, to, blocks.count);
      case Reads::kCompact:
        return HWY_DYNAMIC_DISPATCH(Lines5)(way_, from, to, blocks.count);
      case Reads::kExact:
        return HWY_DYNAMIC_DISPATCH(Lines9)(way_, from, to, blocks.count);
    }
  });
}

}  // namespace chronormal::bench

#endif  // HWY_ONCE
