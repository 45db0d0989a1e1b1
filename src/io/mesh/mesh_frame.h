/// One keyframe as it is read from one file of a sequence.
#ifndef CHRONORMAL_IO_MESH_MESH_FRAME_H_
#define CHRONORMAL_IO_MESH_MESH_FRAME_H_

#include <vector>

#include "chronormal/motion/topology.h"

namespace chronormal {

/// What a mesh reader returns: at least one vertex and one face, and finite positions.
struct MeshFrame {
  Topology topology;
  std::vector<float> positions;  ///< (V, 3), V = topology.vertex_count()
};

}  // namespace chronormal

#endif  // CHRONORMAL_IO_MESH_MESH_FRAME_H_
