/// glTF 2.0 files (.gltf, .glb, .vrm): their contents, and their morphing meshes as arrays.
///
/// Opening a document maps the file and reads only its JSON. Geometry and tracks are read on request, so callers only
/// pay for the parts that they need. All parts of the format that concern normals over time are supported: external
/// buffers, data URIs, sparse accessors, byteStride, normalised integers, accessors without a bufferView, primitives
/// without indices, strips and fans, KHR_mesh_quantization, EXT_meshopt_compression, KHR_draco_mesh_compression and
/// KHR_animation_pointer. Everything that is read is checked strictly by the specification; materials, textures and the
/// bounds of accessors are neither read nor checked. Skins and animations of nodes are read only by callers that need
/// skins, and only these callers get errors about them.
///
/// A file that requires another extension is refused, and the message names the extension. Extensions of materials,
/// textures and lights are allowed, since they do not touch geometry.
///
/// Errors     kInvalidInput with the file and a JSON pointer as the place ("walk.gltf, /accessors/3/count"), or a byte
///            offset if the file is not JSON.
/// Threads    a document belongs to one thread at a time, since it keeps decompressed pieces.
#ifndef CHRONORMAL_IO_GLTF_DOCUMENT_H_
#define CHRONORMAL_IO_GLTF_DOCUMENT_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal {

inline namespace internal {
class Expansion;  // limits the memory and the output that reading a file may cause
}

// The mark of a bake in a glTF file: the encoding of the normals, and the formulas of correction targets
// (docs/formats.md).
//
// Threads    these are plain values.

/// A correction target, which a bake has added to a mesh. It moves no vertex. Its weight follows from the weights of
/// the targets that the mesh had before, which are called its own (docs/formats.md):
///
///     weight = sum of a w_i + sum of q w_i w_j
struct GltfExtraTarget {
  struct LinearTerm {
    std::size_t i = 0;  ///< index of one of the mesh's own targets
    double a = 1;
    friend bool operator==(const LinearTerm&, const LinearTerm&) = default;
  };
  struct QuadraticTerm {
    std::size_t i = 0, j = 0;  ///< indices of two of the mesh's own targets; they may be equal
    double q = 1;
    friend bool operator==(const QuadraticTerm&, const QuadraticTerm&) = default;
  };

  std::size_t target = 0;  ///< index among the targets of the mesh
  std::vector<LinearTerm> linear;
  std::vector<QuadraticTerm> quadratic;

  /// Returns the weight of this target for the given weights of the mesh's own targets.
  [[nodiscard]] double weight(std::span<const double> weights) const noexcept;
  /// Returns true if the weight of this correction target is nonzero when own target i has the only nonzero weight.
  [[nodiscard]] bool follows(std::size_t i) const noexcept;

  friend bool operator==(const GltfExtraTarget&, const GltfExtraTarget&) = default;
};

/// The ways in which a bake encodes the normals of targets (workflow/bake.h). kKeys is for sequences; a file with this
/// encoding is marked as kHarmless.
enum class BakeEncoding { kHarmless, kExact, kEndpoint, kSmallest, kKeys };

/// An encoding, and its name on the command line, in JSON and in the mark of a file.
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
/// Finds an encoding by its name. Returns no value for an unknown name.
[[nodiscard]] std::optional<BakeEncoding> find_bake_encoding(std::string_view name) noexcept;

/// The mark that a bake leaves in extras.chronormal of a mesh (docs/formats.md), for instance
///     {"version": 2, "encode": "exact", "sequence": false,
///      "extras": [{"target": 2, "linear": [], "quadratic": [[0, 1, 1.0]]}]}
struct GltfBakeMark {
  BakeEncoding encoding = BakeEncoding::kExact;
  bool sequence = false;  ///< true if the targets are keyframes, which have no meaning one by one
  /// The correction targets, in the order of the mesh's targets; empty if the mark lists none.
  std::vector<GltfExtraTarget> extras;
  /// True if the deltas are fitted to the animations of the file, and meaningless at weights that no animation has.
  bool animations_only = false;
  /// True if the normals of targets at weight 1 are those that the author would see (docs/cli.md), not area-weighted
  /// sums.
  bool author = false;
};

inline namespace internal {
class FileBytes;
class GltfSkin;
}

/// A function that returns the bytes of a file by its name, for callers that do not read from the file system. The
/// bytes must outlive everything that was opened with these bytes. An error that the function returns is passed on to
/// the caller.
using FileResolver = std::function<Result<std::string_view>(const std::string& name)>;

/// The interpolation of the weights of targets between two keys of an animation.
enum class GltfInterpolation { kLinear, kStep, kCubicSpline };

struct GltfPrimitive {
  /// The kind of primitive by its number in glTF: 4 for triangles, 5 for a strip, 6 for a fan. Primitives of other
  /// kinds (points, lines) have no faces.
  int mode = 4;
  std::size_t vertex_count = 0;   ///< number of vertices; 0 if the primitive has no POSITION
  std::size_t element_count = 0;  ///< number of indices, or number of vertices if there are no indices
  bool has_normals = false, has_tangents = false, has_draco = false;
  /// The attributes for which a morph target has deltas.
  struct Target {
    bool positions = false, normals = false, tangents = false;
  };
  std::vector<Target> targets;

  [[nodiscard]] bool has_faces() const noexcept { return mode >= 4 && mode <= 6 && vertex_count > 0; }
};

/// An expression of a VRM avatar (version 0 or 1): the weights that it gives the targets of a mesh at full strength.
struct GltfExpression {
  std::string name;             ///< as in the file; may be empty
  std::vector<double> weights;  ///< a weight for each target of the mesh
  friend bool operator==(const GltfExpression&, const GltfExpression&) = default;
};

struct GltfMesh {
  std::string name;
  std::vector<GltfPrimitive> primitives;
  std::size_t target_count = 0;             ///< number of morph targets, which is equal in all primitives
  std::vector<std::string> target_names;    ///< extras.targetNames if it has a name for each target; otherwise empty
  std::vector<double> weights;              ///< the default weight of each target; 0 if the file has none
  std::vector<GltfExpression> expressions;  ///< the expressions of a VRM avatar that set weights of this mesh
  std::optional<GltfBakeMark> mark;         ///< the mark of a bake, if the mesh has one that can be understood
  /// The error in the mark of a bake, if the mark cannot be understood. Only some callers report this error.
  std::optional<Error> mark_fault;
};

struct GltfNode {
  std::string name;
  std::optional<std::uint32_t> mesh, parent;
  bool has_skin = false;
  std::optional<std::uint32_t> skin;  ///< the index of the node's skin in the file, if that index is valid
  std::vector<double> weights;        ///< the node's own weights; if empty, the node uses those of its mesh
};

/// The animation of the weights of one node. It comes from a channel for the node, or from a channel of
/// KHR_animation_pointer for all weights of the node or of its mesh. If the channel is for a mesh, each node with this
/// mesh that has no weights of its own gets such a track.
struct GltfTrack {
  std::size_t node = 0, channel = 0;
  /// The index of the first track in the animation that has the same keys, interpolation and number of targets as this
  /// track, and therefore the same weights.
  std::size_t same_keys_as = 0;
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  std::size_t key_count = 0;
  /// True if the track was assembled from several channels of KHR_animation_pointer, one for each weight. `channel` is
  /// then the first of these channels. The track has the keys of all channels, and is cubic if one channel is cubic.
  /// Files in which only some of these channels are STEP are refused.
  bool is_assembled = false;
};

/// A channel that drives all weights of a node, but breaks a rule of the format. `output` is the accessor of the weights.
struct GltfUnreadTrack {
  std::size_t node = 0, channel = 0;
  std::optional<std::size_t> output;
};

struct GltfAnimation {
  std::string name;
  std::size_t channel_count = 0;  ///< number of channels of all kinds, including those without weights
  std::vector<GltfTrack> tracks;  ///< the channels that animate weights
  std::vector<GltfUnreadTrack> unread;
};

/// The keys of a track. K is the number of keys, N the number of targets of the mesh.
struct GltfKeys {
  std::vector<double> times;  ///< the times of the keys in seconds, (K), ascending; the file stores float32
  /// The values at the keys, (K, N). For a cubic spline they are (K, 3, N): in-tangents per second, values,
  /// out-tangents.
  std::vector<double> values;
};

/// The arrays of one primitive, decoded to float32 and to triangles.
struct GltfGeometry {
  /// The vertices of each triangle, (F, 3); strips and fans are converted to triangles.
  std::vector<std::uint32_t> corners;
  std::vector<float> positions;  ///< the positions of the vertices, (V, 3), in units of length of the file
  std::vector<float> normals;    ///< the stored normals, (V, 3), or empty if the primitive has none
  std::vector<float> tangents;   ///< the stored tangents, (V, 4), or empty if the primitive has none
  /// The deltas of one target, (V, 3) each. An array is empty if the target has no such deltas.
  struct Target {
    std::vector<float> positions, normals, tangents;
  };
  std::vector<Target> targets;
};

/// The primitive from which some vertices and faces of a motion or a mesh come.
struct GltfPart {
  std::optional<std::size_t> node;  ///< the node that shows the mesh; no value if nodes do not matter
  std::size_t mesh = 0, primitive = 0;
  std::size_t first_vertex = 0, vertex_count = 0;
  std::size_t first_face = 0, face_count = 0;
};

struct GltfOptions {
  bool allow_external = false;  ///< true if buffers may be in files outside of the asset's folder
  /// The largest number of bytes for the arrays of one primitive. A small file can ask for huge arrays, so a limit is
  /// needed.
  std::size_t most_bytes = addressable(std::uint64_t{4} << 30);
  std::size_t max_expansion = 100;  ///< the limit of memory, as a multiple of the file's size (InputOptions)
  bool strict = false;              ///< true to refuse files for which GltfDocument::notes() would not be empty
  /// A function that finds buffers and images by their paths below the asset's folder. If the function is empty,
  /// buffers and images are read from the file system.
  FileResolver resolve = {};
};

class GltfDocument {
 public:
  /// Opens a file; "-" is the standard input. Errors: kFailed with the path as the place if the file cannot be read;
  /// kInvalidInput, with a JSON pointer or a byte offset, if the file is not valid glTF.
  [[nodiscard]] static Result<GltfDocument> open(const std::string& path, const GltfOptions& options = {});

  /// Reads a document from bytes, which must outlive the document. `name` is used in messages. `folder` is the folder
  /// of the files to which the document refers; without it, such files cannot be read.
  [[nodiscard]] static Result<GltfDocument> read(std::string_view bytes, const std::string& name,
                                                 const std::optional<std::string>& folder = std::nullopt,
                                                 const GltfOptions& options = {});
  /// Reads a document from an open file (io/bytes/file.h). The document takes ownership of the file.
  [[nodiscard]] static Result<GltfDocument> read(FileBytes file, const std::string& name,
                                                 const std::optional<std::string>& folder = std::nullopt,
                                                 const GltfOptions& options = {});

  /// Returns true if bytes look like a glTF file, that is, like a GLB file or like JSON that begins with an object.
  [[nodiscard]] static bool recognises(std::string_view first_bytes) noexcept;

  GltfDocument(GltfDocument&&) noexcept;
  GltfDocument& operator=(GltfDocument&&) noexcept;
  GltfDocument(const GltfDocument&) = delete;
  GltfDocument& operator=(const GltfDocument&) = delete;
  ~GltfDocument();

  [[nodiscard]] const std::string& name() const noexcept;
  [[nodiscard]] const std::vector<GltfMesh>& meshes() const noexcept;
  [[nodiscard]] const std::vector<GltfNode>& nodes() const noexcept;
  [[nodiscard]] const std::vector<GltfAnimation>& animations() const noexcept;
  /// Returns the transform by which a node moves its mesh: its matrix, or its scale, rotation and translation, combined
  /// with the transforms of its ancestors. O(ancestors).
  [[nodiscard]] AffineTransform world_transform(std::size_t node) const noexcept;
  /// Lists the extensions that the file uses, by their names.
  [[nodiscard]] const std::vector<std::string>& extensions() const noexcept;
  /// Lists errors in parts of the file that no other part needs, in the order of the file. Such parts are skipped. Also
  /// lists required extensions that only change where a mesh is shown.
  [[nodiscard]] const std::vector<Error>& notes() const noexcept;
  /// Returns the limit on the memory and output that this document may cause, which depends on the sizes of the
  /// document and of the files with its buffers.
  [[nodiscard]] Expansion expansion() const;

  /// The parts of a geometry to read besides faces and positions.
  struct Wanted {
    bool shading = false;  ///< true to read normals and tangents, of the base and of the targets
    bool targets = true;
  };
  /// Reads a primitive. Memory: that of the result, and decompressed pieces of the file, which are kept until the
  /// document is destroyed. Precondition: has_faces() is true for the primitive.
  [[nodiscard]] Result<GltfGeometry> geometry(std::size_t mesh, std::size_t primitive, const Wanted& wanted) const;
  /// Reads one target of a primitive, as geometry() reads all of its targets.
  [[nodiscard]] Result<GltfGeometry::Target> target(std::size_t mesh, std::size_t primitive, std::size_t index,
                                                    bool shading) const;

  /// Reads the keys of a track, which is given by the index of the animation and by the index of the track in this
  /// animation.
  [[nodiscard]] Result<GltfKeys> keys(std::size_t animation, std::size_t track) const;

  /// Reads the weights of a channel that is no track. Errors: the channel has no output; numbers that cannot be read.
  [[nodiscard]] Result<std::vector<float>> unread_weights(const GltfUnreadTrack& track) const;
  /// Finds an animation by its name, or else by its index. Errors: kUsage for an unknown animation, with the names of
  /// all animations.
  [[nodiscard]] Result<std::size_t> find_animation(const std::string& name_or_index) const;

 private:
  friend class GltfEdit;
  friend class internal::GltfSkin;
  struct State;
  explicit GltfDocument(std::unique_ptr<State> state) noexcept;

  std::unique_ptr<State> state_;
};

// Edits of a glTF file that leave everything else unchanged, byte for byte.
//
// The JSON is not printed again. Changes are inserted into the text of the source, so that every token that no pointer
// names keeps its bytes (64-bit integers, 1e400, unknown extensions, the order of members, blanks). New arrays are
// appended to the BIN chunk of the source, which remains a prefix of the new chunk unless leave_out_unused() is called.
//
//     GltfEdit edit(document);
//     const std::size_t a = edit.add_vectors(deltas, {});               // a new accessor
//     edit.set("/meshes/0/primitives/0/targets/0/NORMAL", std::to_string(a));
//     edit.append("/meshes/0/weights", "0");
//     edit.write("walk.exact.glb", /*force=*/false);
//
// Pointers   RFC 6901. Changes are made in the order of the calls, each to the result of the earlier ones, so values
//            that were set or appended can be changed again. If a name occurs twice in an object, the last member is
//            used, as in the reader.
// Container  by the extension of the path, .glb or .gltf; streams (-, /dev/stdout, pipes) get the container of the
//            source. GLB to GLB: the source, with a longer BIN chunk. .gltf to GLB: external buffers (files, data URIs)
//            and images in files move into the BIN chunk, so the file is self-contained. To .gltf: the BIN chunk and
//            the new arrays become data URIs, so that a single file can be replaced atomically.
// Folders    if the result is a stream or in another folder than the source, buffers and images in files are included
//            in the result: in the BIN chunk, or as data URIs. In the source's folder, references stay as they are.
//            URIs in extensions are not changed.
// Memory     one copy of new arrays, and the changes; the source is streamed from its mapping. Data URIs are built in
//            memory.
// Threads    an edit and its document belong to one thread at a time.

/// The options for writing an array of numbers as a new accessor.
struct GltfVectors {
  bool bounds = false;  ///< true to write min and max, which accessors of positions and times must have
  /// True to store every component, even if all are zero. If false, an array that is mostly zero becomes a sparse
  /// accessor when that is smaller. An array that is all zero becomes an accessor without a bufferView, which some
  /// readers (Assimp) refuse.
  bool dense = false;
};

class GltfEdit {
 public:
  /// Makes an edit without changes. The document must outlive the edit.
  explicit GltfEdit(const GltfDocument& source);
  GltfEdit(GltfEdit&&) noexcept;
  GltfEdit& operator=(GltfEdit&&) noexcept;
  GltfEdit(const GltfEdit&) = delete;
  GltfEdit& operator=(const GltfEdit&) = delete;
  ~GltfEdit();

  /// Replaces the value at a JSON pointer. If there is no such value, adds the member that the last token of the
  /// pointer names, and objects that are missing on the way to this member. `json` is the text of a value. Errors in
  /// the pointer or in the text are reported by bytes() and write().
  void set(std::string pointer, std::string json);
  /// Appends a value to the array at a JSON pointer. The array is created if it is missing.
  void append(std::string pointer, std::string json);
  /// Read the unchanged source. has() returns true if there is a value at a JSON pointer. text() returns the text of
  /// this value, or an empty text if there is no value.
  [[nodiscard]] bool has(const std::string& pointer) const;
  [[nodiscard]] std::string text(const std::string& pointer) const;

  /// Adds an accessor of float32 VEC3 (n, 3), meant for vertices, or of SCALAR (n), for animations, and returns its
  /// index. Arrays with the same bytes and options share one accessor. n > 0, and values must be finite.
  [[nodiscard]] std::size_t add_vectors(std::span<const float> vectors, const GltfVectors& options = {});
  [[nodiscard]] std::size_t add_scalars(std::span<const float> scalars, const GltfVectors& options = {});

  /// Leaves out of the result those arrays that the source uses but the result does not, if they are in buffers inside
  /// the result (BIN chunk, data URIs). Later bytes of the buffer move towards its start; all indices stay. A file with
  /// extensions that may refer to arrays in unknown ways keeps all its bytes.
  void leave_out_unused();

  /// Lists the differences between a result at this path and the source: the sorted pointers of the result that are
  /// replaced or added, including /accessors/N, /buffers/N and so on for new items. If nested values were added
  /// together, the outermost is listed. Without a path, the container and folder of the source are assumed. Errors:
  /// those of write() that do not concern the file.
  [[nodiscard]] Result<std::vector<std::string>> pointers(const std::string& path = "") const;
  /// Returns one sentence for each image that is missing, so that a result at this path cannot include it.
  [[nodiscard]] std::vector<std::string> warnings(const std::string& path) const;
  /// Returns the number of bytes of all arrays that this edit has added.
  [[nodiscard]] std::size_t added_bytes() const noexcept;
  /// Returns the number of bytes that leave_out_unused() removes from a result at this path. Errors: those of
  /// pointers().
  [[nodiscard]] Result<std::size_t> unused_bytes(const std::string& path = "") const;

  /// Returns the complete new file, as write() would write it to the path.
  [[nodiscard]] Result<std::string> bytes(const std::string& path) const;
  /// Writes the new file, by write_output() (io/output.h).
  /// Errors: those of write_output(); kUsage for an extension other than .glb and .gltf; kInvalidInput, with the
  /// pointer as the place, if the source does not allow a change (the parent is not an object, or an array is not an
  /// array), for text that is not JSON, for unreadable buffers, for images of an unknown kind, and for a GLB of 4 GiB
  /// or more.
  [[nodiscard]] Status write(const std::string& path, bool force) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_IO_GLTF_DOCUMENT_H_
