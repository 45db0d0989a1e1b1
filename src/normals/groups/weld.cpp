// Finds vertices that coincide in all keyframes. The vertices are sorted by their positions in one keyframe after the
// other. If there are many vertices, they are first divided by a hash of the position, on all cores.
#include "normals/groups/weld.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/bits.h"
#include "core/blocks.h"
#include "normals/groups/sides.h"

namespace chronormal {
namespace {

// Returns a number that is equal for equal coordinates, also for -0 and 0.
std::uint32_t key(float coordinate) { return bit_cast<std::uint32_t>(coordinate + 0.0F); }

// The position of a vertex as three keys, which can be compared. The keys need no body: vertices of different bodies
// (Motion::body_of_vertex) are separated before their positions are compared.
using PlaceKey = std::array<std::uint32_t, 3>;

PlaceKey place_key(const Motion::Keyframe& keyframe, std::uint32_t vertex) {
  const float* const p = keyframe.positions.data() + 3 * std::size_t{vertex};
  return {key(p[0]), key(p[1]), key(p[2])};
}

using Coinciding = std::span<std::uint32_t>;

// Sorts vertices by their positions at a keyframe, and vertices at the same position by their numbers. Appends to
// `found` the sets of vertices that share a position.
void split_by_place(const Motion::Keyframe& keyframe, Coinciding vertices, std::vector<Coinciding>& found) {
  std::sort(vertices.begin(), vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
    const PlaceKey p = place_key(keyframe, a), q = place_key(keyframe, b);
    return p != q ? p < q : a < b;
  });
  for (std::size_t first = 0, end = 0; first < vertices.size(); first = end) {
    const PlaceKey place = place_key(keyframe, vertices[first]);
    for (end = first + 1; end < vertices.size() && place_key(keyframe, vertices[end]) == place;) ++end;
    if (end - first > 1) found.push_back(vertices.subspan(first, end - first));
  }
}

// A vertex and a hash of its position. Vertices at one position have the same hash, and few other vertices have that
// hash.
struct Hashed {
  std::uint32_t hash = 0, vertex = 0;

  friend bool operator<(const Hashed& a, const Hashed& b) {
    return a.hash != b.hash ? a.hash < b.hash : a.vertex < b.vertex;
  }
};

std::uint32_t hash_of(const PlaceKey& place) {
  std::uint64_t hash = 0;
  for (const std::uint32_t coordinate : place) {
    hash = (hash ^ coordinate) * 0x9E3779B97F4A7C15U;
    hash ^= hash >> 29;
  }
  return static_cast<std::uint32_t>(hash >> 32);
}

// Divides many vertices by their positions. The first bits of a hash determine the bucket of a vertex, and each bucket
// is sorted separately.
void split_many_by_place(const Motion::Keyframe& keyframe, Coinciding vertices, std::vector<Coinciding>& found) {
  constexpr std::size_t kBuckets = 1024, kShift = 22, kHashedBlock = std::size_t{1} << 14;
  std::vector<Hashed> hashed(vertices.size()), in_buckets(vertices.size());
  parallel_each(vertices.size(), kHashedBlock, [&](std::size_t i) {
    hashed[i] = {hash_of(place_key(keyframe, vertices[i])), vertices[i]};
  });
  std::array<std::size_t, kBuckets + 1> ends{};
  for (const Hashed& each : hashed) ++ends[(each.hash >> kShift) + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  const std::array<std::size_t, kBuckets + 1> starts = ends;
  for (const Hashed& each : hashed) in_buckets[ends[each.hash >> kShift]++] = each;
  parallel_for(kBuckets, [&](std::size_t b) {
    const auto at = [&in_buckets](std::size_t i) { return in_buckets.begin() + static_cast<std::ptrdiff_t>(i); };
    std::sort(at(starts[b]), at(starts[b + 1]));
    for (std::size_t i = starts[b]; i < starts[b + 1]; ++i) vertices[i] = in_buckets[i].vertex;
  });
  for (std::size_t first = 0, end = 0; first < vertices.size(); first = end) {
    for (end = first + 1; end < vertices.size() && in_buckets[end].hash == in_buckets[first].hash;) ++end;
    if (end - first > 1) split_by_place(keyframe, vertices.subspan(first, end - first), found);
  }
}

// Returns the points of all vertices. `found` has the sets of vertices that coincide.
Points points_of(std::size_t vertex_count, std::span<const Coinciding> found) {
  Points points = separate_points(vertex_count);
  // Until points are numbered below, entry v is the first vertex at the point of vertex v.
  std::vector<std::uint32_t>& of_vertex = points.point_of_vertex;
  for (const Coinciding vertices : found) {
    for (const std::uint32_t vertex : vertices) of_vertex[vertex] = vertices.front();
  }
  points.count = 0;
  for (std::size_t v = 0; v < vertex_count; ++v)
    of_vertex[v] = of_vertex[v] == v ? static_cast<std::uint32_t>(points.count++) : of_vertex[of_vertex[v]];
  return points;
}

}  // namespace

Points separate_points(std::size_t vertex_count) {
  Points points{std::vector<std::uint32_t>(vertex_count), vertex_count};
  std::iota(points.point_of_vertex.begin(), points.point_of_vertex.end(), 0U);
  return points;
}

inline namespace internal {

Result<WeldedPoints> weld_from_start(MotionStream& stream, bool keeps_sides_apart) {
  constexpr std::size_t kMany = std::size_t{1} << 14;
  const Motion& motion = stream.motion();
  std::vector<std::uint32_t> order = separate_points(motion.topology.vertex_count()).point_of_vertex;
  // Each list has the vertices that coincide in all keyframes so far. Each further keyframe may divide lists.
  std::vector<Coinciding> found = {order}, before;
  if (const auto& bodies = motion.body_of_vertex; !bodies.empty()) {
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return bodies[a] < bodies[b]; });
    found.clear();
    for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
      for (end = first + 1; end < order.size() && bodies[order[end]] == bodies[order[first]];) ++end;
      if (end - first > 1) found.push_back(Coinciding(order).subspan(first, end - first));
    }
  }
  WeldedPoints result;
  for (std::size_t k = 0; k < motion.keyframes.size() && !found.empty(); ++k) {
    if (Status status = stream.hold(k, k); !status) return status.error();
    before.swap(found);
    found.clear();
    for (const Coinciding vertices : before) {
      if (vertices.size() < kMany)
        split_by_place(motion.keyframes[k], vertices, found);
      else
        split_many_by_place(motion.keyframes[k], vertices, found);
    }
    if (k == 0) result.at_start = points_of(order.size(), found);
  }
  if (result.at_start.point_of_vertex.empty()) result.at_start = points_of(order.size(), {});
  result.always = points_of(order.size(), found);
  if (!keeps_sides_apart) return result;
  keep_sides_apart(motion.topology, result.at_start);
  keep_sides_apart(motion.topology, result.always);
  return result;
}

}  // namespace internal

Result<Points> weld_coincident(MotionStream& stream) {
  Result<WeldedPoints> welded = weld_from_start(stream);
  if (!welded) return welded.error();
  return std::move(welded).value().always;
}

Points weld_coincident(const Motion& motion) {
  MotionStream stream(motion);
  return weld_coincident(stream).value();
}

}  // namespace chronormal
