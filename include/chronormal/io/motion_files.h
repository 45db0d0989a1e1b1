/// Motions from files of every format, and back.
///
///     walk.npz                        a whole motion: .npz or .md2
///     face.glb                        the morph targets of a glTF file (.gltf, .glb), or one of its animations
///     body.obj walk.pc2               a mesh and a point cache: .pc2, .mdd, .npy, .mc, .mcx, or a Maya .xml
///     body.obj cache.xml#bodyShape    the same, with the channel of a Maya cache
///     walk_0.obj walk_1.obj, walk/    a sequence of meshes (io/sequence.h)
#ifndef CHRONORMAL_IO_MOTION_FILES_H_
#define CHRONORMAL_IO_MOTION_FILES_H_

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/io/sequence.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

struct MotionOptions {
  double frames_per_second = 1;  ///< from 1e-9 to 1e9
  std::string animation;         ///< of a glTF file, by name or index; empty: its morph targets (io/gltf_motion.h)
  bool allow_external = false;   ///< a glTF file may name buffers outside its folder
  bool world = false;            ///< vertices of a glTF file are where its nodes put them
};

/// Reads the motion that the inputs stand for. The result is valid (validate() in motion/motion.h).
///
/// One file of a whole motion, which "-" may be too; or two inputs of which one is a cache by its extension, in either
/// order, and the other a mesh; anything else is read_sequence(). The frame rate of the options is that of formats that
/// have no times of their own, or count them in frames (npz without times, npy, MD2, PC2); MDD, Maya and npz with times
/// keep their seconds. progress(done, total), if given, is called after each file.
///
/// Errors: those of opening and of the readers, with the file name in the place; of motion_from_cache() and of
/// read_sequence(); kUsage for a cache without a mesh or with several, for a whole motion among other inputs, for an
/// animation of what is no glTF file, and for a frame rate out of range.
[[nodiscard]] Result<Motion> read_motion(std::span<const std::string> inputs, const MotionOptions& options,
                                         const std::function<void(std::size_t done, std::size_t total)>& progress = {});

/// Reads what the inputs stand for even if it does not move: where they are a single .obj or .ply file, or a glTF file
/// without morph targets, the result is one keyframe without a segment (and so not valid by itself); else it is that of
/// read_motion(). Errors: the same.
[[nodiscard]] Result<Motion> read_motion_or_mesh(
    std::span<const std::string> inputs, const MotionOptions& options,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

/// The same for one input whose bytes are there already, the standard input ("-") above all.
[[nodiscard]] Result<Motion> read_motion_or_mesh(std::string_view bytes, const std::string& input,
                                                 const MotionOptions& options);

/// Whether an input is a glTF file by its extension.
[[nodiscard]] bool is_gltf_file(const std::string& input);

/// Writes a motion to one file by the extension of path, .npz (whole), .pc2 or .mdd (positions alone), or else by
/// write_sequence(). PC2 gets one frame a second, which read_motion() takes back at its default rate.
///
/// Errors: those of the writers, with path as the place, and of write_output(); nothing is written then.
[[nodiscard]] Status write_motion(const Motion& motion, const std::string& path, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_MOTION_FILES_H_
