/// The forms in which results leave NormalCurves, each behind the same two calls.
///
///     write(span, weights, first)   the unit normals of a span of blocks, the first of which is element `first`
///     set(i, v)                     that of one element
#ifndef CHRONORMAL_NORMALS_OUTPUTS_H_
#define CHRONORMAL_NORMALS_OUTPUTS_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/views.h"
#include "chronormal/normals/encodings.h"
#include "normals/kernels/evaluate.h"

namespace chronormal {

[[nodiscard]] inline bool is_packed(const VectorView<float>& view) {
  return view.stride == 3 && view.y == view.x + 1 && view.z == view.x + 2;
}

/// The reach of results in such arrays: these can go past the caches if all begin at a cache line.
template <class... Pointer>
[[nodiscard]] Reach reach_into(Reach reach, Pointer... arrays) {
  return ((reinterpret_cast<std::uintptr_t>(arrays) % 64 == 0) && ...) ? reach : Reach::kCaches;
}

struct PackedOutput {
  PackedOutput(const VectorView<float>& view, Reach of_pass) : result(view), reach(reach_into(of_pass, view.x)) {}

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t first) const {
    evaluate_blocks(span, weights, PackedResult{result.x + 3 * first, reach});
  }
  void set(std::size_t i, const Vec3f& v) const { result.set(i, v); }

  VectorView<float> result;
  Reach reach;
};

struct PlanesOutput {
  PlanesOutput(const VectorView<float>& view, Reach of_pass)
      : result(view), reach(reach_into(of_pass, view.x, view.y, view.z)) {}

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t first) const {
    evaluate_blocks(span, weights, PlanesResult{result.x + first, result.y + first, result.z + first, reach});
  }
  void set(std::size_t i, const Vec3f& v) const { result.set(i, v); }

  VectorView<float> result;
  Reach reach;
};

struct OctahedralOutput {
  OctahedralOutput(std::span<Octahedral> normals, Reach of_pass)
      : result(normals), reach(reach_into(of_pass, normals.data())) {}

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t first) const {
    static_assert(sizeof(Octahedral) == sizeof(std::uint32_t));
    evaluate_blocks(span, weights, OctahedralResult{&result[first].bits, reach});
  }
  void set(std::size_t i, const Vec3f& v) const { result[i] = encode_octahedral(v); }

  std::span<Octahedral> result;
  Reach reach;
};

struct Rgb10A2Output {
  Rgb10A2Output(std::span<Rgb10A2> normals, Reach of_pass)
      : result(normals), reach(reach_into(of_pass, normals.data())) {}

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t first) const {
    static_assert(sizeof(Rgb10A2) == sizeof(std::uint32_t));
    evaluate_blocks(span, weights, Rgb10A2Result{&result[first].bits, reach});
  }
  void set(std::size_t i, const Vec3f& v) const { result[i] = encode_rgb10a2(v); }

  std::span<Rgb10A2> result;
  Reach reach;
};

/// Any other form, by a function of index and vector: through planes on the stack, a few blocks at a time.
template <class Set>
struct AnyOutput {
  Set set;

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t first) const {
    constexpr std::size_t kCount = 16 * kTile;
    alignas(64) float x[kCount], y[kCount], z[kCount];
    for (std::size_t i = 0; i < span.elements; i += kCount) {
      const std::size_t count = std::min(kCount, span.elements - i);
      const BlockSpan some{span.blocks + i * bytes_of(span.kind), span.kind, count};
      evaluate_blocks(some, weights, PlanesResult{x, y, z, Reach::kCaches});
      for (std::size_t k = 0; k < count; ++k) set(first + i + k, {x[k], y[k], z[k]});
    }
  }
};

template <class Set>
AnyOutput(Set) -> AnyOutput<Set>;

/// Calls body(output) with the form that a view has; returns what it returns.
template <class Body>
auto with_output(const VectorView<float>& result, Reach of_pass, Body body) {
  if (is_packed(result)) return body(PackedOutput(result, of_pass));
  if (result.stride == 1) return body(PlanesOutput(result, of_pass));
  return body(AnyOutput{[result](std::size_t i, const Vec3f& v) { result.set(i, v); }});
}

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_OUTPUTS_H_
