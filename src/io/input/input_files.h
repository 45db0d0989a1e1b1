/// Finds the files of inputs, and reads single meshes, for sequences, targets and caches. Private to io.
#ifndef CHRONORMAL_IO_INPUT_INPUT_FILES_H_
#define CHRONORMAL_IO_INPUT_INPUT_FILES_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"
#include "chronormal/motion/motion.h"
#include "io/input/formats.h"
#include "io/mesh/mesh_frame.h"

namespace chronormal::inline internal {

/// A motion as it was read from files, with other data from the files.
struct ReadMotion {
  Motion motion;
  std::optional<MotionStream> stream = {};  ///< the motion as a stream, if its keyframes are still in files
  StoredNormals normals;
  /// Reads the normals that a keyframe stores, if keyframes are still in files that store normals.
  std::function<Result<std::vector<float>>(std::size_t keyframe)> read_normals = {};
  std::vector<std::uint32_t> group_of_face;
  std::string shaded_by;  ///< the same as in class Input
  /// The files of a sequence that are examined for coordinates with more digits than float32 holds, if the first file
  /// has no such coordinates.
  std::vector<std::string> other_files = {};
  std::uint64_t bytes_read = 0;           ///< total size of the files in bytes
  std::vector<std::string> notes = {};    ///< the same as in class Input
  std::optional<FileSeries> series = {};  ///< the same as in class Input
};

/// A function that returns the files of a folder that belong to the input, in any order.
using FolderLister = std::function<Result<std::vector<std::string>>(const std::string& folder)>;

/// Returns true if path `a` comes before path `b`. Runs of digits are compared as numbers of any size. Paths that are
/// equal in this way are compared character by character.
[[nodiscard]] bool stands_before(const std::string& a, const std::string& b);

/// A function that sorts the files of the folder or the pattern `input`.
using FileSorter = std::function<Status(const std::string& input, std::vector<std::string>& files)>;
/// Sorts `files` by their paths, as stands_before() compares paths.
[[nodiscard]] Status sort_by_number(const std::string& input, std::vector<std::string>& files);

/// Returns the files that the options name, in order, as io/input.h describes. list_folder() lists folders, and sort()
/// sorts the files of folders and patterns. No file is opened. Errors: kFailed if nothing of that name exists or
/// nothing matches a pattern; kUsage for "-" twice; the errors of list_folder() and sort(). The place of an error is
/// the input.
[[nodiscard]] Result<std::vector<std::string>> find_input_files(const InputOptions& options,
                                                                const FolderLister& list_folder,
                                                                const FileSorter& sort = sort_by_number);

/// Returns the last part of a path, or "<stdin>" for the path "-".
[[nodiscard]] std::string file_name_of(const std::string& path);

/// Reads the mesh of the next keyframe of `read` from the file `path`. Adds the shading of the mesh to `read` if the
/// options keep it. The place of every error is `place`, or begins with it.
[[nodiscard]] Result<MeshFrame> read_mesh_file(const InputOptions& options, const std::string& path,
                                               const std::string& place, ReadMotion& read);
/// Reads the mesh of the next keyframe like read_mesh_file(), from bytes that are in memory.
[[nodiscard]] Result<MeshFrame> read_next_mesh(const InputOptions& options, std::string_view bytes,
                                               const std::string& path, const std::string& place, ReadMotion& read);

/// Reads a mesh of a motion, whose positions are measured from wanted.origin. If the mesh is so far from this point
/// that float32 loses digits, the mesh is read with an origin of its own, and its positions relative to wanted.origin
/// are stored as float32 positions plus residuals (MeshFrame::residuals). Errors: those of read_mesh().
[[nodiscard]] Result<MeshFrame> read_mesh_from(std::string_view bytes, const std::string& file_name,
                                               const std::string& place, const WantedOfMesh& wanted);

/// Returns the indices of the keyframes that the options select out of `count` keyframes. For a loop, the first
/// selected index is repeated at the end. Errors: kUsage with the option as the place, if fewer than two keyframes are
/// left.
[[nodiscard]] Result<std::vector<std::size_t>> choose_frames(std::size_t count, const InputOptions& options);

/// Returns the time in seconds at which a loop comes back to its first keyframe. `frames` are the indices of the chosen
/// keyframes; the last index repeats the first. `times` are the times of all keyframes of the sequence.
[[nodiscard]] double closing_time(std::span<const double> times, std::span<const std::size_t> frames);

/// Sets end_velocities of the first and the last chosen keyframe. These velocities are needed if vertices move on
/// curves and the velocities at the ends depend on keyframes that were not chosen. If every N-th keyframe is chosen,
/// the keyframes beyond the ends are also N apart. `times` are the times of all keyframes of the sequence, and read(k)
/// returns the positions of keyframe k.
[[nodiscard]] Status set_end_velocities(const InputOptions& options, std::span<const double> times,
                                        const std::function<Result<std::vector<float>>(std::size_t k)>& read,
                                        Motion& chosen);

/// Checks that `other` has the same number of vertices and the same faces as `first`. Error messages call the first
/// mesh first_name.
[[nodiscard]] Status check_same_topology(const Topology& first, const std::string& first_name, const Topology& other,
                                         const std::string& place);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_INPUT_FILES_H_
