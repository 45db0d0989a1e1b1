/// Ways to interpolate normals over a segment: the schemes of the paper, and more accurate ones.
///
/// A scheme is prepared from a block of elements, and then writes their unit normals at any t, in any order of t. It
/// works on whole blocks, so there is one virtual call per block and t, and none per element.
///
///     auto scheme = make_scheme("circle:timed").value();
///     scheme->prepare({segment, faces, control_normals});
///     scheme->evaluate(0.25, VectorView<float>::packed(normals.data(), faces.count));
///
/// Names      recompute, polynomial, rational, linear, quadratic, cubic, lagrange:K, linear:scaled, slerp,
///            decasteljau:K, quaternion:matrix|edge|polar|random:SEED|optimal, circle, circle:timed.
///            docs/theory.md, section 4, derives each of them.
/// Ends       every scheme is prepared from the exact unit normals of the block at t = 0 and t = 1, or from the limits
///            of n / |n| if n vanishes there.
/// Degenerate An element whose normal is zero in the whole segment gets (0, 0, 0). All other elements get a finite unit
///            vector: if a scheme is not defined (antipodal ends, singular frames, a node at a collapse), it uses a
///            documented fallback, and counts it. The result is never NaN.
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
  IndexRange elements;  ///< the elements; schemes that need faces read the faces with these numbers
  /// The control normals, one for each element; `recompute` does not read them.
  std::span<const ControlNormals> normals;
  bool are_faces = true;  ///< false for vertices or corners, which have no edges
  /// A function that returns the exact normal of the i-th element of the block at t, not scaled to length 1. The
  /// function is empty if the control normals are exact. Otherwise the control normals are only a fit, which is exact
  /// at both ends and at t = 1/2.
  std::function<Vec3d(std::size_t i, double t)> exact = {};
};

/// The numbers of elementary operations that evaluate one element at one t. Work that all elements of a block share at
/// one t (powers of t, Bernstein or Lagrange weights) is done once per block and not counted. A sine with its cosine
/// counts as one trigonometric operation, and so does an arc tangent.
struct OperationCounts {
  int add = 0;
  int multiply = 0;
  int divide = 0;
  int sqrt = 0;
  int trigonometric = 0;

  friend bool operator==(const OperationCounts&, const OperationCounts&) = default;
};

/// The default of `anchor_interval` in Scheme::play(), in steps. The default keeps the drift, which is the error that
/// playback adds, below 5e-6 rad for polynomials of degree up to 3 and for arcs on the built-in morphs (docs/paper.md,
/// section 3). The drift of `polynomial` stays below 5e-5 rad, by a bound on every rounding. If a scheme normalises a
/// short vector, as linear does between nearly antipodal ends, its drift is larger by the inverse of the length of this
/// vector.
inline constexpr std::size_t kDefaultAnchorInterval = 64;

/// A playback of a scheme at equal steps of t. Each step is computed from the previous step (sequential access).
class SchemePlayback {
 public:
  SchemePlayback() = default;
  SchemePlayback(const SchemePlayback&) = delete;
  SchemePlayback& operator=(const SchemePlayback&) = delete;
  virtual ~SchemePlayback() = default;

  /// Writes the unit normals at the current t, and then advances t by one step. Returns the number of (0, 0, 0)
  /// written. Precondition: result has as many vectors as the block has elements.
  virtual std::size_t next(VectorView<float> result) noexcept = 0;
};

class Scheme {
 public:
  Scheme() = default;
  Scheme(const Scheme&) = delete;
  Scheme& operator=(const Scheme&) = delete;
  virtual ~Scheme() = default;

  /// Prepares the scheme for a new block, and forgets the previous block. Allocates memory. The block and the data that
  /// it refers to must stay alive until the last evaluate(), since `recompute` reads the positions again.
  virtual void prepare(const ElementBlock& block) = 0;

  /// Writes a unit normal for each element at the local t, which must be in [0, 1]. Returns the number of (0, 0, 0)
  /// written. Precondition: result has as many vectors as the block has elements.
  virtual std::size_t evaluate(double t, VectorView<float> result) const noexcept = 0;

  /// Returns true if prepare() reads the control normals of the block.
  [[nodiscard]] virtual bool uses_control_normals() const noexcept { return true; }
  /// Returns true if the scheme reads the vertices of faces, so that elements must be faces. Other schemes also accept
  /// control normals of vertices and corners, and read nothing of the segment except its index.
  [[nodiscard]] virtual bool needs_faces() const noexcept { return false; }
  /// Begins to play the block at t = start, start + step, ... in [0, 1]. Polynomials are played by forward differences,
  /// and arcs by one rotation per step. The state drifts with every step, and is therefore recomputed after every
  /// anchor_interval steps (never, if anchor_interval is 0). Returns nullptr if the scheme cannot compute a step from
  /// the previous step. The scheme must outlive the playback, and must not be prepared again while the playback is
  /// used.
  [[nodiscard]] virtual std::unique_ptr<SchemePlayback> play(double start, double step,
                                                             std::size_t anchor_interval) const {
    (void)start, (void)step, (void)anchor_interval;
    return nullptr;
  }

  /// Returns the number of elements of the block for which the scheme is not defined, so that prepare() used a
  /// documented fallback.
  [[nodiscard]] virtual std::size_t fallback_count() const noexcept = 0;
  /// Returns the number of elements of the block that are evaluated in double to keep the stated accuracy.
  [[nodiscard]] virtual std::size_t flagged_count() const noexcept { return 0; }
  /// Returns the number of bytes that an evaluation of the block reads.
  [[nodiscard]] virtual std::size_t bytes() const noexcept = 0;
  /// Returns the operations per element of one evaluate(), counted by running the same code with a scalar that counts.
  [[nodiscard]] virtual OperationCounts operations() const = 0;
  /// Returns the operations per element and step of a playback, or no value if play() returns nullptr. The operations
  /// are counted by running the same code with a scalar that counts.
  [[nodiscard]] virtual std::optional<OperationCounts> sequential_operations() const { return std::nullopt; }

  /// Returns true if every normal that evaluate() writes is guaranteed to be within kExactTolerance of the exact
  /// normal.
  [[nodiscard]] virtual bool is_exact() const noexcept { return false; }
  /// Returns the curves that were fitted to the block, for certify() in analysis/certify.h. Returns nullptr if the
  /// curves are not known; certify() then cannot bound the error. The curves are valid until the next prepare().
  [[nodiscard]] virtual std::shared_ptr<const FittedCurves> fitted_curves() const { return nullptr; }
};

/// Makes a scheme from its name. Errors: kUsage for an unknown name, with all known names, and for a parameter out of
/// its range, with this range.
[[nodiscard]] Result<std::unique_ptr<Scheme>> make_scheme(std::string_view name);

struct SchemeDescription {
  std::string_view name;     ///< the name for make_scheme(), in which K and SEED stand for numbers
  std::string_view summary;  ///< a description of one line
};

/// Lists all schemes, in the order of docs/theory.md.
[[nodiscard]] std::span<const SchemeDescription> scheme_descriptions() noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_SCHEMES_SCHEME_H_
