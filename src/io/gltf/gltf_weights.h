/// Weights of morph targets over time, from the keys of a track. Private to io.
#ifndef CHRONORMAL_IO_GLTF_GLTF_WEIGHTS_H_
#define CHRONORMAL_IO_GLTF_GLTF_WEIGHTS_H_

#include <cstddef>
#include <span>
#include <vector>

#include "chronormal/io/gltf_document.h"

namespace chronormal::inline internal::gltf {

/// The weights of one node (N targets) as functions of time: constant before the first key and after the last, between
/// them as appendix C of the glTF specification has it.
class WeightCurve {
 public:
  /// keys as GltfDocument::keys() gives them.
  WeightCurve(GltfKeys keys, GltfInterpolation interpolation, std::size_t target_count)
      : target_count_(target_count), interpolation_(interpolation), keys_(std::move(keys)) {}

  /// Whether weights just before a key may be others than at the key.
  [[nodiscard]] bool jumps() const noexcept { return interpolation_ == GltfInterpolation::kStep; }

  [[nodiscard]] std::span<const double> times() const noexcept { return keys_.times; }

  /// Writes the weights at a time; where they jump, those just after it or just before it.
  void at(double time, bool just_before, std::span<double> weights) const noexcept;

  /// Writes a bound of |w''| of every weight between two times that lie between the same two keys; 0 where the weights
  /// are linear or constant.
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
