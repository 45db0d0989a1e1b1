/// Opens one input of any format, from files or from memory.
///
///     walk_0.obj walk_1.obj         several meshes: the keyframes of a sequence, in the order given
///     'walk_*.obj'  walk/           a pattern with * ? [..], or %d (where no file has that very name), or a folder
///                                   of meshes of one format; sorted by number, so that walk_2 stands before walk_10,
///                                   and at times that these numbers give (docs/cli.md)
///     body.obj walk.pc2             a mesh and a point cache: .pc2, .mdd, .npy, .mc, .mcx, or a Maya .xml
///     body.obj cache.xml#bodyShape  the same, with the channel of a Maya cache
///     walk.npz                      a whole motion: .npz or .md2
///     face.glb                      a glTF document: its morph targets, or one of its animations
///     base, and any of              a set of morph targets: meshes with the faces of the base, targets of MakeHuman,
///       smile.obj lift.target t/      patterns, folders with all folders in them; the base itself is passed over
///     sample twist                  a built-in morph (io/input.h)
///     -                             one file on the standard input
///
/// A file is opened once and looked at once: its extension says what it is, or else its content, so that pipes are as
/// good as files. docs/formats.md says what each format holds.
///
/// Units      times: seconds. Keyframe k is at k / frames_per_second in formats that have no times of their own or
///            count them in frames (meshes, npy, npz without times, MD2, PC2); targets have weights.
/// Threads    one input belongs to one thread at a time.
#ifndef CHRONORMAL_IO_INPUT_H_
#define CHRONORMAL_IO_INPUT_H_

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
#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "chronormal/motion/paths.h"

namespace chronormal {

inline namespace internal {
class Expansion;  // how much a file may make us hold or write
}

/// Selects the normals and smoothing groups to keep that meshes store beside their positions.
enum class KeepShading {
  kNone,
  kFirst,  ///< of the first keyframe: of the base, or of the mesh of a cache
  kAll,    ///< of all keyframes, as far as all of them store normals
  kRead,   ///< of all keyframes that are read at once, as kAll; of the first one where positions are left in files
};

/// The options of an input; their names are those of the program's options, which fill this.
struct InputOptions {
  std::vector<std::string> files;    ///< files, patterns, folders or "-": one motion, or the targets of the base
  std::vector<std::string> samples;  ///< a built-in morph, in place of files
  std::string base;                  ///< the mesh of which files are morph targets; empty where there is none
  double frames_per_second = 1;      ///< from 1e-9 to 1e9
  std::string animation = {};        ///< of a glTF file, by name or index; empty: its morph targets
  bool world = false;                ///< vertices of a glTF file are where its nodes put them
  bool allow_external = false;       ///< a glTF file may name files outside its folder
  /// The limit of what a file may make us hold: so many times its bytes, or 32 MiB if that is more. Requests of the
  /// user do not count.
  std::size_t max_expansion = 100;
  bool allow_mesh = false;  ///< a mesh that does not move is an input, too
  KeepShading shading = KeepShading::kNone;
  /// Keeps the velocities that mesh files of a sequence store, and reads all of these at once. Formats that hold a
  /// whole motion always keep theirs.
  bool velocities = false;
  /// Finds the bytes of files; empty: the file system does. With a resolver, files are names and not patterns or
  /// folders, and a glTF file's buffers are asked for by their paths below its folder.
  FileResolver resolve = {};
  /// Is called after each file that was read.
  std::function<void(std::size_t done, std::size_t total)> progress = {};
  /// The keyframes of a sequence that count: the first, the last, and the step from one to the next.
  std::size_t from = 0;
  std::optional<std::size_t> to = {};
  std::size_t every = 1;
  /// Lets the last of these keyframes be followed by the first one again, after the mean time between two of them.
  bool loop = false;
  /// Refuses an input of which only a part could be read, with the first of the notes that Input::notes() would have.
  bool strict = false;
  /// The path of vertices between these keyframes, as make_path() reads it. Curves run through the whole sequence: up
  /// to three keyframes beyond the first and the last one are read for them. They are cut into straight pieces
  /// (motion/paths.h), at most max_expansion for a segment, and the motion consists of the pieces.
  std::string path = "linear";
  /// Leaves positions in the files until they are asked for: in mesh files, .pc2 and .mdd, and in .npy and .npz that
  /// are stored and in C order. A caller that sets it should ask for Input::stream(). Other inputs are read at once,
  /// and so are mesh files where the normals of all of them are kept. An error in a keyframe is found when the keyframe
  /// is read.
  bool stream = false;
  /// The most bytes that keyframes may take together to stay in memory once they have been read.
  std::size_t kept_bytes = MotionStream::kUsuallyKept;

  [[nodiscard]] bool chooses_frames() const noexcept { return from > 0 || to || every != 1 || loop; }
  [[nodiscard]] bool is_curved() const noexcept { return path != path_name(PathKind::kLinear); }
};

/// Checks that the options go together, before anything is opened. Errors: kUsage, with the option as the place.
[[nodiscard]] Status check_input(const InputOptions& options);

/// Finds the glTF files that inputs stand for if each is an input of its own: names, patterns, and folders. A folder
/// stands for all glTF files in it and in its folders, except for names that begin with a dot and links to folders; a
/// folder whose own files are meshes is a sequence. Patterns and folders are sorted by number. The result is empty if
/// no input stands for a glTF file. Nothing is opened, so that a name need not be that of a file. Errors: kUsage for
/// glTF files beside other inputs, and beside meshes in one folder.
[[nodiscard]] Result<std::vector<std::string>> find_gltf_files(const std::vector<std::string>& inputs);

/// Normals that files store beside a motion, (corners, 3) each, of any length.
struct StoredNormals {
  /// Normals for every keyframe; or for keyframe 0 alone, which then only say which edges are hard; or empty.
  std::vector<std::vector<float>> of_keyframes;
  bool has_more = false;  ///< with KeepShading::kRead: other keyframes may store some, which were left in files
};

/// The numbers in the names of the files of a sequence, if one number tells these names apart and grows from each file
/// to the next.
struct FileSeries {
  std::size_t count = 0;
  double first = 0, last = 0;            ///< numbers
  double least_step = 0, most_step = 0;  ///< between two neighbours
  bool are_seconds = false;              ///< a number has a fraction: all of them are times

  [[nodiscard]] bool is_even() const noexcept { return most_step - least_step <= 1e-6 * most_step; }
};

/// An input that was opened: a glTF document, or else a motion or a mesh.
class Input {
 public:
  Input(Input&&) noexcept;
  Input& operator=(Input&&) noexcept;
  ~Input();

  /// Returns the name that a person gives the input: the only file, "first ... last", the base, or the built-in morph.
  [[nodiscard]] const std::string& name() const noexcept;
  /// Returns the bytes of the file, if the input is a document.
  [[nodiscard]] std::size_t file_size() const noexcept;

  /// Returns the limit of what the input may ask for, by the bytes that were read of it; a built-in morph is not
  /// limited.
  [[nodiscard]] Expansion expansion() const;

  /// Returns the glTF file that the input is; nullptr for other inputs. It lives as long as the input.
  [[nodiscard]] const GltfDocument* document() const noexcept;

  /// Returns what a person should know of how the input was read, in whole sentences: that listed files were sorted,
  /// that parts of a file were passed over. For a document it is what is known so far.
  [[nodiscard]] std::vector<std::string> notes() const;
  /// Returns the numbers of the files of a sequence; nothing if their names do not tell them.
  [[nodiscard]] const std::optional<FileSeries>& series() const noexcept;

  /// Returns the motion. For a document it is the one that the options chose, and is read when it is asked for the
  /// first time. With allow_mesh it may be a mesh that does not move, one keyframe without a segment; otherwise it is
  /// valid (motion/motion.h). All keyframes are in memory, as most callers want them; callers that need them one by one
  /// should ask for stream(). Errors: for a document, those of GltfDocument; kUsage for an animation that is not there;
  /// kInvalidInput if nothing moves, or keyframes would take more than 4 GiB; if keyframes were left in files, those of
  /// reading them; for curves, those of cut_into_segments().
  [[nodiscard]] Result<const Motion*> motion();

  /// Returns the motion as a stream, which reads keyframes when they are asked for and lives as long as the input.
  /// Errors: those of motion(), except those of reading keyframes.
  [[nodiscard]] Result<MotionStream*> stream();

  /// Returns the path that was cut, once motion() or stream() was asked for.
  [[nodiscard]] const CutPath& cut_path() const noexcept;

  /// Returns keyframe k of the motion, from 0, in any order. It is valid until the next call that reads keyframes.
  /// Errors: those of motion(), and of reading the file.
  [[nodiscard]] Result<const Motion::Keyframe*> keyframe(std::size_t k);
  [[nodiscard]] Result<std::size_t> keyframe_count();

  /// Returns the times of the keyframes, each once and ascending; for an animation of a document, the times of the keys
  /// of its weights, without the cuts of cubic splines. Errors: those of motion().
  [[nodiscard]] Result<std::vector<double>> key_times();

  /// Returns the normals that the input stores, as far as the options keep them; for a document those of its base, in
  /// the space of the meshes. If curves are cut, it has those of keyframe 0 alone. Errors: those of motion().
  [[nodiscard]] Result<const StoredNormals*> normals();
  /// Returns the smoothing group of each face, as the first keyframe has them (io/mesh/mesh_frame.h); empty if there
  /// are none.
  [[nodiscard]] std::span<const std::uint32_t> group_of_face() const noexcept;
  /// Returns the file of the normals and groups; empty where its format is read without them.
  [[nodiscard]] const std::string& shaded_by() const noexcept;

  /// Tells where the vertices and faces of a document came from, and bounds the distance between the cut cubic splines
  /// of an animation and the true ones, in units of the file; both once motion() was asked for.
  [[nodiscard]] std::span<const GltfPart> parts() const noexcept;
  [[nodiscard]] double curve_error() const noexcept;

 private:
  friend Result<Input> open_input(const InputOptions& options);
  struct State;
  explicit Input(std::unique_ptr<State> state) noexcept;

  std::unique_ptr<State> state_;
};

/// Opens what the options name and reads it. Of a glTF document nothing but its JSON is read.
///
/// Errors: those of check_input(); kUsage where the chosen keyframes are not there, or the input is no sequence;
/// kFailed for files that are not there or cannot be read; those of the readers, with
/// the file in the place ("frame 3 (walk_3.obj), line 17"); kInvalidInput for fewer than two keyframes, vertices or
/// faces that change between them, folders without meshes or with several formats; kUsage for inputs that do not go
/// together.
[[nodiscard]] Result<Input> open_input(const InputOptions& options);

// Morphs that need no file, to try things on, and to publish figures that anyone can measure again.

struct BuiltinMorph {
  std::string_view name;
  std::string_view summary;  ///< one line
};

/// Lists the built-in morphs that are sequences, from mild to dramatic.
[[nodiscard]] std::span<const BuiltinMorph> builtin_morphs() noexcept;

/// Lists the built-in blend shapes, whose keyframes are targets over a base.
[[nodiscard]] std::span<const BuiltinMorph> builtin_blend_shapes() noexcept;

/// Makes a built-in morph of either kind by name: the same positions on every call. Errors: kUsage with the names that
/// there are.
[[nodiscard]] Result<Motion> make_builtin_morph(std::string_view name);

// The morph targets of an input by their names.
//
//     base.obj smile.obj lift.target     0 smile, 1 lift: the names of the files
//     face.glb                           extras.targetNames of its meshes; target k of a motion is target k of every
//                                        mesh, so that it has as many names as meshes call it differently
//
// Threads    pure.

/// The names of each target, in the order of the targets; the list of a target without a name is empty.
using TargetNames = std::vector<std::vector<std::string>>;

/// Returns the names of the targets that the motion of an input has; empty if it is no set of targets. Errors: of
/// Input::motion()
[[nodiscard]] Result<TargetNames> target_names(Input& input);

/// Finds the target of a name, or else of a number in digits, counted from 0. Errors: kUsage for a name that no target
/// has, with the nearest one, and for a name that several have, with their numbers.
[[nodiscard]] Result<std::size_t> find_target(const TargetNames& names, const std::string& name_or_number);

/// Returns what tables and messages call target 3: "3 (smile)", or "3" for a target without a name.
[[nodiscard]] std::string target_label(const TargetNames& names, std::size_t target);

// Points that rest or move on straight lines, from a NumPy array: a .npy file of float32 or float64.
//
//     (n, 3)      each point rests
//     (n, 2, 3)   each point moves from the first position to the second
//
// Errors     kInvalidInput with the file, and the element, as the place ("points.npy, [17, 0, 2]"): another shape or
//            type, coordinates that are not finite or too large for float32; kFailed where the file cannot be read.
// Threads    pure

/// The ends of n straight lines, (n, 3) each; both ends are the same for points that rest.
struct PointPaths {
  std::vector<double> from, to;

  [[nodiscard]] std::size_t count() const noexcept { return from.size() / 3; }
};

[[nodiscard]] Result<PointPaths> read_points_file(const std::string& path);

/// Reads points from the bytes of such a file; name is for messages.
[[nodiscard]] Result<PointPaths> parse_points(std::string_view bytes, const std::string& name);

// Poses of a rig from a JSON file: the weights that a program or a person gives its morph targets.
//
//     [{"jawOpen": 0.7, "mouthSmile_L": 1},     weights by the names of targets; all others are 0
//      [0, 0.7, 0, 1]]                          or one for each target of a mesh, in its order
//
// Errors     kInvalidInput with the file and a JSON pointer as the place ("poses.json, /1/jawOpen"), or a byte for
//            what is no JSON; kFailed where the file cannot be read.
// Threads    pure

/// One pose: weights by name, or in the order of the targets; one of the two is empty.
struct RigPose {
  struct Named {
    std::string target;
    double weight = 0;
    std::string place;  ///< for messages: "poses.json, /1/jawOpen"
  };
  std::vector<Named> named;
  std::vector<double> in_order;
  std::string place;
};

/// Reads a file of poses: one at least, each with finite weights.
[[nodiscard]] Result<std::vector<RigPose>> read_poses_file(const std::string& path);

/// Reads poses from the text of such a file; name is for messages.
[[nodiscard]] Result<std::vector<RigPose>> parse_poses(std::string_view text, const std::string& name);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_INPUT_H_
