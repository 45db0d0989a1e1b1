#include "schemes/frames.h"

#include <array>

#include "core/portable_math.h"
#include "motion/segment_end.h"

namespace chronormal::inline internal {
namespace {

// The edges at the first corner of a face: e leads to the next corner, f to the previous corner. For a polygon, the
// edges are projected into the plane of its vector area.
struct FaceEdges {
  Vec3d e, f;
};

struct EdgeMotion {
  FaceEdges start, end;
  Vec3d e_delta;  // e at t = 1 minus e at t = 0
};

Vec3d within_plane(const Vec3d& v, const Vec3d& unit_normal) { return v - dot(v, unit_normal) * unit_normal; }

EdgeMotion edges_of(const ElementMotion& element) {
  const auto face = element.segment().topology->face(element.element());
  const auto edge = [&face](const SegmentEnd& end, std::size_t corner) { return end.edge(face[0], face[corner]); };
  const std::size_t last = face.size() - 1;
  const auto edges = [&](const SegmentEnd& end, const Vec3d& u) {
    return FaceEdges{within_plane(edge(end, 1), u), within_plane(edge(end, last), u)};
  };
  const SegmentEnd from = SegmentEnd::from(element.segment()), to = SegmentEnd::to(element.segment());
  return {edges(from, element.start().vector), edges(to, element.end().vector), edge(to, 1) - edge(from, 1)};
}

std::optional<Frame> frame_along(const Vec3d& tangent, const Vec3d& unit_normal) {
  const Vec3d t = unit(tangent);
  if (t == Vec3d{}) return std::nullopt;
  return Frame{t, cross(unit_normal, t), unit_normal};
}

std::optional<FramePair> pair_of(const std::optional<Frame>& start, const std::optional<Frame>& end) {
  if (!start || !end) return std::nullopt;
  return FramePair{*start, *end};
}

// Returns a frame turned about its own normal by an angle in radians.
Frame turned(const Frame& frame, double angle) {
  const double c = portable::cos(angle), s = portable::sin(angle);
  return {c * frame.tangent + s * frame.binormal, c * frame.binormal - s * frame.tangent, frame.normal};
}

// Turns a number into a pseudo-random number by the finaliser of SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

}  // namespace

std::optional<FramePair> matrix_frames(const ElementMotion& element) {
  if (element.start().direction != Direction::kRegular) return std::nullopt;  // M is singular
  const EdgeMotion edges = edges_of(element);
  const auto& [e0, f0] = edges.start;
  const auto& [e1, f1] = edges.end;
  const double square = dot(e0, e0);
  if (square == 0) return std::nullopt;

  // binormal0 = normal0 x tangent0 is f0 without its part along e0, so M maps binormal0 to f1 minus the same multiple
  // of e1. The paper prints tangent1 = n1 x b1, which would give a left-handed frame with b = n x t.
  const Vec3d binormal = unit(within_plane(f1 - (dot(e0, f0) / square) * e1, element.end().vector));
  if (binormal == Vec3d{}) return std::nullopt;
  const Vec3d& u1 = element.end().vector;
  return pair_of(frame_along(e0, element.start().vector), Frame{cross(binormal, u1), binormal, u1});
}

std::optional<FramePair> edge_frames(const ElementMotion& element) {
  const EdgeMotion edges = edges_of(element);
  // If an edge has length zero at an end of the segment, it is replaced by the direction in which it begins to grow, or
  // from which it has shrunk to zero.
  const Vec3d& u0 = element.start().vector;
  const Vec3d& u1 = element.end().vector;
  const Vec3d start = edges.start.e == Vec3d{} ? within_plane(edges.e_delta, u0) : edges.start.e;
  const Vec3d end = edges.end.e == Vec3d{} ? within_plane(-edges.e_delta, u1) : edges.end.e;
  return pair_of(frame_along(start, u0), frame_along(end, u1));
}

std::optional<FramePair> polar_frames(const ElementMotion& element) {
  if (element.start().direction != Direction::kRegular) return std::nullopt;  // M is singular
  const auto frames = edge_frames(element);
  if (!frames) return std::nullopt;

  // M (frames.h) maps the plane of the face at t = 0 to its plane at t = 1, and u0 to u1. Therefore the rotation in the
  // polar decomposition of M is that of the 2 x 2 map between the planes. Over the edge frames that map is upper
  // triangular, S = [s11 s12; 0 s22], and the rotation factor of S turns by atan2(s21 - s12, s11 + s22). The
  // determinant of S is not negative.
  const EdgeMotion edges = edges_of(element);
  const double e0x = dot(edges.start.e, frames->at_start.tangent), f0x = dot(edges.start.f, frames->at_start.tangent);
  const double f0y = dot(edges.start.f, frames->at_start.binormal);
  const double e1x = dot(edges.end.e, frames->at_end.tangent), f1x = dot(edges.end.f, frames->at_end.tangent);
  const double f1y = dot(edges.end.f, frames->at_end.binormal);
  const double sine = e1x * f0x - f1x * e0x, cosine = e1x * f0y + f1y * e0x;
  if (sine == 0 && cosine == 0) return std::nullopt;
  return FramePair{frames->at_start, turned(frames->at_end, portable::atan2(sine, cosine))};
}

std::optional<FramePair> random_frames(const ElementMotion& element, std::uint64_t seed) {
  const auto frames = edge_frames(element);
  if (!frames) return std::nullopt;
  const std::uint64_t draw = 1 + element.element() + (static_cast<std::uint64_t>(element.segment().index) << 32);
  const double angle = 2 * kPi * std::ldexp(static_cast<double>(mixed(seed + 0x9E3779B97F4A7C15u * draw)), -64);
  return FramePair{frames->at_start, turned(frames->at_end, angle)};
}

Rotation shorter_rotation(const FramePair& frames) {
  // R = F1 F0^T is the rotation that takes F0 to F1; c0, c1, c2 are its columns.
  const Frame& a = frames.at_start;
  const Frame& b = frames.at_end;
  const auto column = [](double x, const Vec3d& u, double y, const Vec3d& v, double z, const Vec3d& w) {
    return x * u + y * v + z * w;
  };
  const Vec3d c0 = column(a.tangent.x, b.tangent, a.binormal.x, b.binormal, a.normal.x, b.normal);
  const Vec3d c1 = column(a.tangent.y, b.tangent, a.binormal.y, b.binormal, a.normal.y, b.normal);
  const Vec3d c2 = column(a.tangent.z, b.tangent, a.binormal.z, b.binormal, a.normal.z, b.normal);

  // v and w are the quaternion of R times four times its largest component, so that no digits cancel (Shepperd 1978).
  const double trace = c0.x + c1.y + c2.z;
  const std::array<double, 4> squares = {trace, c0.x, c1.y, c2.z};
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    if (squares[i] > squares[largest]) largest = i;
  }
  Vec3d v;
  double w = 0;
  switch (largest) {
    case 0:
      w = 1 + trace;
      v = {c1.z - c2.y, c2.x - c0.z, c0.y - c1.x};
      break;
    case 1:
      w = c1.z - c2.y;
      v = {1 + 2 * c0.x - trace, c0.y + c1.x, c2.x + c0.z};
      break;
    case 2:
      w = c2.x - c0.z;
      v = {c0.y + c1.x, 1 + 2 * c1.y - trace, c1.z + c2.y};
      break;
    default:
      w = c0.y - c1.x;
      v = {c2.x + c0.z, c1.z + c2.y, 1 + 2 * c2.z - trace};
      break;
  }
  // The quaternions q and -q are the same rotation; the quaternion with w >= 0 gives the shorter arc. At exactly half a
  // turn w is 0, and the sign of v decides, so that the choice is always the same.
  if (w < 0) {
    w = -w;
    v = -v;
  }
  const double size = length(v);
  if (size <= 1e-15 * w) return {};
  return {(1 / size) * v, 2 * portable::atan2(size, w)};
}

Arc shorter_arc(const FramePair& frames) {
  const Rotation rotation = shorter_rotation(frames);
  if (rotation.angle == 0) return {{}, frames.at_start.normal, {}, 0};
  return arc_about(rotation.axis, frames.at_start.normal, rotation.angle);
}

}  // namespace chronormal::inline internal
