/// Weights of extra targets that follow from no formula: curves over the tracks of a file. Private to workflow.
///
/// A curve is given by its values at nodes: the keys of a track, and where that moves between them, the ends and the
/// middles of equal pieces of each gap between two keys, through which it runs as a parabola for each piece:
///
///     STEP, or a single key    a node at each key; curves hold still as the track does
///     LINEAR                   a piece for each gap where the truth is by area: n(w(t)), and with it all that is
///                              missing, is quadratic there; else as many as the track says
///     CUBICSPLINE              two, four or eight pieces for each gap, so that parabolas are near squares of weights
///
/// Threads    pure
#ifndef CHRONORMAL_WORKFLOW_BAKE_LOW_RANK_EXTRA_CURVES_H_
#define CHRONORMAL_WORKFLOW_BAKE_LOW_RANK_EXTRA_CURVES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "workflow/bake/poses/mesh_weights.h"
#include "workflow/bake/poses/tracks.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

struct ExtraCurves;

/// The nodes of a track.
class CurveNodes {
 public:
  explicit CurveNodes(const WeightTrack& track);
  /// The nodes that curves over the track were made with.
  CurveNodes(const WeightTrack& track, const ExtraCurves& curves);

  [[nodiscard]] std::size_t size() const noexcept { return pieces_ == 0 ? keys_ : 2 * pieces_ * (keys_ - 1) + 1; }
  /// Pieces of each gap; 0 where curves hold still between keys.
  [[nodiscard]] std::size_t pieces() const noexcept { return pieces_; }
  /// The weights of the mesh's own targets at a node.
  [[nodiscard]] std::vector<double> pose(const WeightTrack& track, std::size_t node) const;

  /// The nodes that a curve follows from at a part of the gap after a key, and with what factors.
  struct Place {
    std::array<std::size_t, 3> nodes{};
    std::array<double, 3> factors{};
  };
  [[nodiscard]] Place place(std::size_t key, double part) const noexcept;

 private:
  std::size_t keys_, pieces_;
};

/// The curves of all extra targets over one track: values (nodes, extras).
struct ExtraCurves {
  std::size_t extras = 0;
  std::vector<double> values;

  /// Those of one node.
  [[nodiscard]] std::span<const double> of(std::size_t node) const {
    return std::span(values).subspan(node * extras, extras);
  }
  /// Writes the weights of the extra targets at a part of the gap after a key.
  void at(const CurveNodes& nodes, std::size_t key, double part, std::span<double> weights) const;
};

using TrackCurves = std::map<TrackName, ExtraCurves>;

/// Extends a track by curves. A LINEAR track stays one, in as many pieces of each gap as are asked for
/// (straight_track), or becomes a cubic spline where none are; a cubic spline is cut at the ends of the curves' pieces,
/// where it plays as before, and holds the curves exactly. Where that takes more than most_keys, the result has no
/// values, but says how many keys it would have.
[[nodiscard]] ExtendedTrack track_with_curves(const WeightTrack& track, const ExtraCurves& curves,
                                              std::span<const std::uint32_t> pieces,
                                              std::size_t most_keys = std::numeric_limits<std::size_t>::max());

/// How many pieces each gap between two keys of a LINEAR track is cut into.
using TrackPieces = std::map<TrackName, std::vector<std::uint32_t>>;

/// What drives the extra targets of a mesh: formulas of the weights of its own targets, of one term or of many, or
/// curves.
struct ExtraDrivers {
  std::vector<ExtraWeight> formulas;  ///< one for each extra target; all zero where there are sums or curves
  std::vector<GltfExtraTarget> sums;  ///< one for each extra target, or none; tracks have curves beside them
  TrackCurves curves;                 ///< for each track; none where there are formulas
  PoseList rest;                      ///< of curves: the weights in the poses that the file stores (MeshWeights)
  TrackPieces pieces;                 ///< of the LINEAR tracks that stay LINEAR; others become cubic splines
  /// Radians: cubic splines get keys for formulas until no normal is off by more. Infinite: they get none.
  double spline_tolerance = std::numeric_limits<double>::infinity();

  [[nodiscard]] std::size_t size() const noexcept { return formulas.size(); }
  /// What the file says of extra target k, which is the target of this index.
  [[nodiscard]] GltfExtraTarget as_target(std::size_t k, std::size_t index) const;
  /// The same pose with the weights of extra targets behind it, by formulas and sums.
  [[nodiscard]] std::vector<double> with_extras(std::vector<double> own) const;
  /// The poses that stand still, with the weights of extra targets behind them. Nothing gives these a weight by curves in
  /// the expressions of an avatar, which are the poses behind those of `rest`.
  [[nodiscard]] PoseList standing(const PoseList& poses) const;
  /// A track with the weights of extra targets. Cubic splines get keys for formulas until no normal is off by more than
  /// tolerance (radians) or spline_tolerance. Where that takes more than most_keys, the result has no values.
  [[nodiscard]] ExtendedTrack extended(const TrackName& name, const WeightTrack& track, double tolerance,
                                       std::size_t most_keys = std::numeric_limits<std::size_t>::max()) const;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_LOW_RANK_EXTRA_CURVES_H_
