// Faces of any size whose targets nothing drives, as avatars are: they stand in for files that are not ours to hand on.
#ifndef RIGS_MADE_UP_RIG_H_
#define RIGS_MADE_UP_RIG_H_

#include <cstddef>
#include <string>

namespace chronormal::rigs_page {

struct MadeUpRig {
  std::size_t side = 0;  // the face is a dome of side x side vertices
  std::size_t targets = 0;
  double reach = 0;  // how far from its centre a target moves vertices; the face is 2 wide
};

// A GLB with one mesh, its normals, and for each target what exporters write: deltas of positions, and of the normals at
// its end. The same bytes on every run.
std::string made_up_rig_glb(const MadeUpRig& rig);

}  // namespace chronormal::rigs_page

#endif  // RIGS_MADE_UP_RIG_H_
