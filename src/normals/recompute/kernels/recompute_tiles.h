/// Computes the normals of moving triangles at one t, sixteen at a time, and their sums. These functions are the inner
/// loops of NormalRecompute.
///
/// Most faces use float32 for edges and double for everything else: positions are subtracted in float32, and edges are
/// interpolated and multiplied in double. Let u = 2^-24, and let E = s|e0| + t|e1| and F be the interpolated lengths of
/// both edges. The errors are
///
///     edges       relative error of each component <= u        |error of n| <= 2 u 2/sqrt(3) E F = 2.31 u E F
///     to float32  of n, and of its multiple of length 1        2 u |n|
///     E F         <= sqrt(A B), A = s|e0|^2 + t|e1|^2 (Jensen), and B likewise
///
/// so n is within 1e-6 rad if 2.31 sqrt(A B) <= 14.7 |n|. This holds for triangles with an angle of more than 9 degrees
/// at their first corner that do not shrink much during the segment. All others are *thin*, and are recomputed from
/// exact edges, entirely in double:
///
///     n           in double: edges from exact differences         |error of n| <= 20 2^-53 E F
///     unit        in double, and rounded to float32 at the end    2^-24
///
/// Both errors are small enough if the error of n is at most 2^-23 |n|, that is, if A B <= 2^50 |n|^2. All other faces
/// are *doubtful*. They are left to the caller, which examines them one by one.
#ifndef CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RECOMPUTE_TILES_H_
#define CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RECOMPUTE_TILES_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

/// The largest A B / |n|^2 of a triangle that is not thin (see the top of this file). The value 40 follows from 2.31
/// sqrt(40) <= 14.7.
inline constexpr float kMostProduct = 40;

/// Triangles as the kernels read them. Positions are either packed, or paired, with both ends of each vertex side by
/// side as x0 y0 z0 _ x1 y1 z1 _.
struct MovingTriangles {
  const std::uint32_t* corners = nullptr;  ///< the vertices of the three corners of each face
  std::size_t face_count = 0;
  const float* from = nullptr;
  const float* to = nullptr;  ///< equal to from + 4 if positions are paired
  std::size_t vertex_count = 0;
  bool is_paired = false;
  /// True if neighbouring faces have neighbouring vertices, so that nothing need be prefetched.
  bool is_coherent = true;
};

/// The vector n(t) of a face, and a bound of its error: the bound is 2^-24 times `error`.
struct alignas(16) FaceNormal {
  float x, y, z, error;
};

/// The largest A B / |n|^2 for which double is precise enough (see the top of this file). The remaining error of n is
/// below kThinError sqrt(A B), in units of 2^-24.
inline constexpr float kMaxThinProduct = 0x1p50f, kThinError = 0x1p-24f;

/// The normals of faces in a ring: the normal of face f is normals[f & mask].
struct NormalWindow {
  const FaceNormal* normals = nullptr;
  std::size_t mask = 0;
  bool fetch = false;  ///< true if the normals are scattered in memory, and have to be prefetched
};

/// Writes the unit normals of a range of faces. Writes to `doubtful` the places in the range whose normals are not
/// reliable, and returns their number. If `stream` is true, and the result is packed and aligned to 64 bytes, the
/// result bypasses the caches. Preconditions: faces.count > 0; result has faces.count elements, and doubtful has room
/// for as many.
std::size_t recompute_unit_normals(const MovingTriangles& triangles, IndexRange faces, const LocalTime& t,
                                   VectorView<float> result, bool stream, std::uint32_t* doubtful) noexcept;

/// Writes the normals of a range of faces like recompute_unit_normals(), but with their lengths and error bounds.
std::size_t recompute_face_normals(const MovingTriangles& triangles, IndexRange faces, const LocalTime& t,
                                   FaceNormal* result, std::uint32_t* doubtful) noexcept;

/// Adds up the normals around each element in the order of groups.faces(), and writes unit normals. An element is
/// doubtful if its faces cancel, or if its sum is (0, 0, 0). Preconditions: elements.count > 0; result has
/// elements.count elements, and doubtful has room for as many.
std::size_t recompute_group_normals(const NormalGroups& groups, IndexRange elements, const NormalWindow& window,
                                    VectorView<float> result, bool stream, std::uint32_t* doubtful) noexcept;

/// Returns the range from the smallest to the largest of some values.
[[nodiscard]] IndexRange range_of(std::span<const std::uint32_t> values) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RECOMPUTE_TILES_H_
