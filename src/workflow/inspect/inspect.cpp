// Looks at every segment of a motion for whatever may cause wrong normals, block by block and in waves of segments, and
// adds up what it finds in order.
#include "chronormal/workflow/inspect.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "analysis/signs/near_collapse.h"
#include "chronormal/analysis/collapse.h"
#include "chronormal/core/parallel.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "core/blocks.h"
#include "core/portable_math.h"

namespace chronormal {
namespace {

// Half a unit in the last place of float32 moves an end of an edge by up to sqrt(3) of it, so the edge by twice that,
// and the cross product of two edges by twice that again, times the longer edge.
constexpr double kRounding = 4 * 1.7320508075688772 * 0x1p-24;

// So many faces, or vertices, are a block: their control normals stay in the second-level cache. A wave has a segment,
// or where segments are small as many as keep all threads busy.
constexpr std::size_t kBlock = 4096, kBlocksPerThread = 4;

// What can be wrong with a face, a bit each.
enum Mark : std::uint8_t {
  kNoArea = 1,
  kSliver = 2,
  kCollapses = 4,
  kTurnsOver = 8,
  kTurnsFar = 16,
  kWithoutNormal = 32,
  kVanishes = 64,
};

using FaceMarks = std::vector<std::atomic<std::uint8_t>>;

// Faces at one keyframe, or of one kind in one segment.
struct FaceTally {
  std::size_t count = 0, first_face = 0;
  double first_t = 0;

  // Faces come in ascending order.
  void add(std::size_t face, Mark mark, FaceMarks& marks, double t = 0) {
    if (count++ == 0) {
      first_face = face;
      first_t = t;
    }
    marks[face].fetch_or(mark, std::memory_order_relaxed);
  }
  // The next faces, of the same keyframe or segment.
  void add(const FaceTally& next) {
    if (count == 0) {
      first_face = next.first_face;
      first_t = next.first_t;
    }
    count += next.count;
  }
};

struct KeyframeTally {
  FaceTally no_area, slivers;

  void add(const KeyframeTally& next) {
    no_area.add(next.no_area);
    slivers.add(next.slivers);
  }
};

void keep_larger(Largest& largest, const Largest& other) {
  if (other.value > largest.value) largest = other;
}

// A tally has what was found in one block of a segment, or in all of its blocks so far.
struct SegmentTally {
  KeyframeTally from, to;  // of the keyframes that this segment judges
  FaceTally collapses, vanishing, turned_over, turned_far, without_normals;
  Largest motion, turn;
  std::size_t moved_vertices = 0;

  void add(const SegmentTally& next) {
    from.add(next.from);
    to.add(next.to);
    collapses.add(next.collapses);
    vanishing.add(next.vanishing);
    turned_over.add(next.turned_over);
    turned_far.add(next.turned_far);
    without_normals.add(next.without_normals);
    keep_larger(motion, next.motion);
    keep_larger(turn, next.turn);
    moved_vertices += next.moved_vertices;
  }
  [[nodiscard]] SegmentInspection inspection(const NormalCurves& curves) const {
    SegmentInspection result;
    result.moved_vertices = moved_vertices;
    result.motion = motion;
    result.turn = turn;
    result.turned_far = turned_far.count;
    result.collapses = collapses.count;
    result.vanishing = vanishing.count;
    result.turned_over = turned_over.count;
    result.without_normals = without_normals.count;
    result.flagged = curves.flagged_count();
    result.bytes = curves.bytes();
    return result;
  }
};

void add_tally(Places& places, const FaceTally& tally, std::size_t at) {
  if (places.pairs == 0 && tally.count > 0) {
    places.first_at = at;
    places.first_face = tally.first_face;
    places.first_t = tally.first_t;
  }
  places.pairs += tally.count;
}

std::size_t count_marked(const FaceMarks& marks, Mark mark) {
  return static_cast<std::size_t>(
      std::count_if(marks.begin(), marks.end(), [mark](const auto& bits) { return (bits & mark) != 0; }));
}

Segment still_segment(const Motion& motion, std::size_t keyframe) {
  const auto positions =
      VectorView<const float>::packed(motion.keyframes[keyframe].positions.data(), motion.topology.vertex_count());
  return {&motion.topology, positions, positions, 0, 1, 0};
}

// How long a normal may be that is nothing but the rounding of its positions.
double rounding_of(std::span<const std::uint32_t> face, VectorView<const float> positions) {
  double coordinate = 0, edge = 0;
  const Vec3d origin = to_double(positions[face[0]]);
  for (const std::uint32_t vertex : face) {
    const Vec3d p = to_double(positions[vertex]);
    coordinate = maximum_number(coordinate, max_abs(p));
    edge = maximum_number(edge, max_abs(p - origin));
  }
  return kRounding * static_cast<double>(face.size() - 2) * coordinate * edge;
}

// Judges some faces of one keyframe by the normals that they have there. No coordinate is larger than `most`.
template <class NormalOf>
KeyframeTally inspect_keyframe(const Topology& topology, VectorView<const float> positions, double most,
                               IndexRange faces, NormalOf normal_of, FaceMarks& marks) {
  KeyframeTally tally;
  const double largest_rounding = kRounding * most * 2 * most;  // of a triangle
  for (std::size_t f = faces.first; f < faces.end(); ++f) {
    const double size = max_abs(normal_of(f - faces.first));
    const std::span<const std::uint32_t> face = topology.face(f);
    if (size > static_cast<double>(face.size() - 2) * largest_rounding) continue;
    if (size == 0)
      tally.no_area.add(f, kNoArea, marks);
    else if (size <= rounding_of(face, positions))
      tally.slivers.add(f, kSliver, marks);
  }
  return tally;
}

void inspect_vertices(const Segment& segment, IndexRange vertices, SegmentTally& tally) {
  for (std::size_t v = vertices.first; v < vertices.end(); ++v) {
    const Vec3d step = to_double(segment.to[v]) - to_double(segment.from[v]);
    if (max_abs(step) == 0) continue;
    ++tally.moved_vertices;
    if (const double distance = length(step); distance > tally.motion.value)
      tally.motion = {distance, segment.index, v};
  }
}

// Two vectors with a positive dot product certainly differ by less than the angle where the square of this product is a
// larger share than this of the product of their squared lengths.
double square_of_cosine_above(double angle) {
  const double cosine = angle < std::numbers::pi / 2 ? portable::cos(angle) : 0;
  return cosine * cosine * (1 + 1e-12);
}

void inspect_faces(const Segment& segment, IndexRange faces, std::span<const ControlNormals> normals, FaceMarks& marks,
                   SegmentTally& tally) {
  double most_of_square = square_of_cosine_above(0);
  for (std::size_t f = faces.first; f < faces.end(); ++f) {
    const ControlNormals& c = normals[f - faces.first];
    const double along = dot(c.n0, c.n1);
    const bool turns_less = along > 0 && along * along > most_of_square * (dot(c.n0, c.n0) * dot(c.n1, c.n1));
    if (!turns_less) {
      if (const double angle = angle_between(c.n0, c.n1); angle > tally.turn.value) {
        tally.turn = {angle, segment.index, f};
        most_of_square = square_of_cosine_above(angle);
      }
    }
    if (along < 0) tally.turned_far.add(f, kTurnsFar, marks);
    if (is_far_from_collapse(c)) continue;
    const Collapses exact = find_collapses(segment, f, c);
    const auto zero = std::find_if(exact.instants().begin(), exact.instants().end(), [](const Collapse& each) {
      return each.before != Vec3d{} && each.after != Vec3d{};  // and not at an end
    });
    if (zero != exact.instants().end()) tally.vanishing.add(f, kVanishes, marks, zero->upper);
    if (exact.always) tally.without_normals.add(f, kWithoutNormal, marks);
    const NearCollapses collapses = find_near_collapses(c);
    if (collapses.count == 0) continue;
    tally.collapses.add(f, kCollapses, marks, collapses.at[0].t);
    const auto end = collapses.at.begin() + static_cast<std::ptrdiff_t>(collapses.count);
    const auto over = std::find_if(collapses.at.begin(), end, [](const NearCollapse& each) { return each.turns_over; });
    if (over != end) tally.turned_over.add(f, kTurnsOver, marks, over->t);
  }
}

Status inspect_box(MotionStream& stream, Inspection& result) {
  const Motion& motion = stream.motion();
  Vec3f low, high;
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    if (Status status = stream.hold(k, k); !status) return status;
    const Motion::Keyframe& keyframe = motion.keyframes[k];
    if (k == 0 && !keyframe.positions.empty()) low = high = still_segment(motion, 0).from[0];
    for (std::size_t i = 0; i + 2 < keyframe.positions.size(); i += 3) {
      const float* const p = keyframe.positions.data() + i;
      low = {std::min(low.x, p[0]), std::min(low.y, p[1]), std::min(low.z, p[2])};
      high = {std::max(high.x, p[0]), std::max(high.y, p[1]), std::max(high.z, p[2])};
    }
  }
  result.low = to_double(low);
  result.high = to_double(high);
  result.diagonal = length(result.high - result.low);
  return Success{};
}

// The block of this number, of so many faces or vertices; empty behind the last.
IndexRange block_of(std::size_t number, std::size_t count) {
  const std::size_t first = std::min(number * kBlock, count);
  return {first, std::min(kBlock, count - first)};
}

}  // namespace

Inspection inspect(const Motion& motion, const std::function<void(std::size_t done, std::size_t total)>& progress) {
  MotionStream stream(motion);
  return inspect(stream, progress).value();
}

Result<Inspection> inspect(MotionStream& stream,
                           const std::function<void(std::size_t done, std::size_t total)>& progress) {
  const Motion& motion = stream.motion();
  const Topology& topology = motion.topology;
  Inspection result;
  result.vertices = topology.vertex_count();
  result.faces = topology.face_count();
  result.keyframes = motion.keyframes.size();
  result.keyframe_bytes = result.keyframes * result.vertices * 3 * sizeof(float);
  const auto earlier = [](const auto& a, const auto& b) { return a.time < b.time; };
  const auto times = std::minmax_element(motion.keyframes.begin(), motion.keyframes.end(), earlier);
  result.first_time = times.first->time;
  result.last_time = times.second->time;
  if (const Status status = inspect_box(stream, result); !status) return status.error();

  const Result<Points> welded = weld_coincident(stream);
  if (!welded) return welded.error();
  const Points& points = welded.value();
  result.doubled = find_copies(points);
  if (const Status status = stream.hold(0, 0); !status) return status.error();
  result.doubled_at_start =
      find_copies(weld_coincident({topology, {motion.keyframes.front()}, {}, motion.body_of_vertex}));
  result.surface = survey(topology, points);

  // The first segment at a keyframe judges it; one without a segment is judged as if it stood still.
  const std::size_t segment_count = motion.segments.size();
  std::vector<std::optional<std::size_t>> judge(result.keyframes);
  for (std::size_t s = segment_count; s > 0; --s) {
    judge[motion.segments[s - 1].from] = s - 1;
    judge[motion.segments[s - 1].to] = s - 1;
  }
  std::vector<std::size_t> still;
  for (std::size_t k = 0; k < judge.size(); ++k) {
    if (!judge[k]) still.push_back(k);
  }
  const double most = maximum_number(max_abs(result.low), max_abs(result.high));
  FaceMarks marks(result.faces);
  std::vector<KeyframeTally> keyframes(result.keyframes);
  std::vector<SegmentTally> segments(segment_count);
  const std::size_t total = segment_count + still.size();
  const std::size_t blocks = block_count(std::max({result.faces, result.vertices, std::size_t{1}}), kBlock);
  const std::size_t wave = block_count(kBlocksPerThread * thread_count(), blocks);
  std::vector<SegmentTally> of_blocks(std::min(wave, total) * blocks);
  std::vector<NormalCurves> curves(std::min(wave, total));  // kept, since so much memory takes long to get
  for (std::size_t first = 0; first < total; first += wave) {
    const std::size_t count = std::min(wave, total - first);
    const auto keys_of = [&](std::size_t s) {
      return s < segment_count ? motion.segments[s]
                               : Motion::SegmentKeys{still[s - segment_count], still[s - segment_count]};
    };
    Motion::SegmentKeys keys = keys_of(first);
    for (std::size_t s = first; s < first + count; ++s)
      keys = {std::min(keys.from, keys_of(s).from), std::max(keys.to, keys_of(s).to)};
    if (const Status status = stream.hold(keys.from, keys.to); !status) return status.error();

    parallel_for(count * blocks, [&](std::size_t i) {
      const std::size_t s = first + i / blocks;
      const bool moves = s < segment_count;
      const Segment segment = moves ? motion.segment(s) : still_segment(motion, still[s - segment_count]);
      const IndexRange faces = block_of(i % blocks, result.faces);
      std::vector<ControlNormals> normals(faces.count);
      face_control_normals(segment, faces, normals);
      SegmentTally& tally = of_blocks[i] = {};
      if (!moves || judge[motion.segments[s].from] == s)
        tally.from = inspect_keyframe(
            topology, segment.from, most, faces, [&normals](std::size_t f) { return normals[f].n0; }, marks);
      if (!moves) return;
      if (judge[motion.segments[s].to] == s)
        tally.to = inspect_keyframe(
            topology, segment.to, most, faces, [&normals](std::size_t f) { return normals[f].n1; }, marks);
      inspect_vertices(segment, block_of(i % blocks, result.vertices), tally);
      inspect_faces(segment, faces, normals, marks, tally);
    });
    const auto make_curves = [&](std::size_t i, Threads threads) {
      if (first + i < segment_count)
        curves[i] = NormalCurves::of_faces(motion.segment(first + i), {}, threads, &curves[i]);
    };
    if (count == 1) {
      make_curves(0, Threads::kAll);
    } else {
      parallel_for(count, [&](std::size_t i) { make_curves(i, Threads::kOne); });
    }

    for (std::size_t i = 0; i < count; ++i) {
      SegmentTally tally;
      for (std::size_t b = 0; b < blocks; ++b) tally.add(of_blocks[i * blocks + b]);
      const auto [from, to] = keys_of(first + i);
      if (first + i >= segment_count || judge[from] == first + i) keyframes[from] = tally.from;
      if (first + i >= segment_count) continue;
      if (judge[to] == first + i) keyframes[to] = tally.to;
      result.segments.push_back(tally.inspection(curves[i]));
      segments[first + i] = tally;
    }
    if (progress) progress(first + count, total);
  }

  // In order, so that what is first does not depend on the threads.
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    add_tally(result.no_area, keyframes[k].no_area, k);
    add_tally(result.slivers, keyframes[k].slivers, k);
  }
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const SegmentTally& tally = segments[s];
    add_tally(result.collapses, tally.collapses, s);
    add_tally(result.vanishing, tally.vanishing, s);
    add_tally(result.turned_over, tally.turned_over, s);
    add_tally(result.turned_far, tally.turned_far, s);
    add_tally(result.without_normals, tally.without_normals, s);
    keep_larger(result.motion, tally.motion);
    keep_larger(result.turn, tally.turn);
    result.flagged += result.segments[s].flagged;
    result.normal_bytes += result.segments[s].bytes;
  }
  result.no_area.faces = count_marked(marks, kNoArea);
  result.slivers.faces = count_marked(marks, kSliver);
  result.collapses.faces = count_marked(marks, kCollapses);
  result.vanishing.faces = count_marked(marks, kVanishes);
  result.turned_over.faces = count_marked(marks, kTurnsOver);
  result.turned_far.faces = count_marked(marks, kTurnsFar);
  result.without_normals.faces = count_marked(marks, kWithoutNormal);
  return result;
}

}  // namespace chronormal
