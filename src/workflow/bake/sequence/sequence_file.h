/// Writes a GLB file that plays a sequence. The file has one mesh, its targets, and one animation of their weights.
/// Private to workflow.
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

/// The order of the targets in the file. First, each key has a target (key 0 only if some normal needs it). Then each
/// segment in which normals bend has a target.
struct SequenceTargets {
  BakeEncoding encoding = BakeEncoding::kExact;
  bool has_key_0 = false;
  std::size_t keys = 0;
  std::vector<std::size_t> bent_segments;
  /// True if normals at keys are right, but are not area-weighted sums over the triangles of the file. The mark of the
  /// file then says so (GltfBakeMark::author).
  bool follow_author = false;

  [[nodiscard]] std::size_t of_keys() const noexcept { return keys - (has_key_0 ? 0U : 1U); }
  [[nodiscard]] std::size_t count() const noexcept { return of_keys() + bent_segments.size(); }
  /// Returns the index of a key's target. The key must have a target.
  [[nodiscard]] std::size_t of_key(std::size_t key) const noexcept { return key - (has_key_0 ? 0U : 1U); }
};

/// The vertices of a file. First come the vertices of the motion. If a vertex shows several normals, the file also has
/// a copy of the vertex for each further normal, after all vertices of the motion.
struct SequenceVertices {
  static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

  std::vector<std::uint32_t> vertex;   ///< for each vertex of the file, its vertex in the motion
  std::vector<std::uint32_t> element;  ///< for each vertex, the element whose normal it shows; kNone if it has no face
  std::vector<std::uint32_t> of_corner;  ///< for each corner of the motion, its vertex in the file

  bool are_of_motion = false;  ///< true if the vertices are those of the motion, without copies
  bool are_elements = false;   ///< true if vertex i shows element i, and there are no other elements

  [[nodiscard]] std::size_t size() const noexcept { return vertex.size(); }
  /// Returns the positions of the file's vertices. of_motion has the positions of the motion's vertices, (V, 3). The
  /// result is this array if there are no copies, and otherwise a new array in `room`.
  [[nodiscard]] std::span<const float> positions(std::span<const float> of_motion, std::vector<float>& room) const;
  /// Returns a vector for each vertex of the file. of_elements has the vectors of elements, (E, 3), and vertices
  /// without a face get `none`. The result is of_elements itself, or a new array in `room`.
  [[nodiscard]] std::span<const float> vectors(std::span<const float> of_elements, const Vec3f& none,
                                               std::vector<float>& room) const;
};

/// The keys of an animation, and the values of its weights. The values are rows with one value for each target. Each
/// key has one row or, in a cubic spline, three rows: in-tangents, weights and out-tangents. Rows are computed one at a
/// time, because the number of rows and the length of a row both grow with the number of keys.
struct SequenceTrack {
  std::vector<float> times;
  std::size_t rows = 0, width = 0;
  /// Writes one row of values. All values of the row must be 0 before the call.
  std::function<void(std::size_t row, std::span<float> values)> fill;
};

/// The file while targets are added to it. Arrays of the file are written to the spool as soon as they are made.
class SequenceFile {
 public:
  /// Begins the file with key 0, which has the positions `base` and the normals of the elements. Polygons become fans
  /// of triangles, but keep the normals of the polygons. The topology must outlive this object.
  SequenceFile(const Topology& topology, const NormalGroups& groups, std::span<const float> base,
               std::span<const SequenceElement> elements, const BakeOptions& options, Spool spool);

  /// Sets the origin that was subtracted from all positions. The node of the mesh is moved to this origin.
  void set_origin(const std::array<double, 3>& origin) { origin_ = origin; }

  /// Begins the file again with other elements. Drops all targets that were added.
  void restart(std::span<const float> base, std::span<const SequenceElement> elements);

  [[nodiscard]] std::size_t vertex_count() const noexcept { return vertices_.size(); }

  /// Adds a target for a key. `positions` has the key's float32 deltas from key 0, as SequenceNormals returns them. For
  /// key 0, `positions` is empty. `normals` has one vector for each element, (E, 3).
  void add_key(std::size_t key, std::span<const float> positions, std::span<const float> normals);
  void add_key(std::size_t key, std::span<const float> positions, std::span<const Vec3d> normals);
  /// Adds a target for a bend of a segment. A segment may have several bends. In the file, bends come after the targets
  /// of keys, whatever the order of the calls.
  void add_bend(std::size_t segment, std::span<const float> normals);
  void add_bend(std::size_t segment, std::span<const Vec3d> normals);

  /// Checks the size of the file. Errors: kInvalidInput if the file has too many bytes, or would have too many after
  /// `more` bytes are added; those of the spool.
  [[nodiscard]] Status check(std::uint64_t more = 0) const;
  /// Adds the animation, completes the file, and passes its bytes to `take`. Returns the number of bytes. `targets`
  /// must describe the targets that were added. Errors: those of GlbBuilder::finish().
  [[nodiscard]] Result<std::size_t> finish(const SequenceTargets& targets, const std::vector<float>& times,
                                           const GlbBuilder::Take& take);

 private:
  // Completes the file with this track. `rest` has the weights that the mesh shows while no animation plays.
  [[nodiscard]] Result<std::size_t> finish(const SequenceTrack& track, std::string_view interpolation,
                                           const GltfBakeMark& mark, const std::vector<int>& rest,
                                           const GlbBuilder::Take& take);

 private:
  std::array<double, 3> origin_ = {};
  struct Target {
    std::string name;
    std::size_t positions = 0, normals = 0;  // indices of accessors
  };

  void begin(std::span<const float> base, std::span<const SequenceElement> elements);
  [[nodiscard]] Target target(std::string name, std::size_t positions, std::span<const float> normals);
  [[nodiscard]] std::size_t add_positions(std::span<const float> of_motion);
  // Returns the accessor of zeros, which all targets that move no vertex share.
  [[nodiscard]] std::size_t zero_positions();
  [[nodiscard]] std::span<const float> rounded(std::span<const Vec3d> of_elements);

  SequenceVertices vertices_;
  const Topology* topology_;
  std::optional<std::size_t> most_bytes_;
  bool dense_zeros_;
  Expansion expansion_;
  GlbBuilder builder_;
  std::size_t triangles_ = 0, base_positions_ = 0, base_normals_ = 0;  // indices of accessors
  std::optional<std::size_t> zero_positions_;
  std::vector<Target> targets_, bends_;
  std::vector<float> rounded_, room_;  // memory that is used for one array of the file after another
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_FILE_H_
