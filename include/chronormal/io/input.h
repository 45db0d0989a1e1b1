/// Opens one input of any format, from files or from memory.
///
///     walk_0.obj walk_1.obj         several meshes: the keyframes of a sequence, in the order given
///     'walk_*.obj'  walk/           a pattern with * ? [..], or %d (unless a file has exactly that name), or a folder
///                                   of meshes of one format; sorted by number, so that walk_2 comes before walk_10,
///                                   with the numbers as times (docs/cli.md)
///     body.obj walk.pc2             a mesh and a point cache: .pc2, .mdd, .npy, .mc, .mcx, or a Maya .xml
///     body.obj cache.xml#bodyShape  the same, with the channel of a Maya cache
///     walk.npz                      a whole motion: .npz or .md2
///     face.glb                      a glTF document: its morph targets, or one of its animations
///     base, and any of              a set of morph targets: meshes with the faces of the base, targets of MakeHuman,
///       smile.obj lift.target t/      patterns, folders with all their subfolders; the base itself is skipped
///     sample twist                  a built-in morph (builtin_morphs())
///     -                             one file on the standard input
///
/// A file is opened and read only once, so pipes work like files. Its extension determines the format, or else its
/// content. docs/formats.md describes the formats.
///
/// Units      times: seconds. Keyframe k is at k / frames_per_second in formats without times or with times in frames
///            (meshes, npy, npz without times, MD2, PC2); targets have weights instead of times.
/// Threads    an input belongs to one thread at a time.
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
class Expansion;  // limits the memory and the output that reading a file may cause
}

/// The part of the stored normals and smoothing groups of meshes that is kept in memory.
enum class KeepShading {
  kNone,
  kFirst,  ///< the normals of the first keyframe: the base of targets, or the mesh of a point cache
  kAll,    ///< the normals of all keyframes, if every keyframe stores normals
  /// The normals of all keyframes if the files are read when the input is opened; only those of the first keyframe if
  /// positions stay in files (`stream`).
  kRead,
};

/// The options of an input; their names are those of the program's options.
struct InputOptions {
  std::vector<std::string> files;    ///< files, patterns, folders or "-": one motion, or the targets of `base`
  std::vector<std::string> samples;  ///< names of built-in morphs, which take the place of files
  std::string base;                  ///< the base mesh, if the files are morph targets; empty for other inputs
  double frames_per_second = 1;      ///< keyframes per second in formats without times; from 1e-9 to 1e9
  /// The animation of a glTF file to read, by name or index. If no animation is named, the morph targets are read.
  std::string animation = {};
  bool world = false;  ///< true to move the vertices of a glTF file to their places in the scene
  /// True to move the vertices of a glTF file by the skins of its nodes, to their places in the scene even without
  /// `world`. Under an animation, vertices move on curves, which are cut into straight pieces, at most max_expansion
  /// pieces between two keys.
  bool skins = false;
  bool allow_external = false;  ///< true if a glTF file may refer to files outside of its folder
  /// The largest memory that reading a file may cause, as a multiple of the file's size. At least 32 MiB are always
  /// allowed. Memory that options of the user ask for is not limited.
  std::size_t max_expansion = 100;
  bool allow_mesh = false;  ///< true to accept a mesh without motion, too
  KeepShading shading = KeepShading::kNone;
  /// True to keep the velocities that the mesh files of a sequence store. All files are then read when the input is
  /// opened. Velocities in formats with a whole motion are always kept.
  bool velocities = false;
  /// A function that returns the bytes of files by their names. If the function is empty, files are read from the file
  /// system. Otherwise `files` are names and not patterns or folders, and the buffers of a glTF file are requested by
  /// their paths below its folder.
  FileResolver resolve = {};
  /// A function that is called after each file has been read, with the number of files read so far and the number of
  /// all files.
  std::function<void(std::size_t done, std::size_t total)> progress = {};
  /// Select the keyframes of a sequence that are used. `from` and `to` are the indices of the first and the last one,
  /// counted from 0. `every` is the step from one keyframe to the next.
  std::size_t from = 0;
  std::optional<std::size_t> to = {};
  std::size_t every = 1;
  /// True to repeat the first of the selected keyframes after the last one, so that the motion is a loop. The time from
  /// the last keyframe to the repeated one is the mean time between neighbouring keyframes.
  bool loop = false;
  /// True to refuse an input that could only be read in part. The error is the first of the notes that Input::notes()
  /// would return.
  bool strict = false;
  /// The kind of curve on which vertices move between keyframes, as make_path() reads it. Curves run through the whole
  /// sequence, so up to three keyframes before the first and after the last selected keyframe are read, too. Curves are
  /// cut into straight pieces (motion/paths.h), at most max_expansion pieces for a segment, and these pieces are the
  /// segments of the motion.
  std::string path = "linear";
  /// True to leave positions in the files until they are needed. Positions can stay in mesh files, in .pc2 and .mdd,
  /// and in .npy and .npz files that are uncompressed and in C order. Other inputs are read when they are opened, and
  /// so are mesh files if the normals of all keyframes are kept. Callers that set this option should use
  /// Input::stream(). An error in a keyframe is found when the keyframe is read.
  bool stream = false;
  /// If all keyframes together take at most this number of bytes, each keyframe stays in memory once it was read.
  std::size_t kept_bytes = MotionStream::kUsuallyKept;

  [[nodiscard]] bool chooses_frames() const noexcept { return from > 0 || to || every != 1 || loop; }
  [[nodiscard]] bool is_curved() const noexcept { return path != path_name(PathKind::kLinear); }
};

/// Checks that the options do not contradict each other, before any file is opened. Errors: kUsage with the option as
/// the place.
[[nodiscard]] Status check_input(const InputOptions& options);

/// Finds the glTF files among names, patterns and folders. Each glTF file is a separate input. A folder stands for all
/// glTF files in the folder and in its subfolders, except for names that begin with a dot and links to folders; a
/// folder whose own files are meshes is a sequence. Patterns and folders are sorted by number. The result is empty if
/// there are no glTF files. Nothing is opened, so a name need not belong to an existing file. Errors: kUsage for glTF
/// files together with other inputs, or with meshes in one folder.
[[nodiscard]] Result<std::vector<std::string>> find_gltf_files(const std::vector<std::string>& inputs);

/// The normals that files store beside a motion: for each keyframe three numbers per corner, not necessarily of unit
/// vectors.
struct StoredNormals {
  /// The normals of every keyframe, or of keyframe 0 only, or an empty list. Normals of keyframe 0 only are used to
  /// find the hard edges.
  std::vector<std::vector<float>> of_keyframes;
  /// True if keyframes whose files were not read may also store normals. Always false without KeepShading::kRead.
  bool has_more = false;
};

/// The numbers in the file names of a sequence, if a single number distinguishes the names and grows from file to file.
struct FileSeries {
  std::size_t count = 0;
  double first = 0, last = 0;  ///< the numbers in the first and in the last file name
  /// The smallest and the largest difference between the numbers of two neighbouring files.
  double least_step = 0, most_step = 0;
  bool are_seconds = false;  ///< true if a number has a fraction; all numbers are then times in seconds

  [[nodiscard]] bool is_even() const noexcept { return most_step - least_step <= 1e-6 * most_step; }
};

/// An opened input, which is a glTF document, or else a motion or a mesh.
class Input {
 public:
  Input(Input&&) noexcept;
  Input& operator=(Input&&) noexcept;
  ~Input();

  /// Returns the name of the input for messages: the name of its only file, "FIRST ... LAST" with the names of the
  /// first and last of several files, the base, or the built-in morph.
  [[nodiscard]] const std::string& name() const noexcept;
  /// Returns the size of the glTF file in bytes, or 0 for any other input.
  [[nodiscard]] std::size_t file_size() const noexcept;

  /// Returns the limit on the memory and output that this input may cause. The limit depends on the number of bytes
  /// that were read; a built-in morph has no limit.
  [[nodiscard]] Expansion expansion() const;

  /// Returns the glTF document, which lives as long as the input, or nullptr if the input is not a document.
  [[nodiscard]] const GltfDocument* document() const noexcept;

  /// Returns notes for the user, in whole sentences, on how the input was read: that listed files were sorted, or that
  /// parts of a file were skipped. For a document, returns the notes that are known so far.
  [[nodiscard]] std::vector<std::string> notes() const;
  /// Returns the numbers in the file names of a sequence, or no value if the names have no such numbers.
  [[nodiscard]] const std::optional<FileSeries>& series() const noexcept;

  /// Returns the motion. For a document, the motion that the options select is read at the first call. With allow_mesh
  /// the motion may be a mesh at rest, which is one keyframe without a segment; otherwise the motion is valid
  /// (motion/motion.h). All keyframes are in memory; callers that need keyframes one by one should use stream().
  /// Errors: for a document, those of GltfDocument; kUsage for an animation that does not exist; kInvalidInput if
  /// nothing moves, or if keyframes would take more than 4 GiB; if keyframes were left in files, those of reading them;
  /// for curves, those of cut_into_segments().
  [[nodiscard]] Result<const Motion*> motion();

  /// Returns the motion as a stream, which reads keyframes on demand and lives as long as the input. Errors: those of
  /// motion(), except those of reading keyframes.
  [[nodiscard]] Result<MotionStream*> stream();

  /// Returns the kind of path on which the vertices move, and the numbers of pieces into which it was cut. Valid after
  /// motion() or stream() was called.
  [[nodiscard]] const CutPath& cut_path() const noexcept;

  /// Returns keyframe k of the motion, from 0, in any order. The keyframe is valid until the next call that reads
  /// keyframes. Errors: those of motion(), and of reading the file.
  [[nodiscard]] Result<const Motion::Keyframe*> keyframe(std::size_t k);
  [[nodiscard]] Result<std::size_t> keyframe_count();

  /// Returns the times of the keyframes, each once and ascending; for an animation of a document, the key times of its
  /// weights, without the keyframes that were added by cutting cubic splines. Errors: those of motion().
  [[nodiscard]] Result<std::vector<double>> key_times();

  /// Returns the normals that the input stores, as far as KeepShading keeps them. For a document, returns the normals
  /// of its base, in the space of the meshes. If curves are cut, returns only the normals of keyframe 0. Errors: those
  /// of motion().
  [[nodiscard]] Result<const StoredNormals*> normals();
  /// Returns the normals that keyframe k of a sequence stores, three numbers per corner. Reads the file of the keyframe
  /// again if these normals are not in memory. The result is empty if the keyframe stores none, or if vertices move on
  /// curves. Errors: those of normals(), and of reading the file.
  [[nodiscard]] Result<std::vector<float>> normals_of(std::size_t k);
  /// Returns the smoothing group of each face in the first keyframe (io/mesh/mesh_frame.h), or an empty span if the
  /// file has no groups.
  [[nodiscard]] std::span<const std::uint32_t> group_of_face() const noexcept;
  /// Returns the name of the file that stores the normals and smoothing groups. The name is empty if the input has a
  /// format from which normals and groups are not read.
  [[nodiscard]] const std::string& shaded_by() const noexcept;

  /// Return facts about the motion of a document, valid after motion() was called. parts() returns the primitives from
  /// which its vertices and faces come. curve_error() returns a bound of the distance between the cut cubic splines of
  /// an animation and the true splines, in units of length of the file.
  [[nodiscard]] std::span<const GltfPart> parts() const noexcept;
  [[nodiscard]] double curve_error() const noexcept;

 private:
  friend Result<Input> open_input(const InputOptions& options);
  struct State;
  explicit Input(std::unique_ptr<State> state) noexcept;

  std::unique_ptr<State> state_;
};

/// Opens and reads the input that the options name. Only the JSON of a glTF document is read.
///
/// Errors: those of check_input(); kUsage if the selected keyframes do not exist, or if the input is not a sequence;
/// kFailed for files that do not exist or cannot be read; those of the readers, with the file in the place ("frame 3
/// (walk_3.obj), line 17"); kInvalidInput for fewer than two keyframes, vertices or faces that change between them,
/// folders without meshes or with several formats; kUsage for inputs that cannot be combined.
[[nodiscard]] Result<Input> open_input(const InputOptions& options);

// Morphs that need no file. They let users try things out, and let anyone reproduce published figures.

struct BuiltinMorph {
  std::string_view name;
  std::string_view summary;  ///< a description of one line
};

/// Lists the built-in morphs that are sequences, from mild to dramatic.
[[nodiscard]] std::span<const BuiltinMorph> builtin_morphs() noexcept;

/// Lists the built-in blend shapes, whose keyframes are targets over a base.
[[nodiscard]] std::span<const BuiltinMorph> builtin_blend_shapes() noexcept;

/// Makes a built-in morph of either kind by name, with the same positions on every call. Errors: kUsage with the known
/// names.
[[nodiscard]] Result<Motion> make_builtin_morph(std::string_view name);

// The morph targets of an input by their names.
//
//     base.obj smile.obj lift.target     0 smile, 1 lift: the names of the files
//     face.glb                           extras.targetNames of its meshes; target k of a motion is target k of every
//                                        mesh, so it has several names if meshes name it differently
//
// Threads    pure.

/// The names of each target, in the order of the targets. A target without a name has an empty list.
using TargetNames = std::vector<std::vector<std::string>>;

/// Returns the names of the targets in the motion of an input; empty if the input is not a set of targets. Errors:
/// those of Input::motion().
[[nodiscard]] Result<TargetNames> target_names(Input& input);

/// Finds a target by its name, or else by its number, counted from 0. Errors: kUsage for an unknown name, with the most
/// similar one, and for a name that several targets have, with their numbers.
[[nodiscard]] Result<std::size_t> find_target(const TargetNames& names, const std::string& name_or_number);

/// Returns the label of a target in tables and messages: "3 (smile)", or "3" for a target without a name.
[[nodiscard]] std::string target_label(const TargetNames& names, std::size_t target);

// Points that rest or move on straight lines, from a NumPy array: a .npy file of float32 or float64.
//
//     (n, 3)      each point rests
//     (n, 2, 3)   each point moves from the first position to the second
//
// Errors     kInvalidInput with the file, and the element, as the place ("points.npy, [17, 0, 2]"): another shape or
//            type, or coordinates that are not finite or too large for float32; kFailed if the file cannot be read.
// Threads    pure

/// The straight lines on which n points move: both ends of each line, as (n, 3) numbers. The ends of a point that rests
/// are equal.
struct PointPaths {
  std::vector<double> from, to;

  [[nodiscard]] std::size_t count() const noexcept { return from.size() / 3; }
};

[[nodiscard]] Result<PointPaths> read_points_file(const std::string& path);

/// Reads points from the bytes of a .npy file; `name` is the name of the file in messages. Errors: kInvalidInput, as
/// for a file.
[[nodiscard]] Result<PointPaths> parse_points(std::string_view bytes, const std::string& name);

// Poses of a rig from a JSON file: the weights that a program or a person gives its morph targets.
//
//     [{"jawOpen": 0.7, "mouthSmile_L": 1},     weights by the names of targets; all others are 0
//      [0, 0.7, 0, 1]]                          or one for each target of a mesh, in its order
//
// Errors     kInvalidInput with the file and a JSON pointer as the place ("poses.json, /1/jawOpen"), or a byte offset
//            if the text is not JSON; kFailed if the file cannot be read.
// Threads    pure

/// One pose of a rig. The weights are given either by name or in the order of the targets, so one of the two lists is
/// empty.
struct RigPose {
  struct Named {
    std::string target;
    double weight = 0;
    std::string place;  ///< the place of the weight in its file, for messages: "poses.json, /1/jawOpen"
  };
  std::vector<Named> named;
  std::vector<double> in_order;
  std::string place;
};

/// Reads a file of poses: at least one pose, each with finite weights.
[[nodiscard]] Result<std::vector<RigPose>> read_poses_file(const std::string& path);

/// Reads poses from JSON text: at least one pose, each with finite weights. `name` is the name of the file in messages.
[[nodiscard]] Result<std::vector<RigPose>> parse_poses(std::string_view text, const std::string& name);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_INPUT_H_
