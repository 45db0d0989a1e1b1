/// The files that inputs stand for, and one mesh out of them: what sequences, targets and caches share. Private to io.
#ifndef CHRONORMAL_IO_INPUT_INPUT_FILES_H_
#define CHRONORMAL_IO_INPUT_INPUT_FILES_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"
#include "chronormal/motion/motion.h"
#include "io/mesh/mesh_frame.h"

namespace chronormal::inline internal {

/// A motion as it is read from files, and what they store beside it.
struct ReadMotion {
  Motion motion;
  std::optional<MotionStream> stream = {};  ///< of the motion, or in place of it where keyframes are still in files
  StoredNormals normals;
  std::vector<std::uint32_t> group_of_face;
  std::string shaded_by;  ///< as Input has it
  std::vector<std::string> other_files =
      {};                                 ///< of a sequence: that tell, where its first file has no more digits than
                                          ///< float32, whether others have
  std::uint64_t bytes_read = 0;           ///< of all files
  std::vector<std::string> notes = {};    ///< as Input has them
  std::optional<FileSeries> series = {};  ///< as Input has it
};

/// Which files of a folder count, in any order.
using FolderLister = std::function<Result<std::vector<std::string>>(const std::string& folder)>;

/// Whether path a stands before b where runs of digits count as numbers of any size; ties are broken by plain order.
[[nodiscard]] bool stands_before(const std::string& a, const std::string& b);

/// Sorts the files of the folder or pattern `input`.
using FileSorter = std::function<Status(const std::string& input, std::vector<std::string>& files)>;
/// Sorts them by stands_before().
[[nodiscard]] Status sort_by_number(const std::string& input, std::vector<std::string>& files);

/// The files that the options stand for, in order, as io/input.h describes them; folders are asked of list_folder, and
/// what is found in folders and by patterns is sorted by `sort`. Does
/// not open them. Errors: kFailed where nothing of that name exists or nothing matches a pattern; kUsage for "-" twice;
/// those of list_folder and sort. The place is the input.
[[nodiscard]] Result<std::vector<std::string>> find_input_files(const InputOptions& options,
                                                                const FolderLister& list_folder,
                                                                const FileSorter& sort = sort_by_number);

/// The last part of a path; "<stdin>" for "-".
[[nodiscard]] std::string file_name_of(const std::string& path);

/// Opens and reads the mesh of the next keyframe of read, whose shading read takes where the options keep it. The place
/// of every error is `place`, or begins with it.
[[nodiscard]] Result<MeshFrame> read_mesh_file(const InputOptions& options, const std::string& path,
                                               const std::string& place, ReadMotion& read);
/// The same of bytes that are there.
[[nodiscard]] Result<MeshFrame> read_next_mesh(const InputOptions& options, std::string_view bytes,
                                               const std::string& path, const std::string& place, ReadMotion& read);

/// The keyframes that the options choose among so many; of a loop, the first of them comes again at the end. Errors:
/// kUsage with the option as the place, where there are fewer than two.
[[nodiscard]] Result<std::vector<std::size_t>> choose_frames(std::size_t count, const InputOptions& options);

/// The time at which a loop comes back to the first of these keyframes, which is the last one, too. times are those of
/// all keyframes of the sequence.
[[nodiscard]] double closing_time(std::span<const double> times, std::span<const std::size_t> frames);

/// Gives the ends of the keyframes that were chosen their end_velocities, where vertices move on curves and the
/// velocities depend on keyframes beyond these ends. Of every N-th keyframe these are every N-th, too.
/// times are those of all keyframes of the sequence, and read(k) gives the positions of one of them.
[[nodiscard]] Status set_end_velocities(const InputOptions& options, std::span<const double> times,
                                        const std::function<Result<std::vector<float>>(std::size_t k)>& read,
                                        Motion& chosen);

/// Whether other has the vertex count and the faces of first, which messages call first_name.
[[nodiscard]] Status check_same_topology(const Topology& first, const std::string& first_name, const Topology& other,
                                         const std::string& place);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_INPUT_FILES_H_
