/// The forms in which NormalCurves writes results. Each form has the same two functions.
///
///     write(span, weights, first)   writes the unit normals of a span of blocks, which begins with element `first`
///     set(i, v)                     writes the normal of one element
#ifndef CHRONORMAL_NORMALS_CURVES_OUTPUTS_H_
#define CHRONORMAL_NORMALS_CURVES_OUTPUTS_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/views.h"
#include "chronormal/normals/normal_curves.h"
#include "normals/curves/kernels/evaluate.h"

namespace chronormal::inline internal {

[[nodiscard]] inline bool is_packed(const VectorView<float>& view) { return view.is_packed(); }

/// Returns the way in which a pass uses memory if its results go to `arrays`. Results bypass the caches only if each
/// array begins at a cache line.
template <class... Pointer>
[[nodiscard]] MemoryAccess access_to(MemoryAccess of_pass, Pointer... arrays) {
  const bool aligned = ((reinterpret_cast<std::uintptr_t>(arrays) % 64 == 0) && ...);
  return {of_pass.working_set, of_pass.stream && aligned};
}

struct PackedOutput {
  PackedOutput(const VectorView<float>& view, MemoryAccess of_pass)
      : result(view), access(access_to(of_pass, view.x)) {}

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t first) const {
    evaluate_blocks(span, weights, PackedResult{result.x + 3 * first, access});
  }
  void set(std::size_t i, const Vec3f& v) const {
    float* const to = result.x + 3 * i;
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
  }

  VectorView<float> result;
  MemoryAccess access;
};

struct PlanesOutput {
  PlanesOutput(const VectorView<float>& view, MemoryAccess of_pass)
      : result(view), access(access_to(of_pass, view.x, view.y, view.z)) {}

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t first) const {
    evaluate_blocks(span, weights, PlanesResult{result.x + first, result.y + first, result.z + first, access});
  }
  void set(std::size_t i, const Vec3f& v) const { result.set(i, v); }

  VectorView<float> result;
  MemoryAccess access;
};

struct OctahedralOutput {
  OctahedralOutput(std::span<Octahedral> normals, MemoryAccess of_pass)
      : result(normals), access(access_to(of_pass, normals.data())) {}

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t first) const {
    static_assert(sizeof(Octahedral) == sizeof(std::uint32_t));
    evaluate_blocks(span, weights, OctahedralResult{&result[first].bits, access});
  }
  void set(std::size_t i, const Vec3f& v) const { result[i] = encode_octahedral(v); }

  std::span<Octahedral> result;
  MemoryAccess access;
};

struct Rgb10A2Output {
  Rgb10A2Output(std::span<Rgb10A2> normals, MemoryAccess of_pass)
      : result(normals), access(access_to(of_pass, normals.data())) {}

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t first) const {
    static_assert(sizeof(Rgb10A2) == sizeof(std::uint32_t));
    evaluate_blocks(span, weights, Rgb10A2Result{&result[first].bits, access});
  }
  void set(std::size_t i, const Vec3f& v) const { result[i] = encode_rgb10a2(v); }

  std::span<Rgb10A2> result;
  MemoryAccess access;
};

/// The form of results in any other layout. The function `set` writes each result from its index and its vector. The
/// kernel writes a few blocks at a time into planes on the stack, from which the vectors are taken.
template <class Set>
struct AnyOutput {
  WorkingSet working_set;
  Set set;

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t first) const {
    if (span.kind == BlockKind::kNone) return;
    constexpr std::size_t kCount = 16 * kTile;
    alignas(64) float x[kCount], y[kCount], z[kCount];
    for (std::size_t i = 0; i < span.elements; i += kCount) {
      const std::size_t count = std::min(kCount, span.elements - i);
      const BlockSpan some{span.blocks + i * bytes_of(span.kind), span.kind, count};
      evaluate_blocks(some, weights, PlanesResult{x, y, z, {working_set, false}});
      for (std::size_t k = 0; k < count; ++k) set(first + i + k, {x[k], y[k], z[k]});
    }
  }
};

template <class Set>
AnyOutput(WorkingSet, Set) -> AnyOutput<Set>;

/// Writes the normals of the elements from `first` on; xyz has three numbers for each element.
template <class Output>
void set_run(const Output& output, std::size_t first, const float* xyz, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) output.set(first + i, Vec3f{xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]});
}

inline void set_run(const PackedOutput& output, std::size_t first, const float* xyz, std::size_t count) {
  float* const to = output.result.x + 3 * first;
  if (count == kTile)  // with this constant size, the compiler copies without a call
    std::copy_n(xyz, 3 * kTile, to);
  else
    std::copy_n(xyz, 3 * count, to);
}

/// Calls body(output) with the form of output that suits the layout of a view, and returns the result of body.
template <class Body>
auto with_output(const VectorView<float>& result, MemoryAccess of_pass, Body body) {
  if (is_packed(result)) return body(PackedOutput(result, of_pass));
  if (result.stride == 1) return body(PlanesOutput(result, of_pass));
  return body(AnyOutput{of_pass.working_set, [result](std::size_t i, const Vec3f& v) { result.set(i, v); }});
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_OUTPUTS_H_
