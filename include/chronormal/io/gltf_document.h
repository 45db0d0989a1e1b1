/// glTF 2.0 files (.gltf, .glb, .vrm): what is in them, and their morphing meshes as arrays.
///
/// Opening a document maps the file and reads its JSON, nothing else; geometry and tracks are read when they are asked
/// for, so that nobody pays for the rest. All of the format that concerns normals over time is understood: external
/// buffers, data URIs, sparse accessors, byteStride, normalised integers, accessors without a bufferView, primitives
/// without indices, strips and fans, KHR_mesh_quantization, EXT_meshopt_compression, KHR_draco_mesh_compression and
/// KHR_animation_pointer. What is read is checked, strictly by the specification; materials, textures and the bounds of
/// accessors are not read and not checked. Skins, and animations of nodes, are read only by callers that look through
/// skins, and only these see errors in them.
///
/// A file that requires another extension is refused, and the message names the extension. Extensions of materials,
/// textures and lights are allowed, since they do not touch geometry.
///
/// Errors     kInvalidInput with the file and a JSON pointer as the place ("walk.gltf, /accessors/3/count"), or a byte
///            for what is no JSON.
/// Threads    one document belongs to one thread at a time: decompressed pieces are kept.
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
class Expansion;  // how much a file may make us hold or write
}

// The mark of a bake in a glTF file: how normals are encoded, and what drives the targets that it added
// (docs/formats.md).
//
// Threads    values

/// A target that a bake added. It moves no vertex, and its weight follows from those of the mesh's own targets
/// (docs/formats.md):
///
///     weight = sum of a w_i + sum of q w_i w_j
struct GltfExtraTarget {
  struct LinearTerm {
    std::size_t i = 0;  ///< a target of the mesh's own
    double a = 1;
    friend bool operator==(const LinearTerm&, const LinearTerm&) = default;
  };
  struct QuadraticTerm {
    std::size_t i = 0, j = 0;  ///< targets of the mesh's own
    double q = 1;
    friend bool operator==(const QuadraticTerm&, const QuadraticTerm&) = default;
  };

  std::size_t target = 0;  ///< index among the targets of the mesh
  std::vector<LinearTerm> linear;
  std::vector<QuadraticTerm> quadratic;

  /// Returns the weight for given weights of the mesh's own targets; weights has one for each target.
  [[nodiscard]] double weight(std::span<const double> weights) const noexcept;
  /// Returns true if the weight is other than zero where w_i alone is.
  [[nodiscard]] bool follows(std::size_t i) const noexcept;

  friend bool operator==(const GltfExtraTarget&, const GltfExtraTarget&) = default;
};

/// Selects how a bake encodes the normals of targets (workflow/bake.h). kKeys is for sequences; its results are marked
/// as harmless.
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
/// Finds an encoding by its name; returns nothing for an unknown name.
[[nodiscard]] std::optional<BakeEncoding> find_bake_encoding(std::string_view name) noexcept;

/// The mark that a bake leaves in extras.chronormal of a mesh (docs/formats.md), for instance
///     {"version": 2, "encode": "exact", "sequence": false,
///      "extras": [{"target": 2, "linear": [], "quadratic": [[0, 1, 1.0]]}]}
struct GltfBakeMark {
  BakeEncoding encoding = BakeEncoding::kExact;
  bool sequence = false;                ///< the targets are keyframes: alone, from the base, they mean nothing
  std::vector<GltfExtraTarget> extras;  ///< ascending targets; the file need not list any
  bool animations_only = false;         ///< deltas are fitted to the animations of the file, and mean nothing alone
  bool author = false;  ///< normals of each target at weight 1 are what the author of the input would see
};

inline namespace internal {
class FileBytes;
class GltfSkin;
}

/// Finds the bytes of a file by its name, in place of the file system. The bytes must stay as long as what was opened
/// with them. Errors: whatever the caller is to be told.
using FileResolver = std::function<Result<std::string_view>(const std::string& name)>;

/// Selects how weights go from one key to the next.
enum class GltfInterpolation { kLinear, kStep, kCubicSpline };

struct GltfPrimitive {
  int mode = 4;                   ///< 4 triangles, 5 strip, 6 fan; others (points, lines) have no faces
  std::size_t vertex_count = 0;   ///< 0 where there is no POSITION
  std::size_t element_count = 0;  ///< indices, or vertices where there are none
  bool has_normals = false, has_tangents = false, has_draco = false;
  /// The attributes that each target moves.
  struct Target {
    bool positions = false, normals = false, tangents = false;
  };
  std::vector<Target> targets;

  [[nodiscard]] bool has_faces() const noexcept { return mode >= 4 && mode <= 6 && vertex_count > 0; }
};

/// The weights that an expression of a VRM avatar (version 0 or 1) gives the targets of a mesh at its full strength.
struct GltfExpression {
  std::string name;             ///< as the file has it; may be empty
  std::vector<double> weights;  ///< target_count of them
  friend bool operator==(const GltfExpression&, const GltfExpression&) = default;
};

struct GltfMesh {
  std::string name;
  std::vector<GltfPrimitive> primitives;
  std::size_t target_count = 0;             ///< the same in all primitives
  std::vector<std::string> target_names;    ///< extras.targetNames, where it has target_count names; else empty
  std::vector<double> weights;              ///< the default ones; target_count of them, 0 where the file has none
  std::vector<GltfExpression> expressions;  ///< of a VRM avatar: those that have a bind to this mesh
  std::optional<GltfBakeMark> mark;         ///< where a bake left one that can be understood
  std::optional<Error> mark_fault;          ///< why there is a mark that cannot: for those who have to understand it
};

struct GltfNode {
  std::string name;
  std::optional<std::uint32_t> mesh, parent;
  bool has_skin = false;
  std::optional<std::uint32_t> skin;  ///< as the file numbers it, if that is a number
  std::vector<double> weights;        ///< its own, or empty: those of the mesh
};

/// The animation of the weights of one node. It comes from a channel for the node, or from one of KHR_animation_pointer
/// for all weights of the node or of its mesh; in the latter case each node without weights of its own has such a
/// track.
struct GltfTrack {
  std::size_t node = 0, channel = 0;
  /// The first track of the animation that gives the same weights: the same keys, interpolation and number of targets.
  std::size_t same_keys_as = 0;
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  std::size_t key_count = 0;
  /// True if KHR_animation_pointer gives every weight a channel of its own: these are put together here, and channel is
  /// the first of them. The track has the keys of all of them, and is cubic if one of them is; files in which some of
  /// them step and others do not are refused.
  bool is_assembled = false;
};

struct GltfAnimation {
  std::string name;
  std::size_t channel_count = 0;  ///< of all kinds
  std::vector<GltfTrack> tracks;  ///< of weights
};

/// The keys of a track; K = keys, N = targets of the mesh.
struct GltfKeys {
  std::vector<double> times;  ///< (K), seconds, ascending; float32 in the file
  /// (K, N), or for a cubic spline (K, 3, N): in-tangents per second, values, out-tangents
  std::vector<double> values;
};

/// The arrays of a primitive, decoded.
struct GltfGeometry {
  std::vector<std::uint32_t> corners;  ///< (F, 3): strips and fans are taken apart
  std::vector<float> positions;        ///< (V, 3)
  std::vector<float> normals;          ///< (V, 3), or empty
  std::vector<float> tangents;         ///< (V, 4), or empty
  /// The deltas, (V, 3) each; an array is empty if the target has none.
  struct Target {
    std::vector<float> positions, normals, tangents;
  };
  std::vector<Target> targets;
};

/// Tells for one primitive where its vertices and faces in a motion or a mesh came from.
struct GltfPart {
  std::optional<std::size_t> node;  ///< the node that carries the mesh; nothing if nodes do not matter
  std::size_t mesh = 0, primitive = 0;
  std::size_t first_vertex = 0, vertex_count = 0;
  std::size_t first_face = 0, face_count = 0;
};

struct GltfOptions {
  bool allow_external = false;  ///< read buffers from files outside the folder of the asset
  /// The most memory that the arrays of one primitive may take: a small file can ask for much.
  std::size_t most_bytes = addressable(std::uint64_t{4} << 30);
  std::size_t max_expansion = 100;  ///< as in InputOptions
  bool strict = false;              ///< refuse what GltfDocument::notes() would tell
  /// Finds buffers and images by their path below the folder of the asset; empty: the file system does.
  FileResolver resolve = {};
};

class GltfDocument {
 public:
  /// Opens a file; "-" is the standard input. Errors: kFailed with the path as the place if it can not be read; errors
  /// of the format.
  [[nodiscard]] static Result<GltfDocument> open(const std::string& path, const GltfOptions& options = {});

  /// Reads a document from bytes that outlive it. name is for messages; folder is where its files are, if it has any.
  [[nodiscard]] static Result<GltfDocument> read(std::string_view bytes, const std::string& name,
                                                 const std::optional<std::string>& folder = std::nullopt,
                                                 const GltfOptions& options = {});
  /// Reads an open file (io/bytes/file.h), which the document keeps.
  [[nodiscard]] static Result<GltfDocument> read(FileBytes file, const std::string& name,
                                                 const std::optional<std::string>& folder = std::nullopt,
                                                 const GltfOptions& options = {});

  /// Returns true if bytes look like a glTF file: GLB, or JSON with an object.
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
  /// Returns where a node puts its mesh: its matrix, or its scale, rotation and translation, joined with its ancestors'
  /// as the file has them. O(ancestors).
  [[nodiscard]] AffineTransform world_transform(std::size_t node) const noexcept;
  /// Lists the extensions that the file uses, as it names them.
  [[nodiscard]] const std::vector<std::string>& extensions() const noexcept;
  /// Lists faults in parts of the file that the other parts do not need, in the order of the file; such parts are
  /// passed over. Also lists required extensions that change nothing of a mesh but where it is shown.
  [[nodiscard]] const std::vector<Error>& notes() const noexcept;
  /// Returns the limit of what the document may ask for, by its size and the sizes of the files that hold its buffers.
  [[nodiscard]] Expansion expansion() const;

  /// The part of a geometry that is wanted beside faces and positions.
  struct Wanted {
    bool shading = false;  ///< normals and tangents, of the base and of the targets
    bool targets = true;
  };
  /// Reads a primitive. Memory: that of the result; compressed pieces are kept decompressed as long as the document.
  /// Precondition: the primitive has_faces()
  [[nodiscard]] Result<GltfGeometry> geometry(std::size_t mesh, std::size_t primitive, const Wanted& wanted) const;
  /// Reads one target of a primitive, as geometry() reads all of them.
  [[nodiscard]] Result<GltfGeometry::Target> target(std::size_t mesh, std::size_t primitive, std::size_t index,
                                                    bool shading) const;

  /// Reads the keys of a track.
  [[nodiscard]] Result<GltfKeys> keys(std::size_t animation, std::size_t track) const;

  /// Finds an animation that a person names: by its name, or else by its index.
  /// Errors: kUsage, with the animations that there are.
  [[nodiscard]] Result<std::size_t> find_animation(const std::string& name_or_index) const;

 private:
  friend class GltfEdit;
  friend class internal::GltfSkin;
  struct State;
  explicit GltfDocument(std::unique_ptr<State> state) noexcept;

  std::unique_ptr<State> state_;
};

// Changes to a glTF file that leave everything else as it is, byte for byte.
//
// The JSON is not printed anew: what changes is spliced into the text of the source, so that every token that is not
// named by a pointer keeps its bytes (64-bit integers, 1e400, unknown extensions, the order of members, blanks). New
// arrays go behind the BIN chunk of the source, which stays a prefix of the new one unless leave_out_unused() is
// called.
//
//     GltfEdit edit(document);
//     const std::size_t a = edit.add_vectors(deltas, {});               // a new accessor
//     edit.set("/meshes/0/primitives/0/targets/0/NORMAL", std::to_string(a));
//     edit.append("/meshes/0/weights", "0");
//     edit.write("walk.exact.glb", /*force=*/false);
//
// Pointers   RFC 6901. Changes are made in the order of the calls, each on what those before it left: what was set or
//            appended can be changed again. Of members that come twice, the last counts, as for the reader.
// Container  by the extension of the path, .glb or .gltf; streams (-, /dev/stdout, pipes) get that of the source.
//            GLB to GLB: the source, with a longer BIN chunk. .gltf to GLB: buffers that lie outside (files, data
//            URIs) move into the BIN chunk, and so do images that are files: the file stands alone. To .gltf: the BIN
//            chunk and the new arrays become data URIs, so that one file is replaced at once.
// Folders    into another folder than that of the source, or into a stream, files that the source refers to are taken
//            along, buffers and images: into the BIN chunk, or as data URIs. Beside the source the references stay.
//            URIs in extensions are not looked for.
// Memory     of new arrays, once, and of the changes; the source is streamed from its mapping. Data URIs are built in
//            memory.
// Threads    an edit and its document belong to one thread at a time.

/// Selects how an accessor of new numbers is written.
struct GltfVectors {
  bool bounds = false;  ///< min and max, which positions and times need
  /// Writes zeros as bytes too, in every array. Otherwise arrays that are mostly zero become a sparse accessor if that
  /// is smaller, and arrays that are all zero become an accessor without a bufferView, which some readers (Assimp)
  /// refuse.
  bool dense = false;
};

class GltfEdit {
 public:
  /// The document must outlive this.
  explicit GltfEdit(const GltfDocument& source);
  GltfEdit(GltfEdit&&) noexcept;
  GltfEdit& operator=(GltfEdit&&) noexcept;
  GltfEdit(const GltfEdit&) = delete;
  GltfEdit& operator=(const GltfEdit&) = delete;
  ~GltfEdit();

  /// Replaces the value at a pointer, or adds the member that its last token names; missing objects on the way are
  /// made. json is the text of a value. bytes() and write() report what is wrong with either.
  void set(std::string pointer, std::string json);
  /// Adds a value to the end of an array, which is made where it is missing.
  void append(std::string pointer, std::string json);
  /// Tells whether the source, without changes, has a value at a pointer; text() returns the value, empty where there
  /// is none.
  [[nodiscard]] bool has(const std::string& pointer) const;
  [[nodiscard]] std::string text(const std::string& pointer) const;

  /// Adds an accessor of float32 VEC3 (n, 3), meant for vertices, or of SCALAR (n), for animations, and returns its
  /// index. Arrays with the same bytes and options share one accessor. n > 0, and values must be finite.
  [[nodiscard]] std::size_t add_vectors(std::span<const float> vectors, const GltfVectors& options = {});
  [[nodiscard]] std::size_t add_scalars(std::span<const float> scalars, const GltfVectors& options = {});

  /// Leaves out what the changes leave unused, from now on: the bytes of arrays that the source refers to and the
  /// result does not, in buffers that the result holds itself (BIN chunk, data URIs). The bytes behind them move
  /// towards the front; all indices stay. Files with extensions that may refer to arrays in ways of their own keep all
  /// their bytes.
  void leave_out_unused();

  /// Lists how a file at this path differs from the source: pointers that are replaced or added, as they are in the
  /// result, sorted, with /accessors/N, /buffers/N and so on for new ones. If several were added together, the
  /// outermost is listed. Without a path, the container and the folder of the source count. Errors: as of write(), but
  /// for the file.
  [[nodiscard]] Result<std::vector<std::string>> pointers(const std::string& path = "") const;
  /// Lists what a file at this path can not take along, images that are missing, in one sentence each.
  [[nodiscard]] std::vector<std::string> warnings(const std::string& path) const;
  /// Returns the number of bytes of arrays that were added.
  [[nodiscard]] std::size_t added_bytes() const noexcept;
  /// Returns the number of bytes of the source that a file at this path lacks, by leave_out_unused(). Errors: as of
  /// pointers().
  [[nodiscard]] Result<std::size_t> unused_bytes(const std::string& path = "") const;

  /// Returns the whole new file, as write() would write it to path.
  [[nodiscard]] Result<std::string> bytes(const std::string& path) const;
  /// Writes the new file, by write_output() (io/output.h).
  /// Errors: of write_output(); kUsage for another extension; kInvalidInput with the pointer as the place where the
  /// source is such that a change is not possible (a parent that is no object, an array that is none), for JSON that is
  /// none, for buffers that can not be read, images that are of no known kind, and for a GLB of 4 GiB or more.
  [[nodiscard]] Status write(const std::string& path, bool force) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_IO_GLTF_DOCUMENT_H_
