/// The one table of file formats: how each is recognised, what it holds, and what reads and writes it. Private to io.
///
/// A new format is a new entry; tests/io/input/formats_test.cpp and motion_readers_test.cpp walk the table and fail for
/// a reader that has no truncation, boundary and mutation tests, or no fuzz target fuzz/NAME_fuzz.cpp.
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

/// What a file holds.
enum class Holds {
  kMesh,    ///< one mesh: a keyframe of a sequence, a target, or the faces of a cache
  kTarget,  ///< what a target adds to a base (io/mesh/make_human_target.h)
  kGltf,    ///< a glTF document (chronormal/io/gltf_document.h)
  kMotion,  ///< a whole motion
  kCache,   ///< positions over time, for a mesh beside it
};

struct Format {
  std::string_view name;  ///< "obj": in messages, and of its fuzz target
  Holds holds;
  std::span<const std::string_view> extensions;  ///< lower case, with the dot: ".obj"
  /// Whether a file that begins with these bytes (a few hundred are enough) looks like this format; nullptr where only
  /// the extension tells.
  bool (*recognises)(std::string_view first_bytes) = nullptr;

  // The reader that goes with what the format holds; the others are nullptr, and so is that of glTF, of targets and of
  // Maya's descriptions, which need more than bytes. name is for messages. Errors: kInvalidInput, always with a place.
  // Positions count from the origin (io/mesh/far_origin.h).
  Result<MeshFrame> (*read_mesh)(std::string_view bytes, const std::string& name, const Origin& origin) = nullptr;
  /// The same with smoothing groups and normals; nullptr where the format is read without them.
  Result<MeshFrame> (*read_shaded_mesh)(std::string_view bytes, const std::string& name,
                                        const Origin& origin) = nullptr;
  /// The same with velocities; nullptr where the format has none.
  Result<MeshFrame> (*read_moving_mesh)(std::string_view bytes, const std::string& name,
                                        const Origin& origin) = nullptr;
  Result<Motion> (*read_motion)(std::string_view bytes, const std::string& name, double frames_per_second,
                                std::size_t max_expansion) = nullptr;
  /// This function reads the same motion, but leaves the positions of keyframes in the file. It is nullptr for a format
  /// whose keyframes cannot be read one by one.
  Result<Motion> (*read_outline)(std::string_view bytes, const std::string& name, double frames_per_second,
                                 std::size_t max_expansion, std::optional<CacheLayout>& layout) = nullptr;
  Result<PositionCache> (*read_cache)(std::string_view bytes, const std::string& name,
                                      const CacheOptions& options) = nullptr;

  /// Finds where samples lie (io/cache/cache_layout.h); nullptr where they cannot be read one by one.
  Result<CacheLayout> (*find_layout)(std::string_view bytes, std::uint64_t size, const std::string& name,
                                     const CacheOptions& options) = nullptr;

  // What writes it; nullptr where nothing does.
  std::string (*write_mesh)(const Topology& topology, VectorView<const float> positions,
                            const Origin& origin) = nullptr;
  Status (*write_motion)(MotionStream& stream, OutputFile& file) = nullptr;
};

/// All formats, in the order in which they are asked whether they recognise a file.
[[nodiscard]] std::span<const Format> formats() noexcept;

/// The format whose extension the file name has, in upper or lower case; nullptr if there is none.
[[nodiscard]] const Format* find_format(std::string_view file_name) noexcept;

/// The format of a file: by its extension, or else by its content (the standard input, an extension unknown). nullptr
/// if neither tells.
[[nodiscard]] const Format* find_format(std::string_view file_name, std::string_view bytes) noexcept;

/// "neither the name nor the content tells the format", where what is "the format"; or "this is a PNG image", where the
/// bytes are of a known kind: how messages begin about a file that has no format.
[[nodiscard]] std::string unknown_format(std::string_view bytes, std::string_view what);

/// Says what to do about a file of a format that is not read here and that other programs turn into one that is, by its
/// name or its first bytes: "this is an FBX file, which is not read: ..."; empty where it is none of these.
[[nodiscard]] std::string way_in(std::string_view file_name, std::string_view bytes);

/// ".obj, .ply": the extensions of all formats that hold one of these, for messages; the last after `last`.
[[nodiscard]] std::string extensions_of(std::initializer_list<Holds> kinds, std::string_view last = ", ");

/// What is wanted of a mesh file beside positions and faces, where its format has it. No format has both.
struct WantedOfMesh {
  bool shading = false;
  bool velocities = false;
  Origin origin = {};  ///< that positions are to count from
};

/// Reads a mesh in the format that it has, with what is wanted and the format has; place is for messages, and begins
/// that of every error. Errors: kInvalidInput where the format is none of a mesh; the message
/// lists what can be read; those of the reader.
[[nodiscard]] Result<MeshFrame> read_mesh(std::string_view bytes, const std::string& file_name,
                                          const std::string& place, WantedOfMesh wanted = {});

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_FORMATS_H_
