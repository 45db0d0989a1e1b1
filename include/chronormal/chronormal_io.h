/// chronormal with files. Includes all public headers of the library `chronormal_io`, after those of the library
/// `chronormal`.
#ifndef CHRONORMAL_CHRONORMAL_IO_H_
#define CHRONORMAL_CHRONORMAL_IO_H_

#include "chronormal/chronormal.h"

#include "chronormal/io/gltf_document.h"  // glTF 2.0 files: their contents, and edits that keep every other byte
#include "chronormal/io/input.h"          // motions, meshes and documents from files of every format
#include "chronormal/io/output.h"         // atomic writing of files and motions

#include "chronormal/workflow/audit.h"  // errors of the normals that viewers render from a file
#include "chronormal/workflow/bake.h"   // true normals written into glTF files
// Comparisons of interpolation schemes: Table 1 of the paper for any motion, and errors at keyframes that are left out.
#include "chronormal/workflow/compare.h"
#include "chronormal/workflow/errors.h"  // errors of rendered normals: sums, or every single error as arrays and files
// The contents of a motion or a glTF file, and possible problems of its normals.
#include "chronormal/workflow/inspect.h"
#include "chronormal/workflow/query.h"    // queries about whole intervals of time, answered as arrays
#include "chronormal/workflow/sample.h"   // normals at chosen times, or at weights of targets, and files of them
#include "chronormal/workflow/viewers.h"  // programs that show glTF files, and their rules for stored normals

#endif  // CHRONORMAL_CHRONORMAL_IO_H_
