// Draws cubics through keyframes, and cuts them into straight pieces.
//
// The bound of the angle between normals is in motion/piece_bounds.h. Let s run from 0 to 1 over a piece. On a cubic,
// an edge differs from its chord by p s (1 - s), where p is linear in s, from -(2 e''(0) + e''(1)) / 6 to
// -(e''(0) + 2 e''(1)) / 6. Here e is the edge on the curves, which is a difference of two cubics, and e'' is its
// second derivative by s. To see this, note that p s (1 - s) and the difference of cubic and chord are cubics that
// vanish at s = 0 and 1 and have the same second derivatives.
#include "chronormal/motion/paths.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "chronormal/core/polynomial.h"
#include "chronormal/core/views.h"
#include "core/blocks.h"
#include "core/charconv.h"
#include "core/portable_math.h"
#include "core/rounding.h"
#include "motion/piece_bounds.h"

namespace chronormal {
namespace {

constexpr std::size_t kBlock = 1024;  // number of faces or vertices in a block

Error wrong_path(std::string message) { return Error{ErrorCode::kUsage, "", std::move(message)}; }

VectorView<const float> packed(const std::vector<float>& numbers) {
  return VectorView<const float>::packed(std::span(numbers));
}

// Returns the velocities that a keyframe stores and that this kind of path uses. The result is empty if velocities must
// be computed from positions.
const std::vector<float>& given_velocities(const Motion::Keyframe& keyframe, PathKind kind) noexcept {
  static const std::vector<float> kNone;
  if (kind == PathKind::kLinear) return kNone;
  return kind == PathKind::kHermite && !keyframe.velocities.empty() ? keyframe.velocities : keyframe.end_velocities;
}

std::vector<float> velocities_at(std::span<const Motion::Keyframe* const> keys, std::size_t i, PathKind kind) {
  if (const std::vector<float>& given = given_velocities(*keys[i], kind); !given.empty()) return given;
  std::vector<double> times;
  for (const Motion::Keyframe* key : keys) times.push_back(key->time);
  const VelocityShares velocity = velocity_shares(times, i);
  std::vector<std::span<const float>> positions;
  for (std::size_t k = 0; k < velocity.share.size(); ++k) positions.emplace_back(keys[velocity.first + k]->positions);
  return velocity.velocities(positions);
}

std::vector<const Motion::Keyframe*> pointers_to(const std::vector<Motion::Keyframe>& keyframes) {
  std::vector<const Motion::Keyframe*> keys;
  keys.reserve(keyframes.size());
  for (const Motion::Keyframe& keyframe : keyframes) keys.push_back(&keyframe);
  return keys;
}

// Makes a stream hold the keyframes that determine the cubics of a segment: both ends of the segment and one more
// keyframe on each side. In the first and the last segment, only one side has more keyframes, and two keyframes of this
// side are held.
Status hold_cubics(MotionStream& stream, std::size_t segment) {
  const std::size_t end = stream.motion().keyframes.size() - 1;
  const std::size_t before = segment - std::min<std::size_t>(segment, 1);
  return stream.hold(std::min(before, end - std::min<std::size_t>(end, 3)),
                     std::min(std::max<std::size_t>(segment + 2, 3), end));
}

struct BendSums {
  double bent = 0, way = 0;
};

// Adds the contribution of keyframe `at` to the two sums that bend_of() divides. Its neighbours are the keyframes
// `every` before and after it. Precondition: the stream holds these three keyframes.
void add_bend(const Motion& motion, std::size_t at, std::size_t every, BendSums& sums) {
  const Motion::Keyframe &from = motion.keyframes[at - every], &middle = motion.keyframes[at],
                         &to = motion.keyframes[at + every];
  // The keyframes may be unevenly spaced in time, so the middle keyframe is compared with the point at its own time on
  // the straight line between its two neighbours.
  const double part = (middle.time - from.time) / (to.time - from.time);
  const auto before = packed(from.positions), here = packed(middle.positions), after = packed(to.positions);
  for (std::size_t v = 0; v < here.count; ++v) {
    const Vec3d p = to_double(before[v]), q = to_double(here[v]), r = to_double(after[v]);
    // If the time steps are equal, the second difference is twice the distance of q from the middle between p and r.
    sums.bent += 2 * length(q - ((1 - part) * p + part * r));
    sums.way += length(q - p) + length(r - q);
  }
}

// Decides, for each face of a segment on cubics, if a number of straight pieces is enough to keep the normal within an
// angle, which is given by its sine.
class PieceBounds {
 public:
  PieceBounds(const Topology& topology, const CubicSegment& cubics, double sine)
      : topology_(topology), cubics_(cubics), sine_(sine) {}

  // Returns the faces for which `pieces` straight pieces are not enough, in their order. If `faces` is nullptr, all
  // faces are tried.
  [[nodiscard]] std::vector<std::uint32_t> not_within(const std::vector<std::uint32_t>* faces,
                                                      std::size_t pieces) const {
    const std::size_t count = faces != nullptr ? faces->size() : topology_.face_count();
    std::vector<std::vector<std::uint32_t>> of_blocks(block_count(count, kBlock));
    numbered_blocks(count, kBlock, [&](std::size_t b, std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        const std::uint32_t f = faces != nullptr ? (*faces)[i] : static_cast<std::uint32_t>(i);
        if (!is_within(f, pieces)) of_blocks[b].push_back(f);
      }
    });
    std::vector<std::uint32_t> all;
    for (const auto& of_block : of_blocks) all.insert(all.end(), of_block.begin(), of_block.end());
    return all;
  }

 private:
  [[nodiscard]] bool is_within(std::uint32_t f, std::size_t pieces) const {
    const double step = 1 / static_cast<double>(pieces);
    for (std::size_t i = 0; i < pieces; ++i) {
      if (!is_within(topology_.face(f), static_cast<double>(i) * step, static_cast<double>(i + 1) * step)) return false;
    }
    return true;
  }

  [[nodiscard]] bool is_within(std::span<const std::uint32_t> face, double start, double end) const {
    return internal::is_within(
        face.size(), [&](std::size_t c) { return edge(face[0], face[c], start, end); }, sine_);
  }

  [[nodiscard]] PieceEdge edge(std::uint32_t a, std::uint32_t b, double start, double end) const {
    Bernstein<Vec3d, 3> e;
    double size = 0;  // the largest absolute coordinate of the control points of both cubics
    for (std::size_t k = 0; k < e.size(); ++k) {
      const Vec3d &p = cubics_.control[k][a], &q = cubics_.control[k][b];
      e[k] = q - p;
      size = std::max({size, max_abs(p), max_abs(q)});
    }
    const Vec3d first = 6 * ((e[0] - e[1]) + (e[2] - e[1])), last = 6 * ((e[1] - e[2]) + (e[3] - e[2]));
    const double share = (end - start) * (end - start) / 6;
    const Vec3d here = share * lerp(first, last, start), there = share * lerp(first, last, end);
    return {{evaluate(e, start), evaluate(e, end)},
            {-1.0 * (2 * here + there), -1.0 * (here + 2 * there)},
            0,
            edge_rounding(size)};
  }

  const Topology& topology_;
  const CubicSegment& cubics_;
  double sine_;
};

// A source of the keyframes at the ends of straight pieces. The positions of these keyframes are computed from the
// keyframes of the original stream, which are read when they are needed.
struct Cutter {
  MotionStream source;
  PathKind kind;
  std::vector<std::size_t> first;  // the first keyframe of each segment, and the last keyframe of the motion
  std::size_t segment = static_cast<std::size_t>(-1);
  CubicSegment cubics = {};  // the cubics of `segment`

  Status enter(std::size_t s) {
    if (segment == s) return Success{};
    if (Status status = hold_cubics(source, s); !status) return status;
    cubics = cubic_segment(pointers_to(source.motion().keyframes), s, kind);
    segment = s;
    return Success{};
  }

  Status write(std::size_t keyframe, std::span<float> result) {
    const auto after = std::upper_bound(first.begin() + 1, first.end() - 1, keyframe);
    const auto s = static_cast<std::size_t>(after - first.begin()) - 1;
    if (Status status = enter(s); !status) return status;
    const double t = static_cast<double>(keyframe - first[s]) / static_cast<double>(first[s + 1] - first[s]);
    const std::vector<float> positions = cubics.positions(t);
    const auto outside = std::find_if_not(positions.begin(), positions.end(), [](float x) { return std::isfinite(x); });
    if (outside != positions.end())
      return wrong_path("this path moves vertex " + std::to_string((outside - positions.begin()) / 3) +
                        " so far that float32 cannot hold its position; choose another --path");
    std::copy(positions.begin(), positions.end(), result.begin());
    return Success{};
  }
};

// Appends the keyframes at which a segment is cut into `count` pieces, without positions and without the last keyframe.
// Takes fewer pieces than `count` if the times of the keyframes would not ascend.
std::size_t append_pieces(const Motion::Keyframe& from, const Motion::Keyframe& to, std::size_t count, Motion& result) {
  const auto time = [&](std::size_t i) {
    const double t = static_cast<double>(i) / static_cast<double>(count);
    return i == 0 ? from.time : i == count ? to.time : (1 - t) * from.time + t * to.time;
  };
  const auto ascend = [&] {
    for (std::size_t i = 0; i < count; ++i)
      if (!(time(i) < time(i + 1))) return false;
    return true;
  };
  while (count > 1 && !ascend()) count /= 2;
  for (std::size_t i = 0; i < count; ++i) result.keyframes.push_back({{}, time(i), i == 0 ? from.name : std::string()});
  return count;
}

}  // namespace

std::string_view path_name(PathKind kind) noexcept {
  return kind == PathKind::kLinear ? "linear" : kind == PathKind::kCatmullRom ? "catmull-rom" : "hermite";
}

Result<Path> make_path(std::string_view text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string_view name = text.substr(0, colon);
  for (const PathKind kind : {PathKind::kLinear, PathKind::kCatmullRom, PathKind::kHermite}) {
    if (name != path_name(kind)) continue;
    Path path{kind};
    if (colon == text.size()) return path;
    const char* const end = text.data() + text.size();
    const auto [last, code] = from_chars(text.data() + colon + 1, end, path.tolerance);
    if (code != std::errc{} || last != end || !(path.tolerance > 0 && path.tolerance <= 45) || !path.is_curved())
      return wrong_path(
          std::string("'").append(text) +
          "' must be the name of a curve, a colon, and a tolerance in degrees, greater than 0 and at most 45, "
          "such as catmull-rom:0.1");
    return path;
  }
  return wrong_path(std::string("there is no path '").append(name).append("'; choose linear, catmull-rom or hermite"));
}

Status check_path(const Motion& motion, PathKind kind) {
  if (kind == PathKind::kLinear) return Success{};
  if (motion.kind != MotionKind::kSequence)
    return wrong_path(
        "curved paths are only for sequences of keyframes, since targets move vertices on straight lines; leave "
        "--path out");
  if (motion.segments.empty())
    return wrong_path("the mesh does not move, so its vertices have no path; leave --path out");
  const bool has_velocities =
      std::any_of(motion.keyframes.begin(), motion.keyframes.end(),
                  [](const Motion::Keyframe& keyframe) { return !keyframe.velocities.empty(); });
  if (kind == PathKind::kHermite && !has_velocities)
    return wrong_path(
        "hermite paths need velocities, but no keyframe has them; use catmull-rom, which computes them from the "
        "positions");
  return Success{};
}

std::vector<float> VelocityShares::velocities(std::span<const std::span<const float>> positions) const {
  assert(positions.size() == share.size());
  std::vector<float> result(positions[0].size());
  for (std::size_t c = 0; c < result.size(); ++c) {
    double sum = 0;
    for (std::size_t k = 0; k < share.size(); ++k) sum += share[k] * static_cast<double>(positions[k][c]);
    result[c] = static_cast<float>(sum);
  }
  return result;
}

// Returns the weights of the keyframes' positions in the velocity at keyframe `at`. The velocity is the derivative, at
// this keyframe, of the polynomial in Lagrange form through this keyframe and its neighbours.
VelocityShares velocity_shares(std::span<const double> times, std::size_t at) {
  const bool is_end = at == 0 || at + 1 == times.size();
  const std::size_t used = std::min<std::size_t>(is_end ? 4 : 3, times.size());
  const std::size_t first = at == 0 ? 0 : is_end ? times.size() - used : at - 1;
  const std::span<const double> nodes = times.subspan(first, used);
  const std::size_t here = at - first;
  VelocityShares result{first, std::vector<double>(used, 0.0)};
  for (std::size_t i = 0; i < used; ++i) {
    if (i == here) continue;
    const double apart = nodes[here] - nodes[i];
    result.share[here] += 1 / apart;
    result.share[i] = -1 / apart;
    for (std::size_t k = 0; k < used; ++k)
      if (k != i && k != here) result.share[i] *= (nodes[here] - nodes[k]) / (nodes[i] - nodes[k]);
  }
  return result;
}

Vec3d CubicSegment::position(std::size_t vertex, double t) const noexcept {
  return evaluate(Bernstein<Vec3d, 3>{control[0][vertex], control[1][vertex], control[2][vertex], control[3][vertex]},
                  t);
}

std::vector<float> CubicSegment::positions(double t) const {
  std::vector<float> result(3 * control[0].size());
  const auto view = VectorView<float>::packed(std::span(result));
  parallel_each(view.count, kBlock, [&](std::size_t v) { view.set(v, to_float(position(v, t))); });
  return result;
}

CubicSegment cubic_segment(std::span<const Motion::Keyframe* const> keys, std::size_t i, PathKind kind) {
  assert(i + 1 < keys.size());
  CubicSegment result;
  result.start_time = keys[i]->time;
  result.end_time = keys[i + 1]->time;
  const auto from = packed(keys[i]->positions), to = packed(keys[i + 1]->positions);
  for (auto& control : result.control) control.resize(from.count);
  std::vector<float> start, end;
  if (kind != PathKind::kLinear) {
    start = velocities_at(keys, i, kind);
    end = velocities_at(keys, i + 1, kind);
  }
  const double third = (result.end_time - result.start_time) / 3;
  for (std::size_t v = 0; v < from.count; ++v) {
    const Vec3d p = to_double(from[v]), q = to_double(to[v]);
    result.control[0][v] = p;
    result.control[1][v] = start.empty() ? lerp(p, q, 1.0 / 3) : p + third * to_double(packed(start)[v]);
    result.control[2][v] = end.empty() ? lerp(p, q, 2.0 / 3) : q - third * to_double(packed(end)[v]);
    result.control[3][v] = q;
  }
  return result;
}

Result<double> bend_of(MotionStream& stream, std::size_t every) {
  BendSums sums;
  for (std::size_t i = every; i + every < stream.motion().keyframes.size(); i += every) {
    if (const Status status = stream.hold(i - every, i + every); !status) return status.error();
    add_bend(stream.motion(), i, every, sums);
  }
  return sums.way > 0 ? sums.bent / sums.way : 0;
}

Result<VelocityFit> velocity_fit(MotionStream& stream) {
  const Motion& motion = stream.motion();
  std::vector<std::size_t> segments;
  for (std::size_t s = 0; s + 1 < motion.keyframes.size(); ++s)
    if (!motion.keyframes[s].velocities.empty() && !motion.keyframes[s + 1].velocities.empty()) segments.push_back(s);
  const std::size_t used = std::min<std::size_t>(segments.size(), 64);
  double way = 0, at_speed = 0, along = 0, weight = 0;
  for (std::size_t i = 0; i < used; ++i) {
    const std::size_t s = segments[used < 2 ? 0 : i * (segments.size() - 1) / (used - 1)];
    if (const Status status = stream.hold(s, s + 1); !status) return status.error();
    const Motion::Keyframe &from = motion.keyframes[s], &to = motion.keyframes[s + 1];
    const auto before = packed(from.positions), after = packed(to.positions);
    const auto leaving = packed(from.velocities), arriving = packed(to.velocities);
    for (std::size_t v = 0; v < before.count; ++v) {
      const Vec3d chord = to_double(after[v]) - to_double(before[v]);
      for (const Vec3d& velocity : {to_double(leaving[v]), to_double(arriving[v])}) {
        const Vec3d step = (to.time - from.time) / 2 * velocity;
        at_speed += length(step);
        along += dot(step, chord);
        weight += length(step) * length(chord);
      }
      way += length(chord);
    }
  }
  VelocityFit fit;
  if (way > 0) fit.length = at_speed / way;
  if (weight > 0) fit.direction = along / weight;
  return fit;
}

Result<CutStream> cut_into_segments(MotionStream stream, const Path& path, std::size_t most_pieces, std::size_t kept) {
  CutPath cut;
  cut.path = path;
  cut.segments = cut.pieces = stream.motion().segments.size();
  if (!path.is_curved()) return CutStream{std::move(stream), cut};
  if (const Status status = check_path(stream.motion(), path.kind); !status) return status.error();
  const auto cutter = std::make_shared<Cutter>(Cutter{std::move(stream), path.kind, {0}});
  const Motion& source = cutter->source.motion();
  Motion outline;
  outline.topology = source.topology;
  outline.body_of_vertex = source.body_of_vertex;
  const double sine = portable::sin(path.tolerance / kDegreesPerRadian);
  BendSums bend;
  double largest = 0;  // the largest absolute coordinate of all control points
  for (std::size_t s = 0; s < cut.segments; ++s) {
    if (const Status status = cutter->enter(s); !status) return status.error();
    if (s > 0) add_bend(source, s, 1, bend);
    for (const auto& control : cutter->cubics.control)
      for (const Vec3d& p : control) largest = std::max(largest, max_abs(p));
    const Pieces pieces =
        pieces_for(PieceBounds(source.topology, cutter->cubics, sine), std::max<std::size_t>(most_pieces, 1));
    cut.beyond += pieces.beyond;
    const std::size_t count = append_pieces(source.keyframes[s], source.keyframes[s + 1], pieces.count, outline);
    if (count < pieces.count) cut.beyond += source.topology.face_count() - pieces.beyond;
    cutter->first.push_back(cutter->first.back() + count);
  }
  outline.keyframes.push_back({{}, source.keyframes.back().time, source.keyframes.back().name});
  outline.connect_as_sequence();
  cut.pieces = outline.segments.size();
  cut.rounding = kFloatUnitRoundoff * largest;
  cut.bend = bend.way > 0 ? bend.bent / bend.way : 0;
  if (path.kind == PathKind::kHermite) {
    const Result<VelocityFit> fit = velocity_fit(cutter->source);
    if (!fit) return fit.error();
    cut.velocities = fit.value();
  }
  cutter->segment = static_cast<std::size_t>(-1);  // the keyframes of this segment are no longer held
  const auto read = [cutter](const Motion&, std::size_t keyframe, std::span<float> positions) {
    return cutter->write(keyframe, positions);
  };
  return CutStream{MotionStream(std::move(outline), read, kept), cut};
}

Result<CutMotion> cut_into_segments(const Motion& motion, const Path& path, std::size_t most_pieces) {
  Result<CutStream> cut = cut_into_segments(MotionStream(motion), path, most_pieces);
  if (!cut) return cut.error();
  if (const Status status = cut.value().stream.hold_all(); !status) return status.error();
  return CutMotion{cut.value().stream.motion(), cut.value().cut};
}

}  // namespace chronormal
