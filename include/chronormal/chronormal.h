/// chronormal: the normals of triangle meshes that deform. All public headers, in the order in which they build on each
/// other; a header includes only its own folder and those above it.
#ifndef CHRONORMAL_CHRONORMAL_H_
#define CHRONORMAL_CHRONORMAL_H_

#include "chronormal/core/interruption.h"  // computations that their caller ends in the middle
#include "chronormal/core/parallel.h"      // one loop over all cores
#include "chronormal/core/polynomial.h"    // small polynomials: Bernstein and power form, roots, restriction
#include "chronormal/core/result.h"        // errors as values: code, place, message
#include "chronormal/core/vec3.h"          // three-component vectors over any scalar
#include "chronormal/core/views.h"         // vectors in the caller's memory, as planes or packed

#include "chronormal/motion/blend_set.h"      // a base and targets, with any weights at once
#include "chronormal/motion/motion.h"         // keyframes, the straight segments between them, and where a time lies
#include "chronormal/motion/motion_stream.h"  // keyframes that are read when they are needed
#include "chronormal/motion/paths.h"          // curves through keyframes, cut into straight pieces
#include "chronormal/motion/topology.h"       // which vertices make which face

#include "chronormal/normals/blend_normals.h"    // exact normals of blend shapes at any weights
#include "chronormal/normals/control_normals.h"  // n(t) as three control normals, in double
#include "chronormal/normals/elements.h"         // faces, vertices, corners, and who shares a normal
#include "chronormal/normals/encodings.h"        // unit normals in four bytes: octahedral, 10-10-10-2
#include "chronormal/normals/float_recompute.h"  // the fastest rival: in float32, without a promise
#include "chronormal/normals/mesh_normals.h"     // begin here: unit normals between keyframes, at weights
#include "chronormal/normals/normal_curves.h"    // curves of normals: prepared once, evaluated at the speed of memory
#include "chronormal/normals/normal_groups.h"    // which corners share a normal, and the sums of those that do
#include "chronormal/normals/recompute.h"        // the rival: the cross product anew at every t
#include "chronormal/normals/transform.h"        // rigid and affine motion: normals of meshes that move as a whole
#include "chronormal/normals/weighting.h"        // area, angle, uniform ...: the weightings that tools use, and fits

#include "chronormal/schemes/scheme.h"  // the ways to interpolate, by name

#include "chronormal/analysis/certify.h"         // bounds of the largest error of a scheme, that no sample exceeds
#include "chronormal/analysis/cluster_bounds.h"  // bounds of clusters over an interval, in the layout of meshoptimizer
#include "chronormal/analysis/collapse.h"        // when a face has no area, and whether it turns over: decided exactly
#include "chronormal/analysis/cones.h"           // cones that contain all normals of an interval
#include "chronormal/analysis/containment.h"  // which points are inside a closed mesh, and when they cross its surface
#include "chronormal/analysis/facing.h"       // from which side a face is seen, at every instant; silhouettes over time
#include "chronormal/analysis/quality.h"      // the exact reference, and angular errors: sum, mean, rms, max and where
#include "chronormal/analysis/shutter.h"      // mean normals over an open shutter
#include "chronormal/analysis/surface.h"      // doubled vertices, edges, pieces, faces on each other

#include "chronormal/io/bake_mark.h"       // what a bake leaves in a glTF file about itself
#include "chronormal/io/builtin_morphs.h"  // morphs that need no file
#include "chronormal/io/expansion.h"       // how much a file may make us hold or write
#include "chronormal/io/gltf_document.h"   // glTF 2.0 files: what is in them, and their meshes as arrays
#include "chronormal/io/gltf_edit.h"       // changes to a glTF file that keep every other byte
#include "chronormal/io/input.h"           // the one door: motions, meshes and documents from files of every format
#include "chronormal/io/output.h"          // files that nobody ever sees half of, motions among them
#include "chronormal/io/points_file.h"     // points that rest or move, from a NumPy array
#include "chronormal/io/poses_file.h"      // poses of a rig from a JSON file
#include "chronormal/io/target_names.h"    // morph targets by name

#include "chronormal/workflow/audit.h"    // what a viewer shows against what it should
#include "chronormal/workflow/bake.h"     // right normals written into glTF files
#include "chronormal/workflow/compare.h"  // the paper's Table 1 for any motion; deltas of targets against the truth
#include "chronormal/workflow/errors.h"   // every error of an audit or a comparison, as arrays and files
#include "chronormal/workflow/inspect.h"  // what a motion or a glTF file holds, and what is trouble for normals
#include "chronormal/workflow/json.h"     // the results of these as JSON
#include "chronormal/workflow/motion_error.h"  // errors of shown normals, added up
#include "chronormal/workflow/query.h"         // questions about whole intervals of time, answered as arrays
#include "chronormal/workflow/report.h"  // what a page needs to show an input as it is shown beside as it should be
#include "chronormal/workflow/sample.h"  // normals at chosen times, or at weights of targets, and files of them
#include "chronormal/workflow/truth.h"
#include "chronormal/workflow/viewers.h"  // programs that show glTF files, and what they make of stored normals

#endif  // CHRONORMAL_CHRONORMAL_H_
