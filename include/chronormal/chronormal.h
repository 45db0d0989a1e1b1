/// chronormal: the normals of triangle meshes that deform. Includes all public headers of the library `chronormal`, in
/// the order in which they build on each other; a header includes only its own folder and the folders above it.
/// chronormal_io.h has files, and what is done with them.
#ifndef CHRONORMAL_CHRONORMAL_H_
#define CHRONORMAL_CHRONORMAL_H_

#include "chronormal/core/parallel.h"    // one loop over all cores, and how its caller ends it
#include "chronormal/core/polynomial.h"  // small polynomials: Bernstein and power form, roots, restriction
#include "chronormal/core/result.h"      // errors as values: code, place, message
#include "chronormal/core/vec3.h"        // three-component vectors over any scalar
#include "chronormal/core/views.h"       // vectors in the caller's memory, as planes or packed

#include "chronormal/motion/motion.h"  // faces, keyframes in memory or in a stream, segments, sets of targets
#include "chronormal/motion/paths.h"   // curves through keyframes, cut into straight pieces

#include "chronormal/normals/blend_normals.h"    // exact normals of blend shapes at any weights
#include "chronormal/normals/control_normals.h"  // n(t) as three control normals, and what a transform does to them
#include "chronormal/normals/mesh_normals.h"     // begin here: unit normals between keyframes, at weights
#include "chronormal/normals/normal_curves.h"    // curves of normals: prepared once, evaluated at the speed of memory
#include "chronormal/normals/normal_groups.h"    // faces, vertices, corners: who shares a normal, and their sums
#include "chronormal/normals/recompute.h"        // the baselines: the cross product anew at every t
#include "chronormal/normals/weighting.h"        // area, angle, uniform ...: the weightings that tools use, and fits

#include "chronormal/schemes/scheme.h"  // the ways to interpolate, by name

#include "chronormal/analysis/certify.h"      // bounds of the largest error of a scheme, that no sample exceeds
#include "chronormal/analysis/cones.h"        // cones and bounds of clusters over an interval, means over a shutter
#include "chronormal/analysis/containment.h"  // which points are inside a closed mesh, and when they cross its surface
#include "chronormal/analysis/quality.h"      // the exact reference, and angular errors: sum, mean, rms, max and where
#include "chronormal/analysis/signs.h"        // when a face collapses, from which side it is seen: decided exactly
#include "chronormal/analysis/surface.h"      // doubled vertices, edges, pieces, faces on each other

#endif  // CHRONORMAL_CHRONORMAL_H_
