/// A mesh from one file: a keyframe of a sequence, a target, or the faces for a cache.
#ifndef CHRONORMAL_IO_MESH_MESH_FRAME_H_
#define CHRONORMAL_IO_MESH_MESH_FRAME_H_

#include <cstdint>
#include <string>
#include <vector>

#include "chronormal/motion/motion.h"
#include "io/mesh/far_origin.h"

namespace chronormal::inline internal {

/// The result of a mesh reader, which has at least one vertex and one face, and only finite positions.
struct MeshFrame {
  Topology topology;
  std::vector<float> positions;  ///< (V, 3), V = topology.vertex_count()
  /// The differences between the exact positions and `positions`, which float32 cannot hold (Motion::Keyframe). Readers
  /// of formats leave this list empty; read_mesh_from() fills it.
  std::vector<double> residuals = {};

  /// True if subtracting the caller's origin from the positions kept digits that float32 would otherwise have lost.
  bool has_more_digits = false;
  /// Sentences for the user, one for each kind of data in the file that the reader left out.
  std::vector<std::string> notes = {};

  /// The velocity of each vertex, (V, 3), in length units per second. Empty unless the caller requests velocities and
  /// the file has them.
  std::vector<float> velocities = {};

  // The next members describe the shading of the mesh in the file. These members are empty unless the caller requests
  // them.
  /// The smoothing group of each face, numbered from 1 in the order in which the file names the groups; 0 for a face in
  /// no group. Empty if the file has no groups.
  std::vector<std::uint32_t> group_of_face = {};
  /// The normal of each corner as in the file, (corners, 3), not normalised, and (0, 0, 0) for a corner without a
  /// normal. Empty if no corner of the file has a normal.
  std::vector<float> normal_of_corner = {};
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_MESH_MESH_FRAME_H_
