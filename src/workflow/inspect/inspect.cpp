// Examines every segment of a motion for causes of wrong normals. Works block by block, in waves of segments, and adds
// up the findings in order. A wave examines vertices first, because the size below which a face counts as small depends
// on the largest coordinates of the keyframe. Then a quick test of sixteen faces at a time
// (analysis/signs/kernels/face_glance.h) finds the few faces that need the full test.
#include "chronormal/workflow/inspect.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "analysis/signs/kernels/face_glance.h"
#include "analysis/signs/near_collapse.h"
#include "chronormal/analysis/signs.h"
#include "chronormal/core/parallel.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "core/blocks.h"
#include "core/portable_math.h"
#include "motion/segment_end.h"
#include "motion/triangles.h"
#include "normals/curves/curve_count.h"
#include "normals/groups/weld.h"
#include "workflow/segments/segment_run.h"

namespace chronormal {
namespace {

// A factor that bounds the rounding error of a normal, relative to the largest coordinate times the longer edge.
// Rounding to float32 moves a point by up to sqrt(3) times half a unit in the last place. An edge has two such points
// at its ends, and a normal is the cross product of two such edges.
constexpr double kRounding = 4 * 1.7320508075688772 * 0x1p-24;

// The numbers of faces or vertices in a block, and of blocks for each thread in a wave. A block is so small that its
// control normals stay in the second-level cache. A wave has one segment, or enough small segments to keep all threads
// busy.
constexpr std::size_t kBlock = 8 * kCountedTogether, kBlocksPerThread = 4;

// The problems that a face can have, one bit for each.
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

// The number of faces with one problem at a keyframe or in a segment, and the first of these faces.
struct FaceTally {
  std::size_t count = 0, first_face = 0;
  double first_t = 0;

  // Adds a face. Faces must be added in ascending order.
  void add(std::size_t face, Mark mark, FaceMarks& marks, double t = 0) {
    if (count++ == 0) {
      first_face = face;
      first_t = t;
    }
    marks[face].fetch_or(mark, std::memory_order_relaxed);
  }
  // Adds the tally of faces that follow these faces in the same keyframe or segment.
  void add(const FaceTally& next) {
    if (count == 0) {
      first_face = next.first_face;
      first_t = next.first_t;
    }
    count += next.count;
  }
};

// The bounding box of the vertices that were added.
struct Box {
  bool is_empty = true;
  Vec3f low, high;

  void add(const Box& next) {
    if (next.is_empty) return;
    if (is_empty) *this = next;
    low = lowest(low, next.low);
    high = highest(high, next.high);
  }
  static Vec3f lowest(const Vec3f& a, const Vec3f& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
  }
  static Vec3f highest(const Vec3f& a, const Vec3f& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
  }
  // Returns the largest absolute coordinate of a point in the box.
  [[nodiscard]] double most() const { return maximum_number(max_abs(to_double(low)), max_abs(to_double(high))); }
};

// The findings about vertices in one block of a segment, or in several blocks together.
struct VertexTally {
  Box from, to;  // boxes of those keyframes at both ends that this segment judges
  Largest motion;
  std::size_t moved = 0;

  void add(const VertexTally& next) {
    from.add(next.from);
    to.add(next.to);
    if (next.motion.value > motion.value) motion = next.motion;
    moved += next.moved;
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

// The findings about faces in one block of a segment, or in several blocks together.
struct SegmentTally {
  KeyframeTally from, to;  // results of those keyframes at both ends that this segment judges
  FaceTally collapses, vanishing, turned_over, turned_far, without_normals;
  Largest turn;
  CurveCount curves;

  void add(const SegmentTally& next) {
    from.add(next.from);
    to.add(next.to);
    collapses.add(next.collapses);
    vanishing.add(next.vanishing);
    turned_over.add(next.turned_over);
    turned_far.add(next.turned_far);
    without_normals.add(next.without_normals);
    keep_larger(turn, next.turn);
    curves.add(next.curves);
  }
  [[nodiscard]] SegmentInspection inspection(const VertexTally& vertices, std::size_t faces) const {
    SegmentInspection result;
    result.moved_vertices = vertices.moved;
    result.motion = vertices.motion;
    result.turn = turn;
    result.turned_far = turned_far.count;
    result.collapses = collapses.count;
    result.vanishing = vanishing.count;
    result.turned_over = turned_over.count;
    result.without_normals = without_normals.count;
    result.flagged = curves.flagged;
    result.bytes = curves.bytes(faces);
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

// Returns a bound of the length that a face's normal can get from the rounding errors of its positions alone.
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

// Judges a face at one keyframe by its normal. `most` is the largest coordinate of the keyframe.
void inspect_at_keyframe(std::span<const std::uint32_t> face, std::size_t f, VectorView<const float> positions,
                         double most, const Vec3d& normal, KeyframeTally& tally, FaceMarks& marks) {
  // A bound of the rounding error of any triangle's normal at this keyframe.
  const double largest_rounding = kRounding * most * 2 * most;
  const double size = max_abs(normal);
  if (size > static_cast<double>(face.size() - 2) * largest_rounding) return;
  if (size == 0)
    tally.no_area.add(f, kNoArea, marks);
  else if (size <= rounding_of(face, positions))
    tally.slivers.add(f, kSliver, marks);
}

Box box_of(VectorView<const float> positions, IndexRange vertices) {
  if (vertices.count == 0) return {};
  Vec3f low = positions[vertices.first], high = low;
  for (std::size_t v = vertices.first + 1; v < vertices.end(); ++v) {
    low = Box::lowest(low, positions[v]);
    high = Box::highest(high, positions[v]);
  }
  return {false, low, high};
}

void inspect_vertices(const Segment& segment, IndexRange vertices, VertexTally& tally) {
  const SegmentEnd from = SegmentEnd::from(segment), to = SegmentEnd::to(segment);
  double most_of_square = 0;  // a vector with a smaller squared length is shorter than the longest vector so far
  for (std::size_t v = vertices.first; v < vertices.end(); ++v) {
    const Vec3d step = to.way_from(from, v, v);
    if (max_abs(step) == 0) continue;
    ++tally.moved;
    if (dot(step, step) < most_of_square) continue;
    if (const double distance = length(step); distance > tally.motion.value) {
      tally.motion = {distance, segment.index, v};
      most_of_square = distance * distance * (1 - 1e-12);
    }
  }
}

// Returns the factor s of a quick test that an angle is small. If a.b > 0 and (a.b)^2 > s |a|^2 |b|^2, the angle
// between a and b is certainly smaller than `angle`, in radians.
double square_of_cosine_above(double angle) {
  const double cosine = angle < std::numbers::pi / 2 ? portable::cos(angle) : 0;
  return cosine * cosine * (1 + 1e-12);
}

// Examines face f in a segment. most_of_square is square_of_cosine_above() of the largest turn among faces that were
// examined before. If face f turns by less, the exact angle is not computed.
void inspect_face(const Segment& segment, std::size_t f, const ControlNormals& c, double& most_of_square,
                  FaceMarks& marks, SegmentTally& tally) {
  const double along = dot(c.n0, c.n1);
  const bool turns_less = along > 0 && along * along > most_of_square * (dot(c.n0, c.n0) * dot(c.n1, c.n1));
  if (!turns_less) {
    if (const double angle = angle_between(c.n0, c.n1); angle > tally.turn.value) {
      tally.turn = {angle, segment.index, f};
      most_of_square = square_of_cosine_above(angle);
    }
  }
  if (along < 0) tally.turned_far.add(f, kTurnsFar, marks);
  if (is_far_from_collapse(c)) return;
  const Collapses exact = find_collapses(segment, f, c);
  const auto zero = std::find_if(exact.instants().begin(), exact.instants().end(), [](const Collapse& each) {
    // Finds a collapse that is not at an end of the segment, so that there are normals before and after the collapse.
    return each.before != Vec3d{} && each.after != Vec3d{};
  });
  if (zero != exact.instants().end()) tally.vanishing.add(f, kVanishes, marks, zero->upper);
  if (exact.always) tally.without_normals.add(f, kWithoutNormal, marks);
  const NearCollapses collapses = find_near_collapses(c);
  if (collapses.count == 0) return;
  tally.collapses.add(f, kCollapses, marks, collapses.at[0].t);
  const auto end = collapses.at.begin() + static_cast<std::ptrdiff_t>(collapses.count);
  const auto over = std::find_if(collapses.at.begin(), end, [](const NearCollapse& each) { return each.turns_over; });
  if (over != end) tally.turned_over.add(f, kTurnsOver, marks, over->t);
}

// The largest coordinates of the keyframes at both ends of a segment. A keyframe has no value if another segment judges
// this keyframe.
struct JudgedEnds {
  std::optional<double> from, to;
};

void inspect_faces(const Segment& segment, IndexRange faces, const JudgedEnds& judged, FaceMarks& marks,
                   SegmentTally& tally) {
  const Topology& topology = *segment.topology;
  std::vector<EdgedTile> tiles(block_count(faces.count, kTile));
  tally.curves = count_curves(segment, faces, tiles);
  GlanceLimits limits{judged.from ? kRounding * *judged.from : -1, judged.to ? kRounding * *judged.to : -1,
                      square_of_cosine_above(0)};
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    std::uint32_t unusual = unusual_faces(tiles[i], limits);
    for (; unusual != 0; unusual &= unusual - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(unusual));
      const std::size_t f = faces.first + i * kTile + lane;
      if (f >= faces.end()) break;
      const ControlNormals c = element_of(tiles[i].normals, lane);
      if (judged.from) inspect_at_keyframe(topology.face(f), f, segment.from, *judged.from, c.n0, tally.from, marks);
      if (judged.to) inspect_at_keyframe(topology.face(f), f, segment.to, *judged.to, c.n1, tally.to, marks);
      inspect_face(segment, f, c, limits.square_of_cosine, marks, tally);
    }
  }
}

// Judges faces at a keyframe that is not at an end of any segment.
void inspect_still_faces(const Segment& segment, IndexRange faces, double most, FaceMarks& marks, SegmentTally& tally) {
  std::vector<ControlNormals> normals(faces.count);
  face_control_normals(segment, faces, normals);
  for (std::size_t f = faces.first; f < faces.end(); ++f)
    inspect_at_keyframe(segment.topology->face(f), f, segment.from, most, normals[f - faces.first].n0, tally.from,
                        marks);
}

// Returns the range of faces or vertices in the block with this number, if there are `count` faces or vertices in all.
// The range is empty for numbers beyond the last block.
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

  const Result<WeldedPoints> welded = weld_from_start(stream);
  if (!welded) return welded.error();
  result.doubled = find_copies(welded.value().always);
  result.doubled_at_start = find_copies(welded.value().at_start);
  result.surface = survey(topology, welded.value().always);

  if (!topology.all_triangles()) {
    if (const Status held = stream.hold(0, 0); !held) return held.error();
    for (std::size_t face = 0; face < topology.face_count(); ++face) {
      if (is_fan(topology.face(face), motion.keyframes[0].positions)) continue;
      if (result.cut.count++ == 0) result.cut.first = face;
    }
  }

  // Assigns each keyframe to the first segment that begins or ends with it, so that each keyframe is judged once. A
  // keyframe without such a segment is judged as a mesh at rest.
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
  FaceMarks marks(result.faces);
  std::vector<Box> boxes(result.keyframes);
  std::vector<KeyframeTally> keyframes(result.keyframes);
  std::vector<SegmentTally> segments(segment_count);
  const std::size_t total = segment_count + still.size();
  const std::size_t blocks = block_count(std::max({result.faces, result.vertices, std::size_t{1}}), kBlock);
  const std::size_t wave = block_count(kBlocksPerThread * thread_count(), blocks);
  std::vector<VertexTally> vertex_blocks(std::min(wave, total) * blocks);
  std::vector<SegmentTally> face_blocks(std::min(wave, total) * blocks);
  // Maps an index to two keyframes. The indices of segments come first, and belong to the keyframes at both ends of the
  // segment. The indices after them belong to keyframes that no segment judges, and have the same keyframe twice.
  const auto moves = [&](std::size_t s) { return s < segment_count; };
  const auto keys_of = [&](std::size_t s) {
    return moves(s) ? motion.segments[s] : Motion::SegmentKeys{still[s - segment_count], still[s - segment_count]};
  };
  const auto segment_of = [&](std::size_t s) {
    return moves(s) ? motion.segment(s) : still_segment(topology, motion.keyframes[keys_of(s).from]);
  };
  const auto judges_from = [&](std::size_t s) { return !moves(s) || judge[keys_of(s).from] == s; };
  const auto judges_to = [&](std::size_t s) { return moves(s) && judge[keys_of(s).to] == s; };
  SegmentRun run;
  run.progress = progress;
  run.begin(total);
  const auto inspect_wave = [&](IndexRange some) -> Status {
    const std::size_t first = some.first, count = some.count;
    parallel_for(count * blocks, [&](std::size_t i) {
      const std::size_t s = first + i / blocks;
      const Segment segment = segment_of(s);
      const IndexRange vertices = block_of(i % blocks, result.vertices);
      VertexTally& tally = vertex_blocks[i] = {};
      if (judges_from(s)) tally.from = box_of(segment.from, vertices);
      if (judges_to(s)) tally.to = box_of(segment.to, vertices);
      if (moves(s)) inspect_vertices(segment, vertices, tally);
    });
    for (std::size_t i = 0; i < count; ++i) {
      VertexTally& tally = vertex_blocks[i * blocks];
      for (std::size_t b = 1; b < blocks; ++b) tally.add(vertex_blocks[i * blocks + b]);
      if (judges_from(first + i)) boxes[keys_of(first + i).from] = tally.from;
      if (judges_to(first + i)) boxes[keys_of(first + i).to] = tally.to;
    }
    parallel_for(count * blocks, [&](std::size_t i) {
      const std::size_t s = first + i / blocks;
      const Segment segment = segment_of(s);
      const IndexRange faces = block_of(i % blocks, result.faces);
      SegmentTally& tally = face_blocks[i] = {};
      if (!moves(s)) return inspect_still_faces(segment, faces, boxes[keys_of(s).from].most(), marks, tally);
      JudgedEnds judged;
      if (judges_from(s)) judged.from = boxes[keys_of(s).from].most();
      if (judges_to(s)) judged.to = boxes[keys_of(s).to].most();
      inspect_faces(segment, faces, judged, marks, tally);
    });

    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t s = first + i;
      SegmentTally& tally = face_blocks[i * blocks];
      for (std::size_t b = 1; b < blocks; ++b) tally.add(face_blocks[i * blocks + b]);
      if (judges_from(s)) keyframes[keys_of(s).from] = tally.from;
      if (judges_to(s)) keyframes[keys_of(s).to] = tally.to;
      if (!moves(s)) continue;
      result.segments.push_back(tally.inspection(vertex_blocks[i * blocks], result.faces));
      segments[s] = tally;
    }
    return Success{};
  };
  if (const Status status = run.over(stream, keys_of, run.share(), wave, inspect_wave); !status) return status.error();
  Box box;
  for (const Box& of_keyframe : boxes) box.add(of_keyframe);
  result.low = to_double(box.low);
  result.high = to_double(box.high);
  result.diagonal = length(result.high - result.low);
  const Vec3d origin = {motion.origin[0], motion.origin[1], motion.origin[2]};
  result.low = result.low + origin;
  result.high = result.high + origin;

  // Adds the counts in order, so that the first face of each problem does not depend on the threads.
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
    keep_larger(result.motion, result.segments[s].motion);
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
