/// Evaluates the weights of morph targets over time, from the keys of a track. Private to io.
#ifndef CHRONORMAL_IO_GLTF_GLTF_WEIGHTS_H_
#define CHRONORMAL_IO_GLTF_GLTF_WEIGHTS_H_

#include <cstddef>
#include <span>
#include <vector>

#include "chronormal/io/gltf_document.h"

namespace chronormal::inline internal::gltf {

/// The weights of a node with N targets as functions of time. The weights are constant before the first key and after
/// the last, and follow appendix C of the glTF specification between keys.
class WeightCurve {
 public:
  /// Takes the keys that GltfDocument::keys() returned.
  WeightCurve(GltfKeys keys, GltfInterpolation interpolation, std::size_t target_count)
      : target_count_(target_count), interpolation_(interpolation), keys_(std::move(keys)) {}

  /// Returns true if the weights just before a key may differ from the weights at the key.
  [[nodiscard]] bool jumps() const noexcept { return interpolation_ == GltfInterpolation::kStep; }

  [[nodiscard]] std::span<const double> times() const noexcept { return keys_.times; }

  /// Writes the weights at a time. If the weights jump at this time, writes the weights just after the jump, or just
  /// before the jump if just_before is set.
  void at(double time, bool just_before, std::span<double> weights) const noexcept;

  /// Writes a bound of the second derivative of every weight (in 1/s^2) between two times within the same key interval.
  /// The bound is 0 if the weights are linear or constant.
  void curvature(double from, double to, std::span<double> bounds) const noexcept;

 private:
  [[nodiscard]] double value(std::size_t key, std::size_t target) const noexcept;
  [[nodiscard]] double tangent(std::size_t key, bool out, std::size_t target) const noexcept;

  std::size_t target_count_;
  GltfInterpolation interpolation_;
  GltfKeys keys_;
};

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_GLTF_WEIGHTS_H_
