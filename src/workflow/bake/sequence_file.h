/// A GLB file that plays a sequence: one mesh, its targets, and one animation of their weights. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_FILE_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_FILE_H_

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "chronormal/workflow/bake.h"
#include "io/gltf/glb_builder.h"
#include "workflow/bake/sequence_deltas.h"
#include "workflow/bake/sequence_vertices.h"

namespace chronormal {

/// Which target stands for what: first one for each key, key 0 only where some normal needs it, then one for each
/// segment in which normals bend.
struct SequenceTargets {
  bool exact = true;
  bool has_key_0 = false;
  std::size_t keys = 0;
  std::vector<std::size_t> bent_segments;

  [[nodiscard]] std::size_t of_keys() const noexcept { return keys - (has_key_0 ? 0U : 1U); }
  [[nodiscard]] std::size_t count() const noexcept { return of_keys() + bent_segments.size(); }
  /// The target of a key, which must have one.
  [[nodiscard]] std::size_t of_key(std::size_t key) const noexcept { return key - (has_key_0 ? 0U : 1U); }
};

/// What an animation gives the weights: hats over the keys, and t (1 - t) in bent segments. For each key the weights,
/// or of exact, which is a cubic spline, in-tangents, weights and out-tangents.
[[nodiscard]] std::vector<float> weight_track(const SequenceTargets& targets, std::span<const float> times);

[[nodiscard]] GltfBakeMark mark_of(const SequenceTargets& targets);

/// The file while it grows, target by target.
class SequenceFile {
 public:
  /// Writes key 0 with the normals of the elements. vertices must outlive this.
  SequenceFile(const Motion& motion, const SequenceVertices& vertices, std::span<const SequenceElement> elements,
               bool exact, const BakeOptions& options);

  /// Adds a target for a key, with the deltas of its positions against key 0 as SequenceNormals has them; none for
  /// key 0 itself, which only exact has.
  void add_key(std::size_t key, std::span<const float> positions, std::span<const Vec3d> normals);
  /// Of exact: adds a target for the bend of a segment.
  void add_bend(std::size_t segment, std::span<const Vec3d> normals);

  /// Errors: kInvalidInput where the file has too many bytes already.
  [[nodiscard]] Status check_size() const;
  /// Adds the animation and puts the file together. targets must say what was added. Errors: kInvalidInput where it
  /// would be too large.
  [[nodiscard]] Result<std::string> finish(const SequenceTargets& targets, const std::vector<float>& times);

 private:
  void add_target(std::string name, std::size_t positions, std::span<const Vec3d> normals);

  const SequenceVertices& vertices_;
  bool dense_zeros_;
  GlbBuilder builder_;
  std::size_t triangles_ = 0;       // accessor
  std::size_t zero_positions_ = 0;  // accessor that targets share which move nothing; of exact
  nlohmann::ordered_json base_, targets_ = nlohmann::ordered_json::array();
  std::vector<std::string> names_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_FILE_H_
