/// Checks invariants of the result of every mesh reader, for any bytes.
#ifndef CHRONORMAL_FUZZ_MESH_INVARIANTS_H_
#define CHRONORMAL_FUZZ_MESH_INVARIANTS_H_

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/mesh/mesh_frame.h"

namespace chronormal::fuzz {

inline void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "broken invariant: %s\n", what);
  std::abort();
}

/// Aborts unless `result` is correct for an input of byte_count bytes: either an error with a code, a place and a
/// message, or a mesh. validate() must accept a motion whose two keyframes are this mesh.
inline void check_mesh_invariants(Result<MeshFrame> result, std::size_t byte_count) {
  if (!result) {
    require(result.error().code == ErrorCode::kInvalidInput, "the code of an error is kInvalidInput");
    require(!result.error().place.empty(), "an error has a place");
    require(!result.error().message.empty(), "an error has a message");
    return;
  }
  MeshFrame& frame = result.value();
  require(frame.topology.vertex_count() <= byte_count, "a vertex takes a byte or more");
  require(frame.topology.corner_count() <= byte_count, "a corner takes a byte or more");

  Motion motion;
  motion.topology = std::move(frame.topology);
  motion.keyframes.push_back({frame.positions, 0, "first", std::move(frame.velocities)});
  motion.keyframes.push_back({std::move(frame.positions), 1, "second"});
  motion.connect_as_sequence();
  require(validate(motion).ok(), "a mesh that was read is valid");
}

}  // namespace chronormal::fuzz

#endif  // CHRONORMAL_FUZZ_MESH_INVARIANTS_H_
