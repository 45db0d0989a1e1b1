/// One mesh as it is read from one file: a keyframe of a sequence, a target, or the faces of a cache.
#ifndef CHRONORMAL_IO_MESH_MESH_FRAME_H_
#define CHRONORMAL_IO_MESH_MESH_FRAME_H_

#include <cstdint>
#include <string>
#include <vector>

#include "chronormal/motion/motion.h"
#include "io/mesh/far_origin.h"

namespace chronormal::inline internal {

/// What a mesh reader returns: at least one vertex and one face, and finite positions.
struct MeshFrame {
  Topology topology;
  std::vector<float> positions;  ///< (V, 3), V = topology.vertex_count()

  /// Positions count from the origin that the reader was given, and the file has more digits than float32 would have
  /// kept of them without it.
  bool has_more_digits = false;
  /// Parts that were passed over, a sentence each.
  std::vector<std::string> notes = {};

  /// (V, 3): the velocity of each vertex, in length units per second, where that is asked for and the file has them.
  std::vector<float> velocities = {};

  // How the file says that its mesh is to be shaded, where that is asked for.
  /// The smoothing group of each face, numbered from 1 in the order in which the file names them; 0 for none. Empty
  /// where the file has no groups.
  std::vector<std::uint32_t> group_of_face = {};
  /// (corners, 3): the normal of each corner as the file has it, of any length, and (0, 0, 0) for a corner without one.
  /// Empty where no corner of the file has a normal.
  std::vector<float> normal_of_corner = {};
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_MESH_MESH_FRAME_H_
