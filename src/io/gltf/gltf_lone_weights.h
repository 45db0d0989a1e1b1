/// Turns a weight that has its own channel (KHR_animation_pointer to /weights/K) into a column of the track that all
/// weights of its node make together. Private to io.
#ifndef CHRONORMAL_IO_GLTF_GLTF_LONE_WEIGHTS_H_
#define CHRONORMAL_IO_GLTF_GLTF_LONE_WEIGHTS_H_

#include <cstddef>
#include <span>

#include "chronormal/io/gltf_document.h"

namespace chronormal::inline internal::gltf {

/// The keys of a channel for one weight, with as many values as keys, or three times as many for a cubic spline.
struct LoneKeys {
  std::span<const float> times;   ///< ascending times of keys, at least one
  std::span<const float> values;  ///< for a cubic spline: in-tangent, value, out-tangent of each key
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
};

/// Writes the weight at each of `times` into values[target + width * i], so that the track has the same curve as the
/// channel. The times must ascend, and contain the times of all keys of the channel. The channel is constant before its
/// first key and after its last. In a cubic track, each time has three rows: the slope before the time, the value, and
/// the slope after the time. The channel of a cubic track may be linear or cubic. In another track, the channel must
/// have the interpolation of the track.
void write_column(const LoneKeys& keys, std::span<const float> times, bool is_cubic_track, std::size_t target,
                  std::size_t width, std::span<double> values) noexcept;

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_GLTF_LONE_WEIGHTS_H_
