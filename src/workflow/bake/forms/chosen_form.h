/// What a bake writes for each vertex of a mesh: the best of its forms that does no harm in the hosts that are named.
/// Private to workflow.
///
///     harmless   stored | end points | and extra targets of one | of all      harmless_form
///     endpoint   stored | the best delta of each target alone | fitted ones   deltas
///
/// A vertex that keeps the stored form has its own deltas, as the author left them, and takes no part in extra targets.
#ifndef CHRONORMAL_WORKFLOW_BAKE_FORMS_CHOSEN_FORM_H_
#define CHRONORMAL_WORKFLOW_BAKE_FORMS_CHOSEN_FORM_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "workflow/bake/exact/deltas.h"
#include "workflow/bake/forms/harmless_form.h"
#include "workflow/bake/judge/host_judge.h"
#include "workflow/bake/low_rank/extra_curves.h"
#include "workflow/bake/mesh_weights.h"
#include "workflow/bake/undriven/quadratic_fit.h"

namespace chronormal::inline internal {

struct OwnForm;  // smallest_form.h

class ChosenForm {
 public:
  ExtraDrivers drivers;             ///< of extra targets
  std::vector<HostChange> hosts;    ///< of those that are named
  std::size_t kept = 0;             ///< different normals that keep what is stored, though targets move them
  std::size_t left_out = 0;         ///< extra targets beyond the limit of the hosts
  double track_error = 0;           ///< radians: of straight pieces between keys, at worst
  double fit_error = 0;             ///< radians: a bound for the deltas of targets alone, of endpoint
  bool animations_only = false;     ///< its deltas mean nothing for a target alone
  std::vector<BakeChoice> choices;  ///< of smallest: what was looked at

  /// What is written for each of the judged vertices.
  [[nodiscard]] VertexColumns columns(const GltfShading& shading) const;
  [[nodiscard]] std::span<const std::uint32_t> judged() const { return vertices_; }
  /// The deltas of the mesh's own targets where these are other than what the file stores.
  [[nodiscard]] const std::vector<VertexVectors>& own() const { return own_of_form_.back(); }
  /// About how many bytes the arrays of deltas take, and the sums that drive extra targets.
  [[nodiscard]] std::size_t bytes(const GltfShading& shading) const;
  /// Whether anything becomes other than it is stored.
  [[nodiscard]] bool changes(const GltfShading& shading) const;
  /// The deltas of a target of the mesh; nothing where all of them stay as they are.
  [[nodiscard]] std::optional<TargetDeltas> own_deltas(const GltfShading& shading, std::size_t target) const;
  /// Those of an extra target.
  [[nodiscard]] TargetDeltas extra_deltas(const GltfShading& shading, std::size_t extra) const;

 private:
  friend ChosenForm choose_of_lengths(const DeltaSource&, const MeshWeights&, const BakeOptions&, FormLengths);
  friend ChosenForm choose_endpoint(const DeltaSource&, const MeshWeights&, const BakeOptions&);
  friend ChosenForm keep_stored(const DeltaSource&);
  friend class WorthwhileForms;
  friend ChosenForm choose_low_rank(const DeltaSource&, const RightNormals&, const MeshWeights&, const BakeOptions&,
                                    FormLengths, const OwnForm&, std::size_t);
  friend ChosenForm with_quadratics(const DeltaSource&, const MeshWeights&, FormLengths, const ChosenForm&,
                                    QuadraticFit::Extras);
  friend ChosenForm settled_quadratics(const DeltaSource&, const MeshWeights&, const BakeOptions&, ChosenForm);

  // The deltas of the mesh's own targets in a form other than the stored one.
  [[nodiscard]] const std::vector<VertexVectors>& own_of(std::uint8_t form) const;

  std::vector<std::uint32_t> vertices_;                  // that are judged
  std::vector<std::uint8_t> choice_;                     // of each of them
  std::vector<std::vector<VertexVectors>> own_of_form_;  // of each form but the stored one; the last has all others
  std::vector<VertexVectors> extras_;                    // of the last form
};

/// Chooses among the harmless forms whose vectors are such. shading must have its deltas, and base_normals of the
/// source be those that will be stored.
[[nodiscard]] ChosenForm choose_of_lengths(const DeltaSource& source, const MeshWeights& weights,
                                           const BakeOptions& options, FormLengths lengths);

/// Chooses among the harmless forms of the lengths that the named hosts keep. Opposite weights are taken where they are
/// better by far: they need twice as many targets for each correction.
[[nodiscard]] ChosenForm choose_harmless(const DeltaSource& source, const MeshWeights& weights,
                                         const BakeOptions& options);

/// Chooses among the forms without extra targets; only hosts that add up what is stored are binding.
[[nodiscard]] ChosenForm choose_endpoint(const DeltaSource& source, const MeshWeights& weights,
                                         const BakeOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_CHOSEN_FORM_H_
