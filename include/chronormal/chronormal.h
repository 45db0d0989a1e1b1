/// chronormal: the normals of triangle meshes that deform. Includes all public headers of the library `chronormal`, in
/// the order in which they build on each other. A header includes only headers of its own folder and of folders that
/// come earlier in this list. chronormal_io.h adds the headers for files and for the workflows on files.
#ifndef CHRONORMAL_CHRONORMAL_H_
#define CHRONORMAL_CHRONORMAL_H_

#include "chronormal/core/parallel.h"    // a parallel loop over all cores, which its caller can end
#include "chronormal/core/polynomial.h"  // small polynomials: Bernstein and power form, roots, restriction
#include "chronormal/core/result.h"      // errors as values: code, place, message
#include "chronormal/core/vec3.h"        // three-component vectors over any scalar
#include "chronormal/core/views.h"       // vectors in the caller's memory, as planes or packed

#include "chronormal/motion/motion.h"  // faces, keyframes in memory or in a stream, segments, sets of targets
#include "chronormal/motion/paths.h"   // curves through keyframes, cut into straight pieces

#include "chronormal/normals/control_normals.h"  // n(t) as three control normals, and their transforms
#include "chronormal/normals/float_recompute.h"  // normals computed anew from positions, in float32
#include "chronormal/normals/mesh_normals.h"     // unit normals between keyframes, or at weights; begin here
#include "chronormal/normals/normal_curves.h"    // curves of normals: prepared once, evaluated at the speed of memory
// Groups of corners that share a normal, and sums over these groups.
#include "chronormal/normals/normal_groups.h"
// The weightings that other tools use for vertex normals (area, angle, uniform and so on), and quadratic curves that
// are fitted to them.
#include "chronormal/normals/weighting.h"

#include "chronormal/schemes/scheme.h"  // the schemes that interpolate normals, by name

#include "chronormal/analysis/certify.h"  // bounds of the largest error of a scheme over a segment
#include "chronormal/analysis/cones.h"    // cones and bounds of clusters over an interval, means over a shutter
// The points inside a closed mesh, and the times when they cross its surface.
#include "chronormal/analysis/containment.h"
// Exact reference normals, and statistics of angular errors: sum, mean, rms and maximum.
#include "chronormal/analysis/quality.h"
// The exact times when a face collapses, and the exact sides from which a viewer sees the face.
#include "chronormal/analysis/signs.h"
#include "chronormal/analysis/surface.h"  // doubled vertices, edges, pieces, coinciding faces

#endif  // CHRONORMAL_CHRONORMAL_H_
