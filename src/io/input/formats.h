/// Lists all file formats: how each format is recognised, what kind of data it contains, and which functions read and
/// write it. Private to io.
///
/// To add a format, add an entry to the table. tests/io/input/formats_test.cpp and motion_readers_test.cpp go through
/// the table. Both tests fail for a reader that has no truncation, boundary and mutation tests, or no fuzz target
/// fuzz/NAME_fuzz.cpp.
#ifndef CHRONORMAL_IO_INPUT_FORMATS_H_
#define CHRONORMAL_IO_INPUT_FORMATS_H_

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/output_file.h"
#include "io/cache/cache_layout.h"
#include "io/cache/position_cache.h"
#include "io/mesh/mesh_frame.h"

namespace chronormal::inline internal {

/// The kind of data in a file.
enum class Holds {
  kMesh,    ///< one mesh: a keyframe of a sequence, a target, or the faces of a cache
  kTarget,  ///< deltas that a target adds to a base (io/mesh/make_human_target.h)
  kGltf,    ///< a glTF document (chronormal/io/gltf_document.h)
  kMotion,  ///< a whole motion
  kCache,   ///< positions over time, for a mesh in another file
};

struct Format {
  std::string_view name;  ///< name for messages and for the fuzz target: "obj"
  Holds holds;
  std::span<const std::string_view> extensions;  ///< extensions of file names in lower case and with the dot: ".obj"
  /// Returns true if a file that begins with these bytes (a few hundred are enough) looks like this format. The pointer
  /// is nullptr for a format that is recognised only by its extension.
  bool (*recognises)(std::string_view first_bytes) = nullptr;

  // Only one of read_mesh, read_motion and read_cache is set: the function for the kind of data that the format holds.
  // The others are nullptr. All three are nullptr for glTF, targets and descriptions of Maya caches, which cannot be
  // read from one block of bytes alone. `name` is the name of the file for messages. A reader of meshes subtracts the
  // origin from positions (io/mesh/far_origin.h). Errors: kInvalidInput, always with a place.
  Result<MeshFrame> (*read_mesh)(std::string_view bytes, const std::string& name, const Origin& origin) = nullptr;
  /// Reads a mesh with its smoothing groups and normals; nullptr if the reader of the format ignores them.
  Result<MeshFrame> (*read_shaded_mesh)(std::string_view bytes, const std::string& name,
                                        const Origin& origin) = nullptr;
  /// Reads a mesh with its velocities; nullptr if the format has no velocities.
  Result<MeshFrame> (*read_moving_mesh)(std::string_view bytes, const std::string& name,
                                        const Origin& origin) = nullptr;
  Result<Motion> (*read_motion)(std::string_view bytes, const std::string& name, double frames_per_second,
                                std::size_t max_expansion) = nullptr;
  /// Reads the same motion as read_motion, but leaves the positions of keyframes in the file; nullptr if keyframes
  /// cannot be read one by one.
  Result<Motion> (*read_outline)(std::string_view bytes, const std::string& name, double frames_per_second,
                                 std::size_t max_expansion, std::optional<CacheLayout>& layout) = nullptr;
  Result<PositionCache> (*read_cache)(std::string_view bytes, const std::string& name,
                                      const CacheOptions& options) = nullptr;

  /// Finds the offsets at which a cache file stores its samples. Each sample has the positions at one time
  /// (io/cache/cache_layout.h). The function is nullptr if samples cannot be read one by one.
  Result<CacheLayout> (*find_layout)(std::string_view bytes, std::uint64_t size, const std::string& name,
                                     const CacheOptions& options) = nullptr;

  // The next two functions write a mesh and a motion in the format. A function is nullptr if writing is not supported.
  std::string (*write_mesh)(const Topology& topology, VectorView<const float> positions,
                            const Origin& origin) = nullptr;
  Status (*write_motion)(MotionStream& stream, OutputFile& file) = nullptr;
};

/// Returns all formats. The format of a file without a known extension is the first one whose `recognises` returns
/// true.
[[nodiscard]] std::span<const Format> formats() noexcept;

/// Returns the format that has the extension of the file name, in upper or lower case, or nullptr if no format has this
/// extension.
[[nodiscard]] const Format* find_format(std::string_view file_name) noexcept;

/// Returns the format of a file by its extension. If the extension is unknown or missing, as for the standard input,
/// returns the format by the content. Returns nullptr if the content does not tell the format either.
[[nodiscard]] const Format* find_format(std::string_view file_name, std::string_view bytes) noexcept;

/// Returns the first words of a message about a file of unknown format: "this is a PNG image" if the kind of the bytes
/// is known, and otherwise "the file is not WHAT, by its name and its content".
[[nodiscard]] std::string unknown_format(std::string_view bytes, std::string_view what);

/// Returns advice for a file that is not supported but that other programs can convert: "this is an FBX file, which is
/// not read: ...". The format is recognised by the name or the first bytes of the file. Returns an empty text for all
/// files without such advice.
[[nodiscard]] std::string way_in(std::string_view file_name, std::string_view bytes);

/// Returns the extensions of all formats that hold one of these kinds of data, for messages: ".obj, .ply". `last` is
/// the separator before the last extension.
[[nodiscard]] std::string extensions_of(std::initializer_list<Holds> kinds, std::string_view last = ", ");

/// The data to read from a mesh file besides positions and faces, if its format has such data. No format has both
/// shading and velocities.
struct WantedOfMesh {
  bool shading = false;
  bool velocities = false;
  Origin origin = {};  ///< the point that is subtracted from positions
};

/// Reads a mesh, with the data in `wanted` that the file stores. The format is found by the file name or the content.
/// `place` is for messages, and begins the place of every error. Errors: kInvalidInput if the format does not contain a
/// mesh, with a message that lists the supported formats; those of the reader.
[[nodiscard]] Result<MeshFrame> read_mesh(std::string_view bytes, const std::string& file_name,
                                          const std::string& place, WantedOfMesh wanted = {});

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_FORMATS_H_
