/// Ways to interpolate normals over a segment: the schemes of the paper, and more accurate ones.
///
/// A scheme is prepared from a block of elements and then fills unit normals at any t, in any order of t. It works on
/// whole blocks: one virtual call per block and t, none per element.
///
///     auto scheme = make_scheme("circle:timed").value();
///     scheme->prepare({segment, faces, control_normals});
///     scheme->evaluate(0.25, VectorView<float>::packed(normals.data(), faces.count));
///
/// Names      recompute, polynomial, rational, linear, quadratic, cubic, lagrange:K, linear:scaled, slerp,
///            decasteljau:K, quaternion:matrix|edge|polar|random:SEED|optimal, circle, circle:timed.
///            docs/theory.md, section 4, derives each of them.
/// Ends       every scheme starts from the exact unit normals of the block, or their limits if they vanish.
/// Degenerate An element whose normal is zero in the whole segment gets (0, 0, 0). All other elements get a finite unit
/// vector: if a scheme is not defined (antipodal ends, singular frames, a node at a collapse), it uses a documented
/// fallback, and counts it. The result is never NaN.
/// Threads    a scheme object belongs to one thread at a time, but several threads may call evaluate(), which is const.
#ifndef CHRONORMAL_SCHEMES_SCHEME_H_
#define CHRONORMAL_SCHEMES_SCHEME_H_

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal {

inline namespace internal {
struct FittedCurves;
}

/// The input that a scheme is prepared from: some elements of one segment, and their control normals.
struct ElementBlock {
  const Segment* segment = nullptr;
  IndexRange elements;                      ///< the elements; schemes that need faces read the faces with these indices
  std::span<const ControlNormals> normals;  ///< one for each element; `recompute` does not read them
  bool are_faces = true;                    ///< false for vertices or corners, which have no edges
  /// A function that returns the exact normal of the i-th element at t, not normalised. It is empty if the control
  /// normals are exact. Otherwise the control normals are only a fit, which is exact at both ends and at t = 1/2.
  std::function<Vec3d(std::size_t i, double t)> exact = {};
};

/// The elementary operations of one evaluation of one element. Work for all elements of a block at one t (powers of t,
/// Bernstein or Lagrange weights) is done once per block and not counted. A sine with its cosine counts as one
/// trigonometric operation, and so does an arc tangent.
struct OperationCounts {
  int add = 0;
  int multiply = 0;
  int divide = 0;
  int sqrt = 0;
  int trigonometric = 0;

  friend bool operator==(const OperationCounts&, const OperationCounts&) = default;
};

/// The default of `anchor_interval` in Scheme::play(), in steps. It keeps the drift of polynomials of degree up to 3
/// and of arcs below 5e-6 rad on the built-in morphs (docs/paper.md, section 3), and the drift of `polynomial` below
/// 5e-5 rad by a bound on every rounding. If a scheme normalises a short vector, as linear does between nearly
/// antipodal ends, its drift is divided by the length of this vector.
inline constexpr std::size_t kDefaultAnchorInterval = 64;

/// Plays a scheme at equal steps of t, where each step is computed from the previous one (sequential access).
class SchemePlayback {
 public:
  SchemePlayback() = default;
  SchemePlayback(const SchemePlayback&) = delete;
  SchemePlayback& operator=(const SchemePlayback&) = delete;
  virtual ~SchemePlayback() = default;

  /// Writes the unit normals at the current t, and advances by a step. Returns the number of (0, 0, 0) written. result
  /// must have as many vectors as the block has elements
  virtual std::size_t next(VectorView<float> result) noexcept = 0;
};

class Scheme {
 public:
  Scheme() = default;
  Scheme(const Scheme&) = delete;
  Scheme& operator=(const Scheme&) = delete;
  virtual ~Scheme() = default;

  /// Prepares for a new block, and forgets the previous one. Allocates memory. The block and the data that it refers to
  /// must stay alive until the last evaluate(): `recompute` reads the positions again.
  virtual void prepare(const ElementBlock& block) = 0;

  /// Writes a unit normal for each element, at local t in [0, 1]. Returns the number of (0, 0, 0) written. result must
  /// have as many vectors as the block has elements
  virtual std::size_t evaluate(double t, VectorView<float> result) const noexcept = 0;

  /// Returns true if prepare() reads the control normals of the block.
  [[nodiscard]] virtual bool uses_control_normals() const noexcept { return true; }
  /// Returns true if the scheme reads the faces themselves, so that elements must be faces. Other schemes also accept
  /// control normals of vertices and corners, and only read the index of the segment.
  [[nodiscard]] virtual bool needs_faces() const noexcept { return false; }
  /// Begins to play the block at t = start, start + step, ... in [0, 1]: polynomials are played by forward differences,
  /// and arcs by a rotation per step. The state drifts with every step, and is recomputed after every anchor_interval
  /// steps (never, if this is 0). Returns nothing if the scheme has no incremental form. The scheme must outlive the
  /// playback, and must not be prepared again meanwhile.
  [[nodiscard]] virtual std::unique_ptr<SchemePlayback> play(double start, double step,
                                                             std::size_t anchor_interval) const {
    (void)start, (void)step, (void)anchor_interval;
    return nullptr;
  }

  /// Counts the elements of the block for which prepare() used a documented fallback.
  [[nodiscard]] virtual std::size_t fallback_count() const noexcept = 0;
  /// Counts the elements of the block that are evaluated in double to keep the stated accuracy.
  [[nodiscard]] virtual std::size_t flagged_count() const noexcept { return 0; }
  /// Returns the memory that an evaluation of the block reads, in bytes.
  [[nodiscard]] virtual std::size_t bytes() const noexcept = 0;
  /// Returns the operations per element and evaluation at random t, counted by running the same code with a counting
  /// scalar.
  [[nodiscard]] virtual OperationCounts operations() const = 0;
  /// Returns the operations per element and step of a playback, counted in the same way; nothing without an incremental
  /// form.
  [[nodiscard]] virtual std::optional<OperationCounts> sequential_operations() const { return std::nullopt; }

  /// Returns true if every normal that evaluate() writes is guaranteed to be within kExactTolerance of the exact one.
  [[nodiscard]] virtual bool is_exact() const noexcept { return false; }
  /// Returns the curves that were fitted to the block, for certify() in analysis/certify.h; nothing if they are not
  /// known, so that no bound can be certified. They are valid until the next prepare().
  [[nodiscard]] virtual std::shared_ptr<const FittedCurves> fitted_curves() const { return nullptr; }
};

/// Makes a scheme from its name. Errors: kUsage, with the known names or the range of a parameter.
[[nodiscard]] Result<std::unique_ptr<Scheme>> make_scheme(std::string_view name);

struct SchemeDescription {
  std::string_view name;     ///< the name for make_scheme(); K and SEED stand for a number
  std::string_view summary;  ///< one line
};

/// Lists all schemes, in the order of docs/theory.md.
[[nodiscard]] std::span<const SchemeDescription> scheme_descriptions() noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_SCHEMES_SCHEME_H_
