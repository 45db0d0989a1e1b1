/// Unit normals of one segment in whichever way is cheaper: by prepared curves, or recomputed at every t.
///
/// Curves (NormalCurves) are evaluated several times faster than normals are recomputed (NormalRecompute), but have to
/// be prepared. Which of the two costs less depends on how often the segment will be evaluated, and on the mesh: a
/// SegmentNormals asks a model of both, says what it chose and why, and does it.
///
///     SegmentNormals normals(motion.segment(0), {.evaluations = 60});
///     normals.unit_normals(0.25, VectorView<float>::packed(xyz, normals.size()));
///     std::cout << normals.choice().reason;
///
/// Model      a pure function of what it is given: no clock, no thread count, nothing read from the machine. Its
///            constants were measured on one core of a Xeon of 2.6 GHz; on others both ways get faster or slower
///            together, and the choice is wrong only where both cost nearly the same.
/// Shading    Where no accuracy is promised (FloatRecompute), recomputing normals is two to four times cheaper, and
///            curves have to be evaluated more often before they pay. A caller for whom float32 is enough sets
///            float_recompute.
/// Accuracy   recompute within 1e-6 rad of exact arithmetic, curves within the tolerance that is asked for; both for
///            every element, at every t. A FloatRecompute promises none.
/// Ownership  the segment's positions and topology, and the groups, must outlive the object.
/// Forms      float vectors at one t; for others, and many t, choose_strategy() and NormalCurves.
/// Moves      what was moved from may only be destroyed or assigned to.
/// Threads    one call at a time. The same bits whatever the number of threads.
#ifndef CHRONORMAL_NORMALS_SEGMENT_NORMALS_H_
#define CHRONORMAL_NORMALS_SEGMENT_NORMALS_H_

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/float_recompute.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/recompute.h"

namespace chronormal {

enum class NormalStrategy {
  kPolynomial,  ///< curves, prepared once
  kRecompute,   ///< positions, at every t
};

/// "polynomial" or "recompute", as the schemes are called.
[[nodiscard]] std::string_view name_of(NormalStrategy strategy) noexcept;

struct StrategyOptions {
  /// How many times unit_normals() will be called. At least one is assumed.
  double evaluations = 1;
  /// Of curves, in radians; see CurveOptions.
  double tolerance = kExactTolerance;
  /// Recomputes normals with this object, in float32, where that is cheaper than curves. It must be of the topology and
  /// the groups, and outlive the object. nullptr: normals are recomputed by a NormalRecompute, within 1e-6 rad.
  FloatRecompute* float_recompute = nullptr;
  /// Takes this one whatever it costs.
  std::optional<NormalStrategy> forced = {};
};

/// What the model knows of a segment.
struct MeshShape {
  std::size_t elements = 0;  ///< faces, or elements of groups
  std::size_t faces = 0;
  std::size_t vertices = 0;
  double triangles_per_face = 1;
  double faces_per_element = 0;  ///< 0: elements are faces; else how many each adds up, 6 for most vertices
  /// Cache lines of packed positions that a face needs and those before it did not: 0.2 in a good order, 3 in none.
  double lines_per_face = 0;
  /// Of the normals in t, 0 to 2, on the average.
  double degree = 2;
  /// Shares of the elements: scattered, whose faces are too far apart for a window over them; doubtful, which have to
  /// be examined in double, since they nearly collapse in the segment; and flagged, which are then kept in double, in
  /// exact and in compact curves.
  double scattered = 0, doubtful = 0, flagged = 0, flagged_compact = 0;
  /// The share of the faces that are recomputed in double, since they are thin or have neighbours that are.
  double thin = 0;
  /// The share of the elements that compact curves prepare in float32. The others have thin faces, or nearly collapse.
  double in_float32 = 1;
};

/// Measures a segment on a sample at a fixed stride: less than half a millisecond whatever its size. Pure.
[[nodiscard]] MeshShape shape_of(const Segment& segment);
[[nodiscard]] MeshShape shape_of(const Segment& segment, const NormalGroups& groups);

/// Sizes of the caches that the model has in mind, in bytes.
inline constexpr double kModelledNearCache = 2 << 20;  // of a core
inline constexpr double kModelledSharedCache = 32 << 20;

struct StrategyCosts {
  /// Of curves, once; nanoseconds for each element, on one thread. The paths that the first curves for some groups make
  /// are not counted (NormalCurves::of_groups).
  double prepare = 0;
  double evaluate = 0;     ///< of curves, each time; likewise
  double recompute = 0;    ///< within 1e-6 rad, each time; likewise
  double in_float32 = 0;   ///< by a FloatRecompute, each time; likewise
  double curve_bytes = 0;  ///< kept by curves, all together

  /// The number of evaluations from which on curves are cheaper than recomputing normals, within 1e-6 rad or in
  /// float32; infinity where they never are.
  [[nodiscard]] double break_even() const noexcept { return break_even_with(recompute); }
  [[nodiscard]] double break_even_in_float32() const noexcept { return break_even_with(in_float32); }

 private:
  [[nodiscard]] double break_even_with(double rival) const noexcept;
};

/// The model. Pure.
[[nodiscard]] StrategyCosts model_costs(const MeshShape& shape, double tolerance) noexcept;

struct StrategyChoice {
  NormalStrategy strategy = NormalStrategy::kRecompute;
  StrategyCosts costs;
  double polynomial_cost = 0;  ///< of all evaluations, nanoseconds for each element
  double recompute_cost = 0;   ///< likewise, in the way that the options allow
  std::string reason;          ///< one line, for people
};

/// Chooses for a mesh of this shape. Pure.
[[nodiscard]] StrategyChoice choose_strategy(const MeshShape& shape, const StrategyOptions& options);

class SegmentNormals {
 public:
  /// Of the faces of a segment, or of the elements of groups. Prepares curves where those are chosen.
  explicit SegmentNormals(const Segment& segment, const StrategyOptions& options = {}, Threads threads = Threads::kOne);
  SegmentNormals(const Segment& segment, const NormalGroups& groups, const StrategyOptions& options = {},
                 Threads threads = Threads::kOne);

  /// Writes n(t) / |n(t)| of every element, and the limit or (0, 0, 0) where there is none; returns the number of
  /// (0, 0, 0) written.
  /// result must have size() elements
  std::size_t unit_normals(const LocalTime& t, VectorView<float> result, Threads threads = Threads::kOne);

  [[nodiscard]] std::size_t size() const noexcept;
  /// What was chosen, and why.
  [[nodiscard]] const StrategyChoice& choice() const noexcept { return choice_; }
  /// Memory that is kept, in bytes: of curves, or scratch.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  // The FloatRecompute of the caller, and the segment for which it is asked.
  struct InFloat32 {
    FloatRecompute* recompute;
    Segment segment;

    std::size_t unit_normals(const LocalTime& t, VectorView<float> result, Threads threads) {
      return recompute->unit_normals(segment, t, result, threads);
    }
    [[nodiscard]] std::size_t size() const noexcept { return recompute->size(); }
    [[nodiscard]] std::size_t bytes() const noexcept { return recompute->bytes(); }
  };

  StrategyChoice choice_;
  std::variant<NormalRecompute, NormalCurves, InFloat32> normals_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_SEGMENT_NORMALS_H_
