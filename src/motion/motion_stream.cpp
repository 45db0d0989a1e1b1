// Moves a window of keyframes over a motion. Keyframes that leave the window give their memory to keyframes that enter
// it. Memory is therefore allocated only once, for the window and for the keyframe that is read in advance.
#include "chronormal/motion/motion.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>
#include <vector>

#ifndef __EMSCRIPTEN__
#include <future>
#include <system_error>
#endif

namespace chronormal {
namespace {

// Reads one keyframe on another thread while the caller computes. On systems without threads, nothing is read in
// advance.
class ReadAhead {
 public:
#ifndef __EMSCRIPTEN__
  static constexpr bool kCan = true;
#else
  static constexpr bool kCan = false;
#endif

  [[nodiscard]] bool is_of(std::size_t keyframe) const noexcept { return keyframe_ == keyframe; }
  [[nodiscard]] bool is_under_way() const noexcept { return keyframe_.has_value(); }

  // Starts to read a keyframe. A copy of `read` is called with the number of the keyframe and with memory for its
  // positions. Objects to which `read` refers must live until finish() returns.
  template <class Read>
  void start([[maybe_unused]] const Read& read, [[maybe_unused]] std::size_t keyframe, std::vector<float> room) {
    positions_ = std::move(room);
#ifndef __EMSCRIPTEN__
    try {
      done_ = std::async(std::launch::async, [read, keyframe, this] { return read(keyframe, positions_); });
      keyframe_ = keyframe;
    } catch (const std::system_error&) {
      keyframe_.reset();  // no thread was granted, so the keyframe is read when it is needed
    }
#endif
  }

  // Waits until the keyframe is read, and moves its positions to `positions`.
  Status finish(std::vector<float>& positions) {
    Status status = Success{};
#ifndef __EMSCRIPTEN__
    if (keyframe_) status = done_.get();
#endif
    keyframe_.reset();
    positions = std::move(positions_);
    return status;
  }

 private:
  std::optional<std::size_t> keyframe_;
  std::vector<float> positions_;
#ifndef __EMSCRIPTEN__
  std::future<Status> done_;
#endif
};

}  // namespace

struct MotionStream::State {
  const Motion* whole = nullptr;  // the motion in memory, or nullptr; if it is set, the other members are not used
  Motion outline = {};
  Reader read = {};
  Watcher watcher = {};
  bool keeps_all = false;
  std::size_t first = 0, end = 0;              // the keyframes in the window: from `first` to before `end`
  std::vector<std::vector<float>> spare = {};  // memory of keyframes that left the window
  // Must be the last member, which is destroyed first, since reading must end before the data that it uses are
  // destroyed.
  ReadAhead ahead = {};

  [[nodiscard]] std::vector<float> room() {
    std::vector<float> positions;
    if (!spare.empty()) {
      positions = std::move(spare.back());
      spare.pop_back();
    }
    positions.resize(3 * outline.topology.vertex_count());
    return positions;
  }

  // Reads a keyframe, and passes its positions to the watcher.
  [[nodiscard]] Status read_keyframe(std::size_t keyframe, std::span<float> positions) const {
    const Status status = read(outline, keyframe, positions);
    return status && watcher ? watcher(keyframe, positions) : status;
  }

  // Waits for the keyframe that is being read in advance, and drops it.
  void drop_ahead() {
    if (!ahead.is_under_way()) return;
    std::vector<float> read_positions;
    (void)ahead.finish(read_positions);
    spare.push_back(std::move(read_positions));
  }

  void leave(std::size_t keyframe) {
    std::vector<float>& positions = outline.keyframes[keyframe].positions;
    if (!positions.empty()) spare.push_back(std::move(positions));
    positions = {};
  }

  [[nodiscard]] Status enter(std::size_t keyframe) {
    std::vector<float>& positions = outline.keyframes[keyframe].positions;
    if (!positions.empty()) return Success{};
    std::vector<float> read_positions;
    if (ahead.is_under_way() && ahead.is_of(keyframe)) {
      const Status status = ahead.finish(read_positions);
      if (status) positions = std::move(read_positions);
      return status;
    }
    drop_ahead();
    read_positions = room();
    const Status status = read_keyframe(keyframe, read_positions);
    if (status) positions = std::move(read_positions);
    return status;
  }
};

MotionStream::MotionStream(const Motion& whole) : state_(std::make_unique<State>()) { state_->whole = &whole; }

MotionStream::MotionStream(Motion outline, Reader read, std::size_t kept) : state_(std::make_unique<State>()) {
  const std::size_t bytes = 3 * sizeof(float) * std::max<std::size_t>(outline.topology.vertex_count(), 1);
  state_->keeps_all = outline.keyframes.size() <= kept / bytes;
  state_->outline = std::move(outline);
  state_->end = state_->outline.keyframes.front().positions.empty() ? 0 : 1;
  state_->read = std::move(read);
}

MotionStream::MotionStream(MotionStream&& other) noexcept = default;
MotionStream& MotionStream::operator=(MotionStream&& other) noexcept = default;
MotionStream::~MotionStream() = default;

const Motion& MotionStream::motion() const noexcept { return state_->whole ? *state_->whole : state_->outline; }

bool MotionStream::keeps_all() const noexcept { return state_->whole != nullptr || state_->keeps_all; }

Status MotionStream::hold(std::size_t first, std::size_t last) {
  State& state = *state_;
  assert(first <= last && last < motion().keyframes.size());
  if (state.whole != nullptr || (first >= state.first && last < state.end)) return Success{};
  const bool goes_on = state.end > 0 && first <= state.end && last >= state.end;
  for (std::size_t k = state.first; k < state.end && !state.keeps_all; ++k)
    if (k < first || k > last) state.leave(k);
  for (std::size_t k = first; k <= last; ++k) {
    if (Status status = state.enter(k); !status) {
      for (std::size_t rest = k; rest <= last; ++rest) state.leave(rest);
      state.first = first;
      state.end = k;
      return status;
    }
  }
  state.first = first;
  state.end = last + 1;
  const bool is_more = state.end < state.outline.keyframes.size();
  if (ReadAhead::kCan && goes_on && is_more && !state.ahead.is_under_way() &&
      state.outline.keyframes[state.end].positions.empty())
    state.ahead.start(
        [&state](std::size_t keyframe, std::span<float> positions) { return state.read_keyframe(keyframe, positions); },
        state.end, state.room());
  state.spare.clear();
  return Success{};
}

Status MotionStream::watch(Watcher watcher) {
  state_->drop_ahead();
  state_->watcher = std::move(watcher);
  if (!state_->watcher) return Success{};
  const Motion& all = motion();
  for (std::size_t k = 0; k < all.keyframes.size(); ++k) {
    const std::vector<float>& positions = all.keyframes[k].positions;
    if (positions.empty()) continue;
    if (Status status = state_->watcher(k, positions); !status) return status;
  }
  return Success{};
}

Status MotionStream::hold_segments(std::size_t first, std::size_t last) {
  const Motion& all = motion();
  assert(first <= last && last < all.segments.size());
  return hold(all.segments[first].from, all.segments[last].to);
}

Status MotionStream::hold_all() {
  const std::size_t count = motion().keyframes.size();
  if (count == 0) return Success{};
  return hold(0, count - 1);
}

}  // namespace chronormal
