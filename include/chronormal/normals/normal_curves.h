/// Curves of normals: prepared once per segment, evaluated at any t at the speed of memory.
///
/// NormalCurves keeps the control normals of N elements in blocks of 16, each block in the fewest bytes that keep the
/// tolerance, and one after the other, so that an evaluation is one pass over memory. What a block holds depends on
/// the largest degree of its elements and on how precise they must be; in bytes for each element
///
///     degree 2   36  n0, m, n1 in float32: 16 x of n0, 16 y of n0, ...
///                20  in int16 against the largest component of the element; or each of n0, m, n1 against its own
///                    largest component, rounded up to a power of two (5 bits each): for slivers and collapsing faces
///                12  n0, n1 in 11 bits and m in 10
///     degree 1   24  n0, n1 in float32;   12 or 20  in int16, likewise
///     degree 0   12  the unit normal in float32, 16 with its length
///
/// Scales are those of the element: a direction needs none, so none is stored. Runs of less than 4 blocks join a
/// neighbour that can hold them, where both lie within the same 32 blocks.
///
/// Accuracy   The direction of every element is within `tolerance` of the exact n(t) of the positions at the
///            double t, by a bound and not by measurement (docs/theory.md, sections 5 and 13): where n(t) gets small
///            against its control normals, their rounding counts more, so each element carries a certificate of how
///            small it can get. Where float32 cannot promise 1e-6 rad the element is *flagged* and evaluated in double;
///            flagged_count() tells how many those are. Where double cannot either, curves that were made from
///            positions keep the control normals as integers, and know the direction at every t; those that were made
///            of control normals have the direction of these, and tell by uncertain_count() where even that is not
///            known.
/// Lengths    |n(t)| is kept where the tolerance is kExactTolerance, and is lost in compact curves.
/// Ownership  the curves own their memory; results go to the caller's.
/// Threads    const functions may run at the same time. On one thread and at one t they do not allocate or throw. The
///            same bits on every instruction set, compiler and number of threads.
/// Speed      results aligned to 64 bytes, packed, as planes or in four bytes, are fastest; docs/benchmarks.md.
#ifndef CHRONORMAL_NORMALS_NORMAL_CURVES_H_
#define CHRONORMAL_NORMALS_NORMAL_CURVES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

// Unit normals in four bytes, as vertex buffers of renderers hold them.
//
//     Octahedral    x: snorm16 in the low 16 bits, y: snorm16 in the high 16. The unit vector is divided by
//                   |x| + |y| + |z|, which puts it on an octahedron; the lower half is folded over the upper one
//                   (Meyer et al. 2010, "On floating-point normal vectors"). Within 7e-5 rad.
//     Rgb10A2       x, y, z: snorm10 from the lowest bits up, and 2 bits of 0: GL_INT_2_10_10_10_REV,
//                   DXGI R10G10B10A2, VK A2B10G10R10. Within 1.7e-3 rad.
//
// A component c of snorm N bits is the integer nearest to c (2^(N-1) - 1), in two's complement. (0, 0, 0), the normal
// of an element that has none, is 0 in Rgb10A2; Octahedral cannot say it, and 0 there is (0, 0, 1).

/// A separate type for each encoding, so that one cannot be taken for the other; it holds nothing but the four bytes.
struct Octahedral {
  std::uint32_t bits = 0;
  friend bool operator==(const Octahedral&, const Octahedral&) = default;
};
struct Rgb10A2 {
  std::uint32_t bits = 0;
  friend bool operator==(const Rgb10A2&, const Rgb10A2&) = default;
};

/// Encodes v, which must have length 1 or be zero. Pure.
[[nodiscard]] Octahedral encode_octahedral(const Vec3f& v) noexcept;
[[nodiscard]] Rgb10A2 encode_rgb10a2(const Vec3f& v) noexcept;

/// Decodes to length 1, except for the zero of Rgb10A2.
[[nodiscard]] Vec3f decode(Octahedral encoded) noexcept;
[[nodiscard]] Vec3f decode(Rgb10A2 encoded) noexcept;

inline namespace internal {
struct CurveData;
}

/// The accuracy that float32 promises: blocks of 36, 24 and 16 bytes, with lengths.
inline constexpr double kExactTolerance = 1e-6;  // radians
/// A good choice for shading: a twentieth of a degree. Most blocks take 12 or 20 bytes.
inline constexpr double kCompactTolerance = 1e-3;  // radians

struct CurveOptions {
  /// The largest angle, in radians, by which a unit normal may be wrong: at least kExactTolerance, at most 0.2. Values
  /// outside count as the nearer limit.
  double tolerance = kExactTolerance;
};

class NormalCurves {
 public:
  /// Creates curves of no elements.
  NormalCurves() noexcept;
  /// Curves can be moved, which leaves empty ones, but not copied.
  NormalCurves(NormalCurves&&) noexcept;
  NormalCurves& operator=(NormalCurves&&) noexcept;
  ~NormalCurves();

  /// Prepares the curves of all elements. Reads `normals` once and does not keep it. Throws std::bad_alloc only.
  explicit NormalCurves(std::span<const ControlNormals> normals, const CurveOptions& options = {});

  /// Prepares the curves of all faces of a segment, or of all elements of groups, straight from positions, without an
  /// array of control normals in between. (Meshes in no order need 32 bytes a vertex more for a while.) The first
  /// curves of some groups also make the paths around their elements, 33 bytes a vertex of a grid, which the groups
  /// keep for later curves. If many segments are prepared one after the other, name the curves before as `reuse`: they
  /// are emptied and their memory is used again, which spares asking the system for new pages; the 32 bytes a vertex
  /// are then kept for the next curves.
  ///     curves = NormalCurves::of_faces(motion.segment(i), options, Threads::kAll, &curves);
  [[nodiscard]] static NormalCurves of_faces(const Segment& segment, const CurveOptions& options = {},
                                             Threads threads = Threads::kOne, NormalCurves* reuse = nullptr);
  [[nodiscard]] static NormalCurves of_groups(const Segment& segment, const NormalGroups& groups,
                                              const CurveOptions& options = {}, Threads threads = Threads::kOne,
                                              NormalCurves* reuse = nullptr);

  /// Writes n(t) / |n(t)| of every element. Where n(t) = 0 it is the limit direction (see Direction), or (0, 0, 0)
  /// where n is zero throughout. Returns the number of (0, 0, 0) written, usually 0. control_normals.h says what t
  /// outside [0, 1] means.
  /// result must have size() elements
  std::size_t unit_normals(const LocalTime& t, VectorView<float> result, Threads threads = Threads::kOne) const;
  /// Writes them in four bytes each; see above for what becomes of (0, 0, 0).
  std::size_t unit_normals(const LocalTime& t, std::span<Octahedral> result, Threads threads = Threads::kOne) const;
  std::size_t unit_normals(const LocalTime& t, std::span<Rgb10A2> result, Threads threads = Threads::kOne) const;

  /// Writes the unit normals at many t, reading the curves from memory once: motion blur, or playing a block of frames.
  /// (Once for each t where results are neither all packed nor all planes.) results[k] is for times[k], and there are
  /// as many; returns the number of (0, 0, 0) of all of them. Throws std::bad_alloc.
  std::size_t unit_normals(std::span<const double> times, std::span<const VectorView<float>> results,
                           Threads threads = Threads::kOne) const;
  std::size_t unit_normals(std::span<const double> times, std::span<const std::span<Octahedral>> results,
                           Threads threads = Threads::kOne) const;

  /// Writes n(t) itself: length = 2 x area. A component beyond the range of float becomes the largest float.
  /// keeps_lengths() must hold; result must have size() elements
  void normals(const LocalTime& t, VectorView<float> result) const noexcept;

  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] bool keeps_lengths() const noexcept;
  /// Counts the elements of true degree 0, 1 and 2. A tolerance of 2^-12 or more may count elements as straight that
  /// bend by less than their rounding errors in float32; they are kept as straight then, within the tolerance.
  [[nodiscard]] const std::array<std::size_t, 3>& degree_counts() const noexcept;
  /// Counts the elements that are uncertain at t: n(t) is so small a part of the terms that it is the sum of, in
  /// double, that 1e-6 rad is not promised there. It happens only if control normals are all that is known; curves made
  /// from positions have none.
  [[nodiscard]] std::size_t uncertain_count(double t) const noexcept;
  /// Counts the elements that are evaluated in double.
  [[nodiscard]] std::size_t flagged_count() const noexcept;
  /// Returns the memory that is kept, in bytes (8 an index), except for what fills up the last block or what the next
  /// `reuse` needs.
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// The number of elements that are kept in blocks of some number of bytes.
  struct ByteCount {
    std::size_t bytes = 0;  ///< for each element
    std::size_t elements = 0;
  };
  [[nodiscard]] std::vector<ByteCount> byte_counts() const;

 private:
  friend class MeshNormals;

  explicit NormalCurves(std::unique_ptr<CurveData> data) noexcept;
  [[nodiscard]] const CurveData& data() const noexcept;
  [[nodiscard]] static CurveData* data_of(NormalCurves* reuse);

  std::unique_ptr<CurveData> data_;  // nothing: of no elements
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_NORMAL_CURVES_H_
