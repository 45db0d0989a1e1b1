/// Curves of normals: prepared once per segment, evaluated at any t at the speed of memory.
///
/// NormalCurves stores the control normals of N elements in consecutive blocks of 16, each in the smallest format that
/// keeps the tolerance, so that an evaluation is one pass over memory. The format of a block depends on the largest
/// degree of its elements and on their required precision; in bytes per element:
///
///     degree 2   36  n0, m, n1 in float32: 16 x of n0, 16 y of n0, ...
///                20  in int16 relative to the largest component of the element; or for slivers and collapsing faces,
///                    each of n0, m, n1 relative to its own largest component, rounded up to a power of two (5 bits
///                    each)
///                12  n0, n1 in 11 bits per component, m in 10
///     degree 1   24  n0, n1 in float32;   12 or 20  in int16, likewise
///     degree 0   12  the unit normal in float32, 16 with its length
///
/// The scale by which an element's int16 components were divided is not stored, since a direction does not need it. A
/// run of fewer than 4 blocks of the same format is stored in the format of a neighbouring run, if that format is
/// precise enough and both are within the same 32 blocks.
///
/// Accuracy   The direction of every element is within `tolerance` of the exact n(t) of the positions at the
///            double t, by a bound and not by measurement (docs/theory.md, sections 5 and 13). If n(t) becomes small
///            relative to its control normals, their rounding has a larger effect, so the smallest |n(t)| of each
///            element is bounded during preparation. If float32 cannot guarantee 1e-6 rad, the element is *flagged* and
///            evaluated in double; flagged_count() returns the number of these. If double is not enough either, curves
///            made from positions store the control normals as integers, and give the exact direction at every t;
///            curves made from control normals give the direction of these, and uncertain_count() counts the elements
///            for which even that is not certain.
/// Lengths    |n(t)| is kept if the tolerance is kExactTolerance, and is lost in compact curves.
/// Ownership  the curves own their memory; results go to memory of the caller.
/// Threads    const functions may run at the same time. With one thread and one t they do not allocate or throw.
///            Results have the same bits on every instruction set, compiler and number of threads.
/// Speed      results are written fastest if they are aligned to 64 bytes, and are packed, planes or in four bytes each
///            (docs/benchmarks.md).
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
// A component c of snorm N bits is the integer nearest to c (2^(N-1) - 1), in two's complement. (0, 0, 0), the result
// for an element without a normal, is 0 in Rgb10A2. Octahedral cannot represent (0, 0, 0), and gives 0, which is
// decoded as (0, 0, 1).

/// A unit normal in four bytes. Each encoding has its own type, so that the compiler refuses to mix them up.
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

/// Decodes a unit vector, or the zero of Rgb10A2.
[[nodiscard]] Vec3f decode(Octahedral encoded) noexcept;
[[nodiscard]] Vec3f decode(Rgb10A2 encoded) noexcept;

inline namespace internal {
struct CurveData;
}

/// The tolerance that float32 can guarantee, for exact normals. Blocks take 36, 24 or 16 bytes per element, and lengths
/// are kept.
inline constexpr double kExactTolerance = 1e-6;  // radians
/// A good tolerance for shading, about a twentieth of a degree. Most blocks take 12 or 20 bytes per element.
inline constexpr double kCompactTolerance = 1e-3;  // radians

struct CurveOptions {
  /// The largest error of a unit normal in radians, from kExactTolerance to 0.2. A value outside of this range counts
  /// as the nearer limit.
  double tolerance = kExactTolerance;
};

class NormalCurves {
 public:
  /// Creates curves without elements.
  NormalCurves() noexcept;
  /// Curves can be moved, but not copied. An object from which curves were moved has no elements.
  NormalCurves(NormalCurves&&) noexcept;
  NormalCurves& operator=(NormalCurves&&) noexcept;
  ~NormalCurves();

  /// Prepares the curves of all elements from their control normals, which are read once and not kept. Throws only
  /// std::bad_alloc.
  explicit NormalCurves(std::span<const ControlNormals> normals, const CurveOptions& options = {});

  /// Prepares the curves of all faces of a segment, or of all elements of groups, directly from positions, without an
  /// array of control normals in between. Meshes in random order need 32 more bytes per vertex during the call. The
  /// first curves for some groups also compute the paths around elements, which take 33 bytes per vertex of a grid, and
  /// which the groups keep for later curves. If many segments are prepared one after the other, pass the previous
  /// curves as `reuse`. The call empties these curves and reuses their memory, which avoids requests for new pages. The
  /// 32 bytes per vertex are then kept for the next curves.
  ///     curves = NormalCurves::of_faces(motion.segment(i), options, Threads::kAll, &curves);
  [[nodiscard]] static NormalCurves of_faces(const Segment& segment, const CurveOptions& options = {},
                                             Threads threads = Threads::kOne, NormalCurves* reuse = nullptr);
  [[nodiscard]] static NormalCurves of_groups(const Segment& segment, const NormalGroups& groups,
                                              const CurveOptions& options = {}, Threads threads = Threads::kOne,
                                              NormalCurves* reuse = nullptr);

  /// Writes n(t) / |n(t)| of every element. If n(t) = 0, the result is the limit direction (see Direction), or (0, 0,
  /// 0) if n is zero in the whole segment. Returns the number of (0, 0, 0) written, usually 0. A t outside [0, 1] is
  /// moved to the nearer end (control_normals.h). Precondition: result has size() elements.
  std::size_t unit_normals(const LocalTime& t, VectorView<float> result, Threads threads = Threads::kOne) const;
  /// Write the unit normals in four bytes each. A zero normal is written as 0, which Octahedral decodes as (0, 0, 1).
  std::size_t unit_normals(const LocalTime& t, std::span<Octahedral> result, Threads threads = Threads::kOne) const;
  std::size_t unit_normals(const LocalTime& t, std::span<Rgb10A2> result, Threads threads = Threads::kOne) const;

  /// Writes the unit normals at many t while reading the curves only once, for motion blur or for a block of frames.
  /// (If the results are neither all packed nor all planes, curves are read once for each t.) results[k] gets the
  /// normals at times[k], so the two lists must be of the same length. Returns the number of (0, 0, 0) in all results.
  /// Throws only std::bad_alloc.
  std::size_t unit_normals(std::span<const double> times, std::span<const VectorView<float>> results,
                           Threads threads = Threads::kOne) const;
  std::size_t unit_normals(std::span<const double> times, std::span<const std::span<Octahedral>> results,
                           Threads threads = Threads::kOne) const;

  /// Writes n(t) itself, which has a length of twice the area. A component beyond the range of float32 becomes the
  /// largest float32. Preconditions: keeps_lengths(); result has size() elements.
  void normals(const LocalTime& t, VectorView<float> result) const noexcept;

  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] bool keeps_lengths() const noexcept;
  /// Returns the numbers of elements of true degree 0, 1 and 2. With a tolerance of 2^-12 or more, an element that
  /// bends by less than its rounding errors in float32 may count as straight, which is degree 1. Such an element is
  /// also stored as a straight curve, within the tolerance.
  [[nodiscard]] const std::array<std::size_t, 3>& degree_counts() const noexcept;
  /// Returns the number of elements that are uncertain at t: n(t) is so small relative to the terms of its sum that
  /// double cannot guarantee 1e-6 rad. Curves made from positions have no such elements; only curves made from control
  /// normals can have some.
  [[nodiscard]] std::size_t uncertain_count(double t) const noexcept;
  /// Returns the number of elements that are evaluated in double, since float32 cannot guarantee the tolerance for
  /// them.
  [[nodiscard]] std::size_t flagged_count() const noexcept;
  /// Returns the memory in use, in bytes. Each index of the curves counts as 8 bytes, also on 32-bit machines. The
  /// padding of the last block and the memory that is kept for the next `reuse` do not count.
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// A number of elements that take the same number of bytes each.
  struct ByteCount {
    std::size_t bytes = 0;  ///< number of bytes for each of these elements
    std::size_t elements = 0;
  };
  [[nodiscard]] std::vector<ByteCount> byte_counts() const;

 private:
  friend class MeshNormals;

  explicit NormalCurves(std::unique_ptr<CurveData> data) noexcept;
  [[nodiscard]] const CurveData& data() const noexcept;
  [[nodiscard]] static CurveData* data_of(NormalCurves* reuse);

  std::unique_ptr<CurveData> data_;  // nullptr if there are no elements
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_NORMAL_CURVES_H_
