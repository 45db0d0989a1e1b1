/// The faces of a segment, for elements that share faces. A polygon of n corners belongs to n vertices. If each of
/// these vertices added up all corners again, the time would grow with the square of n. So the results for faces with
/// many corners are stored.
///
///     a polygon of 32,000 corners   computed once, and looked up by its 32,000 vertices
///     a triangle, a quadrilateral   computed for each of its corners, which costs less than looking them up
///
/// Results have the same bits as if each face were computed for every element that needs it.
#ifndef CHRONORMAL_NORMALS_CONTROL_SHARED_FACES_H_
#define CHRONORMAL_NORMALS_CONTROL_SHARED_FACES_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <new>
#include <span>

#include "chronormal/motion/motion.h"
#include "normals/control/exact_curve.h"
#include "normals/control/polygon_normals.h"

namespace chronormal::inline internal {

/// A store of values of faces with many corners. Several threads may ask for values at once. If there is no memory for
/// a value, it is not stored.
template <class Value>
class LargeFaceValues {
 public:
  [[nodiscard]] static bool are_kept_of(const Topology& topology, std::uint32_t face) noexcept {
    return topology.face(face).size() > kFewCorners;
  }
  /// Returns the value of a face: the result of make(), or the stored result of an earlier call for this face. `make`
  /// must be pure.
  template <class Make>
  [[nodiscard]] Value of(const Topology& topology, std::uint32_t face, const Make& make) const noexcept {
    if (!are_kept_of(topology, face)) return make();
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = values_.find(face); found != values_.end()) return found->second;
    }
    const Value value = make();
    try {
      const std::lock_guard lock(mutex_);
      values_.emplace(face, value);
    } catch (const std::bad_alloc&) {  // the value is not stored; the next call computes it again
    }
    return value;
  }

 private:
  // If a face has at most this many corners, computing its value costs less than looking it up.
  static constexpr std::size_t kFewCorners = 64;

  mutable std::mutex mutex_;
  mutable std::map<std::uint32_t, Value> values_;
};

/// The control normals of the faces of a segment, and exact sums of them. The positions of the segment must not change
/// during the object's lifetime. Threads: pure.
class SharedFaces {
 public:
  explicit SharedFaces(const Segment& segment) noexcept : segment_(segment) {}

  [[nodiscard]] const Segment& segment() const noexcept { return segment_; }

  [[nodiscard]] PolygonNormals control_normals(std::uint32_t face) const noexcept {
    const Topology& topology = *segment_.topology;
    return normals_.of(topology, face, [&] { return polygon_control_normals(segment_, topology.face(face)); });
  }

  /// Returns the exact curve of one face.
  [[nodiscard]] ExactCurve exact(std::uint32_t face) const noexcept {
    const Topology& topology = *segment_.topology;
    return curves_.of(topology, face, [&] { return ExactCurve::of_polygon(segment_, topology.face(face)); });
  }
  /// Returns the sum of the exact curves of several faces.
  [[nodiscard]] ExactCurve exact_sum(std::span<const std::uint32_t> faces) const noexcept {
    const auto is_large = [this](std::uint32_t f) { return curves_.are_kept_of(*segment_.topology, f); };
    if (std::none_of(faces.begin(), faces.end(), is_large)) return ExactCurve::of_faces(segment_, faces);
    ExactCurve sum = exact(faces[0]);
    for (const std::uint32_t f : faces.subspan(1)) sum.add(exact(f));
    return sum;
  }

 private:
  Segment segment_;
  LargeFaceValues<PolygonNormals> normals_;
  LargeFaceValues<ExactCurve> curves_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_SHARED_FACES_H_
