/// chronormal with files: all public headers of the library `chronormal_io`, behind those of `chronormal`.
#ifndef CHRONORMAL_CHRONORMAL_IO_H_
#define CHRONORMAL_CHRONORMAL_IO_H_

#include "chronormal/chronormal.h"

#include "chronormal/io/gltf_document.h"  // glTF 2.0 files: what is in them, and changes that keep every other byte
#include "chronormal/io/input.h"          // the one door: motions, meshes and documents from files of every format
#include "chronormal/io/output.h"         // files that nobody ever sees half of, motions among them

#include "chronormal/workflow/audit.h"    // what a viewer shows against what it should
#include "chronormal/workflow/bake.h"     // right normals written into glTF files
#include "chronormal/workflow/compare.h"  // the paper's Table 1 for any motion; schemes against keyframes left out
#include "chronormal/workflow/errors.h"   // errors of shown normals, added up, and every one as arrays and files
#include "chronormal/workflow/inspect.h"  // what a motion or a glTF file holds, and what is trouble for normals
#include "chronormal/workflow/query.h"    // questions about whole intervals of time, answered as arrays
#include "chronormal/workflow/sample.h"   // normals at chosen times, or at weights of targets, and files of them
#include "chronormal/workflow/viewers.h"  // programs that show glTF files, and what they make of stored normals

#endif  // CHRONORMAL_CHRONORMAL_IO_H_
