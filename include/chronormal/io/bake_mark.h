/// What a bake leaves in a glTF file about itself: how normals are encoded, and what drives the targets that it added
/// (docs/extras.md).
///
/// Threads    values
#ifndef CHRONORMAL_IO_BAKE_MARK_H_
#define CHRONORMAL_IO_BAKE_MARK_H_

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace chronormal {

/// A target that a bake added. It moves no vertex, and its weight follows from those of the mesh's own targets
/// (docs/extras.md):
///
///     weight = sum of a w_i + sum of q w_i w_j
struct GltfExtraTarget {
  struct LinearTerm {
    std::size_t i = 0;  ///< a target that is no extra one
    double a = 1;
    friend bool operator==(const LinearTerm&, const LinearTerm&) = default;
  };
  struct QuadraticTerm {
    std::size_t i = 0, j = 0;  ///< targets that are no extra ones
    double q = 1;
    friend bool operator==(const QuadraticTerm&, const QuadraticTerm&) = default;
  };

  std::size_t target = 0;  ///< index among the targets of the mesh
  std::vector<LinearTerm> linear;
  std::vector<QuadraticTerm> quadratic;

  /// The weight, where those of the mesh's own targets are given; weights has one for each target.
  [[nodiscard]] double weight(std::span<const double> weights) const noexcept;
  /// Whether the weight is other than zero where w_i alone is.
  [[nodiscard]] bool follows(std::size_t i) const noexcept;

  friend bool operator==(const GltfExtraTarget&, const GltfExtraTarget&) = default;
};

/// How a bake encodes the normals of targets (workflow/bake.h).
/// kKeys is for sequences; what it writes is marked as harmless.
enum class BakeEncoding { kHarmless, kExact, kEndpoint, kSmallest, kKeys };

/// The encodings by name, for the command line, for JSON and for the mark in a file.
struct BakeEncodingName {
  BakeEncoding encoding;
  std::string_view name;
};
inline constexpr std::array<BakeEncodingName, 5> kBakeEncodings = {{{BakeEncoding::kHarmless, "harmless"},
                                                                    {BakeEncoding::kExact, "exact"},
                                                                    {BakeEncoding::kEndpoint, "endpoint"},
                                                                    {BakeEncoding::kSmallest, "smallest"},
                                                                    {BakeEncoding::kKeys, "keys"}}};
[[nodiscard]] std::string_view name_of(BakeEncoding encoding) noexcept;
/// Nothing where no encoding has that name.
[[nodiscard]] std::optional<BakeEncoding> find_bake_encoding(std::string_view name) noexcept;

/// What a bake leaves in extras.chronormal of a mesh (docs/extras.md), for instance
///     {"version": 2, "encode": "exact", "sequence": false,
///      "extras": [{"target": 2, "linear": [], "quadratic": [[0, 1, 1.0]]}]}
struct GltfBakeMark {
  BakeEncoding encoding = BakeEncoding::kExact;
  bool sequence = false;                ///< the targets are keyframes: alone, from the base, they mean nothing
  std::vector<GltfExtraTarget> extras;  ///< ascending targets; the file need not list any
  bool animations_only = false;         ///< deltas are fitted to the animations of the file, and mean nothing alone
  bool author = false;  ///< normals of each target at weight 1 are what the author of the input would see
};

}  // namespace chronormal

#endif  // CHRONORMAL_IO_BAKE_MARK_H_
