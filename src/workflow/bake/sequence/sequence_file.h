/// A GLB file that plays a sequence: one mesh, its targets, and one animation of their weights. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_FILE_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_FILE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/workflow/bake.h"
#include "io/bytes/expansion.h"
#include "io/bytes/spool.h"
#include "io/gltf/glb/glb_builder.h"
#include "workflow/bake/sequence/sequence_deltas.h"

namespace chronormal::inline internal {

/// The meaning of the targets: first one for each key (key 0 only if some normal needs it), then one for each segment
/// in which normals bend.
struct SequenceTargets {
  BakeEncoding encoding = BakeEncoding::kExact;
  bool has_key_0 = false;
  std::size_t keys = 0;
  std::vector<std::size_t> bent_segments;

  [[nodiscard]] std::size_t of_keys() const noexcept { return keys - (has_key_0 ? 0U : 1U); }
  [[nodiscard]] std::size_t count() const noexcept { return of_keys() + bent_segments.size(); }
  /// Returns the target of a key, which must have one.
  [[nodiscard]] std::size_t of_key(std::size_t key) const noexcept { return key - (has_key_0 ? 0U : 1U); }
};

/// The vertices of a file. The vertices of the motion come first, and then their copies, one for each further normal.
struct SequenceVertices {
  static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

  std::vector<std::uint32_t> vertex;     ///< of each: its vertex in the motion
  std::vector<std::uint32_t> element;    ///< of each: the element whose normal it shows; kNone if it has no face
  std::vector<std::uint32_t> of_corner;  ///< of each corner of the motion

  bool are_of_motion = false;  ///< there are no copies
  bool are_elements = false;   ///< vertex i shows the normal of element i, and there are no other elements

  [[nodiscard]] std::size_t size() const noexcept { return vertex.size(); }
  /// Returns the position of each vertex of the file, from the positions of the motion, (V, 3): the given array, or a
  /// new one in `room`.
  [[nodiscard]] std::span<const float> positions(std::span<const float> of_motion, std::vector<float>& room) const;
  /// Returns the vector of each vertex of the file, from the vectors of elements, (E, 3), and `none` for vertices
  /// without a face: the given array, or a new one in `room`.
  [[nodiscard]] std::span<const float> vectors(std::span<const float> of_elements, const Vec3f& none,
                                               std::vector<float>& room) const;
};

/// The keys of an animation, and the values of its weights in rows, with one value for each target. Each key has one
/// row or, in a cubic spline, three: in-tangents, weights and out-tangents. Rows are computed one by one, since their
/// number and their width both grow with the number of keys.
struct SequenceTrack {
  std::vector<float> times;
  std::size_t rows = 0, width = 0;
  std::function<void(std::size_t row, std::span<float> values)> fill;  ///< writes one row over zeros
};

/// The file while it grows, target by target. Its arrays go to the spool as they are made.
class SequenceFile {
 public:
  /// Writes key 0, whose positions are `base`, with the normals of the elements, and polygons as fans of triangles
  /// (which keep the normals of the polygons). The topology must outlive this.
  SequenceFile(const Topology& topology, const NormalGroups& groups, std::span<const float> base,
               std::span<const SequenceElement> elements, const BakeOptions& options, Spool spool);

  /// Places the node at the origin from which positions count.
  void set_origin(const std::array<double, 3>& origin) { origin_ = origin; }

  /// Begins again with other elements, as if nothing had been added.
  void restart(std::span<const float> base, std::span<const SequenceElement> elements);

  [[nodiscard]] std::size_t vertex_count() const noexcept { return vertices_.size(); }

  /// Adds a target for a key, with the deltas of its positions from key 0 as SequenceNormals returns them; none for key
  /// 0 itself. normals has one float32 vector for each element, (E, 3).
  void add_key(std::size_t key, std::span<const float> positions, std::span<const float> normals);
  void add_key(std::size_t key, std::span<const float> positions, std::span<const Vec3d> normals);
  /// Adds a target for the bend of a segment; there may be several. Bends come after all other targets, whenever they
  /// are added.
  void add_bend(std::size_t segment, std::span<const float> normals);
  void add_bend(std::size_t segment, std::span<const Vec3d> normals);

  /// Checks the size of the file. Errors: kInvalidInput if the file has too many bytes, or would have with `more`;
  /// errors of the spool.
  [[nodiscard]] Status check(std::uint64_t more = 0) const;
  /// Adds the animation, puts the file together and passes its bytes to `take`. Returns their number. targets must
  /// describe what was added. Errors: see GlbBuilder::finish()
  [[nodiscard]] Result<std::size_t> finish(const SequenceTargets& targets, const std::vector<float>& times,
                                           const GlbBuilder::Take& take);

 private:
  // Takes in `rest` the weights of the mesh that no animation plays.
  [[nodiscard]] Result<std::size_t> finish(const SequenceTrack& track, std::string_view interpolation,
                                           const GltfBakeMark& mark, const std::vector<int>& rest,
                                           const GlbBuilder::Take& take);

 private:
  std::array<double, 3> origin_ = {};
  struct Target {
    std::string name;
    std::size_t positions = 0, normals = 0;  // accessors
  };

  void begin(std::span<const float> base, std::span<const SequenceElement> elements);
  [[nodiscard]] Target target(std::string name, std::size_t positions, std::span<const float> normals);
  [[nodiscard]] std::size_t add_positions(std::span<const float> of_motion);
  // Returns the accessor that all targets share that move nothing.
  [[nodiscard]] std::size_t zero_positions();
  [[nodiscard]] std::span<const float> rounded(std::span<const Vec3d> of_elements);

  SequenceVertices vertices_;
  const Topology* topology_;
  std::optional<std::size_t> most_bytes_;
  bool dense_zeros_;
  Expansion expansion_;
  GlbBuilder builder_;
  std::size_t triangles_ = 0, base_positions_ = 0, base_normals_ = 0;  // accessors
  std::optional<std::size_t> zero_positions_;
  std::vector<Target> targets_, bends_;
  std::vector<float> rounded_, room_;  // scratch memory for arrays of the file
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_FILE_H_
