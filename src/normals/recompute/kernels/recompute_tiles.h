/// Normals of moving triangles at one t, sixteen at a time, and their sums: the inner loops of NormalRecompute.
///
/// Most faces use edges in float32 and double after that: positions are subtracted in float32, edges are interpolated
/// and multiplied in double. With u = 2^-24, and E, F the interpolated lengths of both edges, s|e0| + t|e1|,
///
///     edges       each component within u of itself            |error of n| <= 2 u 2/sqrt(3) E F = 2.31 u E F
///     to float32  of n, and of its multiple of length 1        2 u |n|
///     E F         <= sqrt(A B), A = s|e0|^2 + t|e1|^2 (Jensen), and B likewise
///
/// so n is within 1e-6 rad if 2.31 sqrt(A B) <= 14.7 |n|. This holds for triangles with more than 9 degrees at their
/// first corner that do not shrink much on their way. *Thin* triangles are recomputed from exact edges, entirely in
/// double:
///
///     n           in double: edges from exact differences         |error of n| <= 20 2^-53 E F
///     unit        in double, and rounded to float32 at the end    2^-24
///
/// Both errors are small enough if the error of n is at most 2^-23 |n|, that is, if A B <= 2^50 |n|^2. Other faces are
/// *doubtful*, and left to the caller, which examines them one by one.
#ifndef CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RECOMPUTE_TILES_H_
#define CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RECOMPUTE_TILES_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

/// The largest A B of a triangle that is not thin, in units of |n|^2: 2.31 sqrt(40) <= 14.7.
inline constexpr float kMostProduct = 40;

/// Triangles as the kernels read them. Positions are packed, or paired as x0 y0 z0 _ x1 y1 z1 _ for each vertex.
struct MovingTriangles {
  const std::uint32_t* corners = nullptr;  ///< three for each face
  std::size_t face_count = 0;
  const float* from = nullptr;
  const float* to = nullptr;  ///< paired: from + 4
  std::size_t vertex_count = 0;
  bool is_paired = false;
  bool is_coherent = true;  ///< neighbouring faces have neighbouring vertices, so nothing is prefetched
};

/// The vector n(t) of a face, and a bound of its error, which is 2^-24 `error`.
struct alignas(16) FaceNormal {
  float x, y, z, error;
};

/// The largest A B, in units of |n|^2, for which double is precise enough. The error that remains is below kThinError
/// sqrt(A B), in units of 2^-24.
inline constexpr float kMaxThinProduct = 0x1p50f, kThinError = 0x1p-24f;

/// The place of the normals of faces: the normal of face f is normals[f & mask].
struct NormalWindow {
  const FaceNormal* normals = nullptr;
  std::size_t mask = 0;
  bool fetch = false;  ///< true if the normals are scattered in memory, and have to be prefetched
};

/// Writes the unit normals of a range of faces, and into `doubtful` the places in the range whose normals are not
/// reliable. Returns the number of doubtful places. `stream` bypasses the caches if the result is packed and aligned to
/// 64 bytes. faces.count > 0; result must have faces.count elements, and doubtful must have as much room
std::size_t recompute_unit_normals(const MovingTriangles& triangles, IndexRange faces, const LocalTime& t,
                                   VectorView<float> result, bool stream, std::uint32_t* doubtful) noexcept;

/// Writes the normals of a range of faces in the same way, but with their lengths and errors.
std::size_t recompute_face_normals(const MovingTriangles& triangles, IndexRange faces, const LocalTime& t,
                                   FaceNormal* result, std::uint32_t* doubtful) noexcept;

/// Adds up the normals around each element in the order of groups.faces(), and writes unit normals. Elements are
/// doubtful if their faces cancel, or if the sum is (0, 0, 0). elements.count > 0; result must have elements.count
/// elements, and doubtful must have as much room
std::size_t recompute_group_normals(const NormalGroups& groups, IndexRange elements, const NormalWindow& window,
                                    VectorView<float> result, bool stream, std::uint32_t* doubtful) noexcept;

/// Returns the range from the smallest to the largest of some values.
[[nodiscard]] IndexRange range_of(std::span<const std::uint32_t> values) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_RECOMPUTE_KERNELS_RECOMPUTE_TILES_H_
