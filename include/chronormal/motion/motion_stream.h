/// A motion that is larger than memory: its keyframes are read when they are needed, and released after that.
///
///     MotionStream stream = ...;                      // from Input::stream() in io/input.h, or from a whole motion
///     for (std::size_t s = 0; s < stream.motion().segments.size(); ++s) {
///       if (const Status status = stream.hold_segment(s); !status) return status.error();
///       const Segment segment = stream.motion().segment(s);      // good until the next hold
///     }
///
/// motion() is the whole motion except for the positions of keyframes that are not held: faces, segments, times and
/// names are always there. So a function that takes a Motion takes the motion of a stream too, once the stream holds
/// what the function looks at. Where keyframes are held one after the other, a thread of its own reads the next one
/// ahead.
///
/// Memory     the keyframes that are held, and one that is read ahead. Keyframes that take no more than `kept` bytes
///            together are read once and stay. A motion that was whole before takes nothing more.
/// Threads    one stream belongs to one thread at a time; what is held may be read by many.
#ifndef CHRONORMAL_MOTION_MOTION_STREAM_H_
#define CHRONORMAL_MOTION_MOTION_STREAM_H_

#include <cstddef>
#include <functional>
#include <memory>
#include <span>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

class MotionStream {
 public:
  /// Writes the 3 x vertex_count coordinates of a keyframe of the motion, all of them finite. It is called from one
  /// thread at a time, not always from the same.
  using Reader = std::function<Status(const Motion& motion, std::size_t keyframe, std::span<float> positions)>;

  /// Is told of the positions of a keyframe, as the reader has written them.
  using Watcher = std::function<Status(std::size_t keyframe, std::span<const float> positions)>;

  static constexpr std::size_t kUsuallyKept = std::size_t{64} << 20;

  /// A motion that is in memory and stays there; it must outlive the stream, and it may stand still.
  explicit MotionStream(const Motion& whole);

  /// A motion whose keyframes have no positions yet; the first one may have some. Everything else of the outline must
  /// be valid (motion/motion.h).
  MotionStream(Motion outline, Reader read, std::size_t kept = kUsuallyKept);

  MotionStream(MotionStream&& other) noexcept;
  MotionStream& operator=(MotionStream&& other) noexcept;
  ~MotionStream();

  [[nodiscard]] const Motion& motion() const noexcept;

  /// Makes the positions of keyframes first to last be there, until the next hold. Errors: those of the reader.
  /// first <= last, and last must be a keyframe
  [[nodiscard]] Status hold(std::size_t first, std::size_t last);
  /// The same of both ends of segments first to last.
  [[nodiscard]] Status hold_segments(std::size_t first, std::size_t last);
  [[nodiscard]] Status hold_segment(std::size_t segment) { return hold_segments(segment, segment); }
  /// The same of all keyframes: the motion is in memory then.
  [[nodiscard]] Status hold_all();

  /// Tells the watcher at once of every keyframe that is there, and from now on of each that is read, before anybody
  /// else sees it and by the thread that reads it. There is one watcher at a time; an empty one ends this. Errors:
  /// those of the watcher, here and for each hold.
  [[nodiscard]] Status watch(Watcher watcher);

  /// Whether keyframes stay where they are once they were held: to hold all is no more than to read them.
  [[nodiscard]] bool keeps_all() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_MOTION_MOTION_STREAM_H_
