/// Computes weights of correction targets that follow no formula. Such weights are curves over the tracks of a file.
/// Private to workflow.
///
/// A curve has values at nodes. Nodes are the keys of a track and, if the weights of the track change between two keys,
/// the ends and middles of equal pieces of each gap between keys. In each piece the curve is a parabola through the
/// three nodes:
///
///     STEP, or a single key    a node at each key; curves are constant between keys, as the track is
///     LINEAR                   one piece per gap if the true normals are weighted by area, because n(w(t)) and the
///                              missing normals are then quadratic there; otherwise WeightTrack::pieces_of_line pieces
///     CUBICSPLINE              two, four or eight pieces per gap, so that parabolas are near squares of weights
///
/// Threads    All functions are pure.
#ifndef CHRONORMAL_WORKFLOW_BAKE_POSES_EXTRA_CURVES_H_
#define CHRONORMAL_WORKFLOW_BAKE_POSES_EXTRA_CURVES_H_

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

/// The nodes of a track: the instants at which the curves over the track have values.
class CurveNodes {
 public:
  explicit CurveNodes(const WeightTrack& track);
  /// Creates the nodes at which `curves` has values. `curves` are the curves over this track.
  CurveNodes(const WeightTrack& track, const ExtraCurves& curves);

  [[nodiscard]] std::size_t size() const noexcept { return pieces_ == 0 ? keys_ : 2 * pieces_ * (keys_ - 1) + 1; }
  /// Returns the number of pieces in each gap between two keys, or 0 if curves are constant between keys.
  [[nodiscard]] std::size_t pieces() const noexcept { return pieces_; }
  /// Returns the weights of the mesh's own targets at a node.
  [[nodiscard]] std::vector<double> pose(const WeightTrack& track, std::size_t node) const;

  /// A place in the gap after a key. The value of a curve at this place is the sum of the curve's values at three
  /// nodes, each multiplied by its factor.
  struct Place {
    std::array<std::size_t, 3> nodes{};
    std::array<double, 3> factors{};
  };
  [[nodiscard]] Place place(std::size_t key, double part) const noexcept;

 private:
  std::size_t keys_, pieces_;
};

/// The curves of all correction targets over one track. The values have the shape (nodes, extras).
struct ExtraCurves {
  std::size_t extras = 0;
  std::vector<double> values;

  /// Returns the weights of all correction targets at one node.
  [[nodiscard]] std::span<const double> of(std::size_t node) const {
    return std::span(values).subspan(node * extras, extras);
  }
  /// Writes the weights of the correction targets in the gap after key `key`. `part` is the position in this gap, from
  /// 0 to 1.
  void at(const CurveNodes& nodes, std::size_t key, double part, std::span<double> weights) const;
};

using TrackCurves = std::map<TrackName, ExtraCurves>;

/// Extends a track by curves. A LINEAR track stays LINEAR if `pieces` has numbers of pieces for its gaps
/// (straight_track), and otherwise becomes a cubic spline. A cubic spline gets more keys at the ends of the curves'
/// pieces. The weights of the mesh's own targets are played as before, and the weights of correction targets follow the
/// curves exactly. If all this takes more than most_keys keys, the result has no values, but the number of keys that it
/// would have.
[[nodiscard]] ExtendedTrack track_with_curves(const WeightTrack& track, const ExtraCurves& curves,
                                              std::span<const std::uint32_t> pieces,
                                              std::size_t most_keys = std::numeric_limits<std::size_t>::max());

/// The number of straight pieces into which each gap between two keys of a LINEAR track is split, by the name of the
/// track.
using TrackPieces = std::map<TrackName, std::vector<std::uint32_t>>;

/// The data from which the weights of a mesh's correction targets follow. Formulas have one term in the weights of the
/// mesh's own targets, and sums have many such terms. Curves give the weights over tracks.
struct ExtraDrivers {
  std::vector<ExtraWeight> formulas;  ///< one for each correction target; all zero if there are sums or curves
  /// The weights as sums of terms: one sum for each correction target, or none. If there are sums, tracks have curves
  /// as well.
  std::vector<GltfExtraTarget> sums;
  TrackCurves curves;  ///< the curves of each track; empty if there are formulas
  PoseList rest;       ///< for curves, the weights in the poses that the file stores (MeshWeights)
  TrackPieces pieces;  ///< set for LINEAR tracks that stay LINEAR; others become cubic splines
  /// The tolerance of cubic splines, an angle in radians. Splines get more keys until the errors of formulas turn no
  /// normal by more than this angle. If this angle is infinite, splines get no more keys.
  double spline_tolerance = std::numeric_limits<double>::infinity();

  [[nodiscard]] std::size_t size() const noexcept { return formulas.size(); }
  /// Returns correction target k in the form in which the file describes it. `index` is the index of this target among
  /// all targets of the mesh.
  [[nodiscard]] GltfExtraTarget as_target(std::size_t k, std::size_t index) const;
  /// Returns a pose with the weights of correction targets appended to the weights of own targets. Formulas or sums
  /// give the appended weights.
  [[nodiscard]] std::vector<double> with_extras(std::vector<double> own) const;
  /// Returns poses outside of animations with the weights of correction targets appended. If curves drive the
  /// correction targets, `rest` has these weights for the first poses. All later poses are expressions of an avatar, in
  /// which these weights are zero.
  [[nodiscard]] PoseList standing(const PoseList& poses) const;
  /// Returns a track with the weights of correction targets. Cubic splines get more keys until the errors of formulas
  /// turn no normal by more than the smaller of `tolerance` and spline_tolerance, in radians. If the track needs more
  /// than most_keys keys, the result has no values.
  [[nodiscard]] ExtendedTrack extended(const TrackName& name, const WeightTrack& track, double tolerance,
                                       std::size_t most_keys = std::numeric_limits<std::size_t>::max()) const;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_EXTRA_CURVES_H_
