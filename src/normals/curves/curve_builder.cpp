// Builds curves in parts, and puts the parts one after the other. Either all threads build parts at once, or one thread
// builds them in slices.
#include "normals/curves/curve_builder.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/blocks.h"
#include "motion/coherence.h"
#include "motion/segment_end.h"
#include "normals/curves/curve_sources.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/pack.h"
#include "normals/curves/part_builder.h"
#include "normals/groups/kernels/group_tiles.h"

namespace chronormal::inline internal {
namespace {

// Returns the number of elements in a part. A part is so small that its blocks stay in a cache until they are moved,
// and that all threads are busy to the end. Its size depends only on the number of elements, and so is the same for any
// number of threads.
std::size_t part_size(std::size_t size) {
  constexpr std::size_t kParts = 16;
  const std::size_t chunks = (size / kParts + kChunk - 1) / kChunk;
  return std::clamp<std::size_t>(chunks, 4, 32) * kChunk;
}

// A copy of the positions of a segment in which both positions of a vertex share a cache line, with 32 bytes per
// vertex. If vertices are in random order, the copy halves the cache misses.
class EndsSideBySide {
 public:
  // Prepares the copy of the positions of `segment`, in `memory` if that is large enough. Nothing is copied yet.
  EndsSideBySide(const Segment& segment, AlignedArray<float> memory)
      : ends_(std::move(memory)), from_(segment), segment_(segment) {
    const std::size_t count = segment.from.count;
    if (ends_.size() < kRow * count) {
      ends_ = {};
      ends_ = AlignedArray<float>(kRow * count);
    }
    const float* const p = ends_.data();
    segment_.from = {p, p + 1, p + 2, count, kRow};
    segment_.to = {p + 4, p + 5, p + 6, count, kRow};
  }

  void copy(IndexRange vertices) {
    for (std::size_t v = vertices.first; v < vertices.end(); ++v) {
      const Vec3f from = from_.from[v], to = from_.to[v];
      const float row[kRow] = {from.x, from.y, from.z, 0, to.x, to.y, to.z, 0};
      std::copy_n(row, kRow, ends_.data() + kRow * v);
    }
  }

  [[nodiscard]] const Segment& segment() const { return segment_; }
  [[nodiscard]] AlignedArray<float> take_memory() { return std::move(ends_); }

 private:
  static constexpr std::size_t kRow = kScatteredBytes / sizeof(float);
  AlignedArray<float> ends_;
  Segment from_, segment_;
};

// The state while curves are built. Either one thread builds part after part, a chunk at a time, or all threads build
// many parts at once.
class Build {
 public:
  Build(std::size_t size, const CurveOptions& options, CurveData* reuse)
      : limits_(options.tolerance), part_(part_size(size)) {
    if (reuse != nullptr) curves_ = std::exchange(*reuse, {});
    curves_.clear();
    curves_.size = size;
    curves_.keeps_lengths = limits_.with_lengths;
    if (size == 0) return;
    // Memory is reserved for the largest possible result. Memory that is never written costs nothing, because the
    // system provides it only when it is written.
    if (curves_.blocks.capacity() < whole() * kWorst) {
      curves_.blocks = {};
      curves_.blocks = AlignedBytes(whole() * kWorst);
    }
    parts_.resize((size + part_ - 1) / part_);
    for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p].elements = {p * part_, std::min(part_, size - p * part_)};
  }

  [[nodiscard]] std::size_t chunk_count() const { return block_count(curves_.size, kChunk); }

  // Builds the next `count` chunks, of kChunk elements each, on this thread.
  template <class Source>
  void make_chunks(Source& source, std::size_t count) {
    for (; count > 0; --count) {
      if (!builder_) {
        parts_[next_].begin = curves_.blocks.data() + bytes_;
        // The part gets the list of all flagged elements by a swap and appends its own, so that no element is copied.
        // The list is swapped back when the part is complete.
        std::swap(parts_[next_].flagged, curves_.flagged);
        builder_.emplace(parts_[next_], limits_);
      }
      if (builder_->make_chunk(source)) continue;
      builder_.reset();
      std::swap(parts_[next_].flagged, curves_.flagged);
      join(parts_[next_]);
      if (next_ < parts_.size()) parts_[next_].take_memory(parts_[next_ - 1]);
    }
  }

  // Builds all parts. Each thread has its own source, and builds in memory of its own. The place of a part in the
  // curves is known once all parts before it are built; the thread that built the part then copies it there.
  template <class MakeSource>
  void make_parts(const MakeSource& make_source) {
    constexpr std::size_t kNotKnown = ~std::size_t{0};
    std::vector<std::size_t> ends(parts_.size(), kNotKnown);
    std::mutex mutex;  // guards `ends`. std::atomic's wait() may miss its notification in libstdc++ for Windows
    std::condition_variable known;
    std::atomic<std::size_t> next = 0;
    parallel_for(std::min(thread_count(), parts_.size()), [&](std::size_t) {
      auto source = make_source();
      AlignedBytes near(part_ * kWorst);
      for (std::size_t p = next++; p < parts_.size(); p = next++) {
        const auto end_at = [&, p](std::size_t bytes) {
          const std::lock_guard lock(mutex);
          ends[p] = bytes;
          known.notify_all();
        };
        try {
          parts_[p].begin = near.data();
          PartBuilder builder(parts_[p], limits_);
          while (builder.make_chunk(source)) {
          }
        } catch (...) {
          end_at(0);  // so that no thread waits for a part that will not come
          throw;
        }
        // Parts are taken in order, so each earlier part is built or some thread is building it, and waiting for its
        // end is safe.
        std::size_t begin = 0;
        if (p > 0) {
          std::unique_lock lock(mutex);
          known.wait(lock, [&] { return ends[p - 1] != kNotKnown; });
          begin = ends[p - 1];
        }
        std::byte* const to = curves_.blocks.data() + begin;
        end_at(begin + parts_[p].bytes);
        std::memcpy(to, near.data(), parts_[p].bytes);
        parts_[p].begin = to;
      }
    });
  }

  // Joins the results of all parts that are not joined yet, and returns the curves.
  CurveData finish() {
    std::size_t flagged = curves_.flagged.size();
    for (std::size_t p = next_; p < parts_.size(); ++p) flagged += parts_[p].flagged.size();
    curves_.flagged.reserve(flagged);
    while (next_ < parts_.size()) join(parts_[next_]);
    curves_.blocks.resize(bytes_);
    return std::move(curves_);
  }

 private:
  static constexpr std::size_t kWorst = bytes_of(BlockKind::kQuadratic32);

  template <class T>
  static void append(std::vector<T>& to, const std::vector<T>& more) {
    to.insert(to.end(), more.begin(), more.end());
  }

  // Appends the results of the next part, whose blocks are already in their place.
  void join(const CurvePart& made) {
    for (const CurveData::Run& run : made.runs) {
      if (!curves_.runs.empty() && curves_.runs.back().kind == run.kind) {
        curves_.runs.back().block_count += run.block_count;
      } else {
        curves_.runs.push_back({run.first_block, run.block_count, bytes_ + run.offset, run.kind});
      }
    }
    curves_.flagged.append(made.flagged);
    for (const auto& [element, digits] : made.exact)
      curves_.exact.push_back({element, curves_.exact_digits.size() + digits});
    append(curves_.exact_digits, made.exact_digits);
    for (std::size_t d = 0; d < 3; ++d) curves_.degree_counts[d] += made.degree_counts[d];
    if (!made.exponents.empty() && curves_.keeps_lengths) {
      curves_.exponents.resize(whole() / kTile);
      std::copy(made.exponents.begin(), made.exponents.end(),
                curves_.exponents.begin() + static_cast<std::ptrdiff_t>(made.elements.first / kTile));
    }
    bytes_ += made.bytes;
    ++next_;
  }

  [[nodiscard]] std::size_t whole() const { return block_count(curves_.size, kTile) * kTile; }

  CurveData curves_;
  BuildLimits limits_;
  std::size_t part_;  // number of elements in a part
  std::vector<CurvePart> parts_;
  std::size_t next_ = 0, bytes_ = 0;    // the next part to be appended, and the bytes of the parts before it
  std::optional<PartBuilder> builder_;  // builds the current part, if parts are built one after the other
};

template <class MakeSource>
CurveData build(std::size_t size, const CurveOptions& options, Threads threads, CurveData* reuse,
                MakeSource make_source) {
  Build build(size, options, reuse);
  // A few elements are all built on this thread: starting another thread takes as long as building a few hundred
  // elements.
  if (threads == Threads::kAll && size > 2 * part_size(size)) {
    build.make_parts(make_source);
  } else if (size > 0) {
    auto source = make_source();
    build.make_chunks(source, build.chunk_count());
  }
  return build.finish();
}

// Takes from earlier curves the memory in which they kept both positions of each vertex side by side.
AlignedArray<float> scratch_of(CurveData* reuse) {
  return reuse != nullptr ? std::exchange(reuse->scratch, {}) : AlignedArray<float>();
}

bool are_far_apart(const Segment& segment) { return lines_per_face(*segment.topology) > kScatteredLines; }

// Returns true if both positions of each vertex must be copied side by side before curves are built.
bool needs_ends(const Segment& segment, const NormalGroups* groups) {
  const bool near = segment.from.count * 6 * sizeof(float) <= kNearBytes;
  return !near && !has_residuals(segment) && (groups != nullptr || segment.topology->all_triangles()) &&
         are_far_apart(segment);
}

// Builds the curves of faces if groups is nullptr, or of the elements of groups. Prefetches points if groups are
// scattered in memory.
CurveData build_elements(const Segment& segment, const NormalGroups* groups, bool scattered,
                         const CurveOptions& options, Threads threads, CurveData* reuse) {
  if (groups == nullptr)
    return build(segment.topology->face_count(), options, threads, reuse, [&] { return FaceNormals(segment); });
  return build(groups->size(), options, threads, reuse, [&] { return GroupNormals(segment, *groups, scattered); });
}

CurveData build_curves(const Segment& segment, const NormalGroups* groups, const CurveOptions& options, Threads threads,
                       CurveData* reuse) {
  if (!needs_ends(segment, groups)) return build_elements(segment, groups, false, options, threads, reuse);
  EndsSideBySide ends(segment, scratch_of(reuse));
  const std::size_t vertices = segment.from.count;
  blocks_on(threads, vertices, part_size(vertices), [&ends](IndexRange some) { ends.copy(some); });
  CurveData curves = build_elements(ends.segment(), groups, true, options, threads, reuse);
  if (reuse != nullptr) curves.scratch = ends.take_memory();
  return curves;
}

}  // namespace

CurveData build_curves(std::span<const ControlNormals> normals, const CurveOptions& options) {
  return build(normals.size(), options, Threads::kOne, nullptr, [&] { return GivenNormals(normals); });
}

CurveData build_curves(const Segment& segment, const CurveOptions& options, Threads threads, CurveData* reuse) {
  return build_curves(segment, nullptr, options, threads, reuse);
}

CurveData build_curves(const Segment& segment, const NormalGroups& groups, const CurveOptions& options, Threads threads,
                       CurveData* reuse) {
  return build_curves(segment, &groups, options, threads, reuse);
}

// The work of CurveSlices, in two steps. The first step copies both positions of each vertex side by side, but only if
// vertices are in no order. The second step builds the curves.
struct CurveSlices::State {
  State(const Segment& of_segment, const NormalGroups* of_groups, const CurveOptions& options, CurveData* reuse)
      : segment(of_segment),
        scratch(scratch_of(reuse)),
        build(of_groups != nullptr ? of_groups->size() : of_segment.topology->face_count(), options, reuse) {
    if (needs_ends(segment, of_groups)) {
      ends.emplace(segment, std::move(scratch));
      steps[0] = {segment.from.count, 0.1};
    }
    const Segment& source = ends ? ends->segment() : segment;
    if (of_groups == nullptr)
      faces_source.emplace(source);
    else if (of_groups->size() > 0)
      groups_source.emplace(source, *of_groups, ends.has_value());
    steps[1] = {build.chunk_count(), 1 - steps[0].share};
  }

  void run(std::size_t step, IndexRange some) {
    if (step == 0) return ends->copy(some);
    if (faces_source)
      build.make_chunks(*faces_source, some.count);
    else
      build.make_chunks(*groups_source, some.count);
  }

  struct Step {
    std::size_t count = 0;
    double share = 0;  // the approximate share of all work that is done
    std::size_t done = 0;
  };

  Segment segment;
  AlignedArray<float> scratch;
  std::optional<EndsSideBySide> ends;
  std::optional<FaceNormals> faces_source;
  std::optional<GroupNormals> groups_source;
  Build build;
  std::array<Step, 2> steps;
};

CurveSlices::CurveSlices(const Segment& segment, const NormalGroups* groups, const CurveOptions& options,
                         CurveData* reuse)
    : state_(std::make_unique<State>(segment, groups, options, reuse)) {}
CurveSlices::~CurveSlices() = default;

bool CurveSlices::advance(double share) {
  bool is_done = true;
  for (std::size_t i = 0; i < state_->steps.size(); ++i) {
    State::Step& step = state_->steps[i];
    const std::size_t left = step.count - step.done;
    if (left > 0 && share > 0) {
      const double wanted = std::ceil(share / step.share * static_cast<double>(step.count));
      const std::size_t count = wanted < static_cast<double>(left) ? static_cast<std::size_t>(wanted) : left;
      state_->run(i, {step.done, count});
      step.done += count;
      share -= step.share * static_cast<double>(count) / static_cast<double>(step.count);
    }
    is_done = is_done && step.done == step.count;
  }
  return is_done;
}

CurveData CurveSlices::finish() {
  advance(2);
  CurveData curves = state_->build.finish();
  if (state_->ends) curves.scratch = state_->ends->take_memory();
  return curves;
}

}  // namespace chronormal::inline internal
