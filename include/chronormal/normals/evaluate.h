/// Curves of normals: prepared once per segment, evaluated at any t in float32.
///
/// NormalCurves keeps the control normals of N elements in float32, packed by their true degree. Neighbours of equal
/// degree form a run; a run of `count` elements of degree g is one piece of memory
///
///     degree 2   x0 x0 x0 ... y0 y0 y0 ... z0 z0 z0 ...   the same for m, the same for n1     9 x count floats
///     degree 1   the same for n0 and n1                                                        6 x count
///     degree 0   unit normal as x.. y.. z.., then the length |n|                               4 x count
///
/// so an element that stands still is copied, one of degree 1 needs two thirds of the memory and work, and nothing is
/// scattered. Runs shorter than 8 elements join a neighbour of higher degree.
///
/// Accuracy   The direction of every element is within 1e-6 rad of exact arithmetic. float32 alone cannot promise
///            that where n(t) gets small against its control normals, so each element carries a certificate
///            (docs/theory.md, section 5): if it cannot be shown that sum w_k |c_k| <= 3 |n(t)| for all t, the
///            element is *flagged* and is evaluated in double. flagged_count() tells how many those are.
/// Ownership  the curves own their memory; results go to the caller's.
/// Threads    const functions may run at the same time; they do not allocate or throw.
#ifndef CHRONORMAL_NORMALS_EVALUATE_H_
#define CHRONORMAL_NORMALS_EVALUATE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/views.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal {

class NormalCurves {
 public:
  NormalCurves() = default;

  /// Prepares the curves of all elements. Reads `normals` once and does not keep it. Throws std::bad_alloc only.
  explicit NormalCurves(std::span<const ControlNormals> normals);

  /// Writes n(t) / |n(t)| of every element. Where n(t) = 0 that is the limit direction (see Direction), or (0, 0, 0)
  /// where n is zero throughout. Returns the number of (0, 0, 0) written, usually 0.
  /// t in [0, 1]; result must have size() elements
  [[nodiscard]] std::size_t unit_normals(double t, VectorView<float> result) const noexcept;

  /// Writes n(t) itself: length = 2 x area. A component beyond the range of float becomes the largest float.
  /// t in [0, 1]; result must have size() elements
  void normals(double t, VectorView<float> result) const noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// How many elements have true degree 0, 1 and 2.
  [[nodiscard]] const std::array<std::size_t, 3>& degree_counts() const noexcept { return degree_counts_; }
  /// How many elements are evaluated in double.
  [[nodiscard]] std::size_t flagged_count() const noexcept { return flagged_.size(); }
  /// Memory that is kept, in bytes.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  friend class NormalPlayback;

  struct Run {
    std::size_t first = 0;   // element
    std::size_t count = 0;   // elements
    std::size_t offset = 0;  // of its first plane in values_
    int degree = 0;
  };
  struct Flagged {
    std::size_t element = 0;
    ControlNormals exact;
  };

  // Writes the flagged elements, in double; returns how many have no direction.
  std::size_t flagged_unit_normals(double t, VectorView<float> result) const noexcept;

  std::size_t size_ = 0;
  std::array<std::size_t, 3> degree_counts_{};
  int exponent_ = 0;  // values_ hold n * 2^-exponent_, so that squares stay in the range of float
  std::vector<Run> runs_;
  std::vector<float> values_;
  std::vector<Flagged> flagged_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_EVALUATE_H_
