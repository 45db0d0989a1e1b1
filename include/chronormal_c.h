/* chronormal for C, and for every language that can call C: exact normals of meshes that deform.
 *
 *     chronormal_mesh mesh = {vertex_count, face_count, corners, NULL};
 *     chronormal_curves* curves = NULL;
 *     if (chronormal_curves_create(&mesh, from, to, NULL, &curves) != CHRONORMAL_DONE)
 *       fprintf(stderr, "%s\n", chronormal_last_message());
 *     chronormal_curves_unit_normals(curves, 0.5, normals, NULL);
 *     chronormal_curves_destroy(curves);
 *
 * Shapes     Vectors are three float32, one after the other; a stride in bytes leads from one vector to the next, and 0
 *            stands for 12. Strides are multiples of 4, and 12 or more.
 * Times      t is a fraction of a segment, 0 to 1. The functions that end in _write refuse any other; the older ones move
 *            it to the nearer end, and write zeros where it is NaN.
 * Ownership  All arrays belong to the caller and are read or written during the call alone. What a function creates is
 *            destroyed by the function whose name ends in _destroy, which takes NULL as well.
 * Errors     A function that can fail returns a chronormal_status and changes nothing when it fails. The message for a
 *            person, with the place, is chronormal_last_message(), of the calling thread. Nothing throws.
 * Threads    Different objects may be used at the same time; one object by one thread at a time. But the functions that
 *            take a const object may run on any number of threads on one object.
 * Growth     Structures of options begin with their size, so that a program that was compiled with an older header
 *            keeps working: call the _init function, or set the size and every field. A library that is older than the
 *            header refuses fields that it does not know, unless their bytes are 0.
 */
#ifndef CHRONORMAL_C_H_
#define CHRONORMAL_C_H_

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define CHRONORMAL_API
#else
#define CHRONORMAL_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The values are the exit codes of the program. */
typedef enum chronormal_status {
  CHRONORMAL_DONE = 0,
  CHRONORMAL_FAILED = 1,       /* memory, files, or an internal failure */
  CHRONORMAL_USAGE = 2,        /* an argument that does not exist or fit */
  CHRONORMAL_INVALID_INPUT = 3 /* the data are wrong */
} chronormal_status;

/* Returns the version of the library that runs, MAJOR.MINOR.PATCH, as in "0.2.0". */
CHRONORMAL_API const char* chronormal_version(void);
/* Returns one sentence about the last call on this thread that failed; it stays until the next call that fails. ""
 * before that. */
CHRONORMAL_API const char* chronormal_last_message(void);

/* Polygons over vertices. With offsets, face f has the corners offsets[f] to offsets[f + 1] - 1, and there are
 * face_count + 1 offsets, the first of which is 0; with NULL every face is a triangle. */
typedef struct chronormal_mesh {
  size_t vertex_count;
  size_t face_count;
  const uint32_t* corners;
  const uint32_t* offsets;
} chronormal_mesh;

typedef struct chronormal_vectors {
  const float* data;
  size_t stride; /* bytes; 0: 12 */
} chronormal_vectors;

typedef struct chronormal_result {
  float* data;
  size_t stride; /* bytes; 0: 12 */
} chronormal_result;

typedef enum chronormal_elements {
  CHRONORMAL_FACES = 0,
  CHRONORMAL_VERTICES = 1,
  CHRONORMAL_CORNERS = 2
} chronormal_elements;

typedef struct chronormal_options {
  size_t size;           /* sizeof(chronormal_options) */
  int elements;          /* a chronormal_elements; usually CHRONORMAL_VERTICES */
  int separate;          /* not 0: vertices at one point are not joined, so that seams show */
  double crease_angle;   /* degrees, of corners: edges that are sharper at t = 0 are hard; usually 180 */
  const char* weighting; /* "area" (exact), or another name of docs/truth.md; NULL: area */
  double tolerance;      /* radians; usually 1e-6; 1e-3 needs a third of the memory */
  int all_threads;       /* not 0: work on all cores */
} chronormal_options;

CHRONORMAL_API void chronormal_options_init(chronormal_options* options);

/* How a normal lies in memory. */
typedef enum chronormal_format {
  CHRONORMAL_FLOAT32 = 0,    /* three float32 */
  CHRONORMAL_OCTAHEDRAL = 1, /* 4 bytes: two int16, the octahedral encoding as snorm; (0, 0, 0) becomes (0, 0, 1) */
  CHRONORMAL_RGB10A2 = 2     /* 4 bytes: x, y, z as snorm of 10 bits, from the lowest on */
} chronormal_format;

#define CHRONORMAL_ALL ((size_t)-1)

/* Where normals are written, and which of them: normal i lies at data + i * stride, whatever the range is. */
typedef struct chronormal_output {
  size_t size;         /* sizeof(chronormal_output) */
  void* data;          /* of normal 0 */
  size_t stride;       /* bytes; 0: as many as the format has, which is all that packed formats may have */
  int format;          /* a chronormal_format; usually CHRONORMAL_FLOAT32 */
  size_t first, count; /* the normals that are written; usually 0 and CHRONORMAL_ALL */
} chronormal_output;

CHRONORMAL_API void chronormal_output_init(chronormal_output* output, void* data);

/* Normals between two arrays of positions, exact for every t in [0, 1]. */
typedef struct chronormal_curves chronormal_curves;

/* Prepares a segment. Options may be NULL. There is one position at each end for each vertex. */
CHRONORMAL_API chronormal_status chronormal_curves_create(const chronormal_mesh* mesh, chronormal_vectors from,
                                                          chronormal_vectors to, const chronormal_options* options,
                                                          chronormal_curves** result);
/* Prepares the next segment of the same mesh, in the memory of the one before. The vertices that share a normal stay
 * the same. */
CHRONORMAL_API chronormal_status chronormal_curves_next(chronormal_curves* curves, chronormal_vectors from,
                                                        chronormal_vectors to);
/* Returns the number of normals: faces, vertices or corners. */
CHRONORMAL_API size_t chronormal_curves_size(const chronormal_curves* curves);
/* Returns the bytes that the curves keep. */
CHRONORMAL_API size_t chronormal_curves_bytes(const chronormal_curves* curves);
/* Writes the unit normals at t, (0, 0, 0) for elements without one; zeros, if it is not NULL, gets the number of (0,
 * 0, 0). */
CHRONORMAL_API chronormal_status chronormal_curves_unit_normals(chronormal_curves* curves, double t,
                                                                chronormal_result normals, size_t* zeros);
/* Writes the unit normals at many t, each to an output of its own; zeros, if it is not NULL, gets the number of (0, 0, 0)
 * among all. On the calling thread, without taking memory: jobs of an engine write ranges of one output. */
CHRONORMAL_API chronormal_status chronormal_curves_write(const chronormal_curves* curves, const double* times,
                                                         const chronormal_output* outputs, size_t count, size_t* zeros);
/* Writes the angle in degrees, float32, between each normal that is given (of any length) and the exact one at t: how
 * wrong an interpolation is. 180 where one of the two has no direction and the other has. */
CHRONORMAL_API chronormal_status chronormal_curves_errors(chronormal_curves* curves, double t,
                                                          chronormal_vectors normals, float* degrees);
CHRONORMAL_API void chronormal_curves_destroy(chronormal_curves* curves);

/* One morph target: the deltas that it adds to the vertices that it names, which ascend; with NULL, to every vertex. */
typedef struct chronormal_target {
  size_t count;             /* of deltas */
  const uint32_t* vertices; /* count of them, or NULL */
  chronormal_vectors deltas;
} chronormal_target;

/* Normals of blend shapes, exact at any weights. */
typedef struct chronormal_blend chronormal_blend;

/* Prepares blend shapes. In the options, tolerance must be 1e-6 and the weighting area. */
CHRONORMAL_API chronormal_status chronormal_blend_create(const chronormal_mesh* mesh, chronormal_vectors base,
                                                         const chronormal_target* targets, size_t target_count,
                                                         const chronormal_options* options, chronormal_blend** result);
CHRONORMAL_API size_t chronormal_blend_size(const chronormal_blend* blend);
/* Writes the unit normals at some weights, one weight for each target. */
CHRONORMAL_API chronormal_status chronormal_blend_unit_normals(chronormal_blend* blend, const double* weights,
                                                               chronormal_result normals, size_t* zeros);
/* Moves the shapes to these weights, once for a frame; then ranges of the normals there are written by any threads. */
CHRONORMAL_API chronormal_status chronormal_blend_set_weights(chronormal_blend* blend, const double* weights);
CHRONORMAL_API chronormal_status chronormal_blend_write(const chronormal_blend* blend, const chronormal_output* output,
                                                        size_t* zeros);
CHRONORMAL_API void chronormal_blend_destroy(chronormal_blend* blend);

/* A motion in files, of every format that the program reads. */
typedef struct chronormal_motion chronormal_motion;

/* Reads files as on the command line of `chronormal sample`; the tolerance of the options does not count. */
CHRONORMAL_API chronormal_status chronormal_motion_read(const char* const* files, size_t file_count,
                                                        const chronormal_options* options, chronormal_motion** result);
/* Sets how vertices of a sequence move from now on, as `chronormal sample --path` does: "linear" (at first),
 * "catmull-rom", on curves through the keyframes, or "hermite", with the velocities of the file. Curves are cut into
 * straight pieces, whose normals are within 0.01 degrees (or the tolerance in "catmull-rom:0.1") of those of the
 * curve, plus what the rounding of positions to float adds. Errors: CHRONORMAL_USAGE if the motion has no such
 * paths. */
CHRONORMAL_API chronormal_status chronormal_motion_follow(chronormal_motion* motion, const char* path);
/* Returns the number of normals: faces, vertices or corners. */
CHRONORMAL_API size_t chronormal_motion_size(const chronormal_motion* motion);
/* Gives the first and the last time, in seconds; 0 and 0 for targets. */
CHRONORMAL_API void chronormal_motion_times(const chronormal_motion* motion, double* first, double* last);
CHRONORMAL_API chronormal_status chronormal_motion_unit_normals(chronormal_motion* motion, double time,
                                                                chronormal_result normals);
CHRONORMAL_API void chronormal_motion_destroy(chronormal_motion* motion);

#ifdef __cplusplus
}
#endif

#endif /* CHRONORMAL_C_H_ */
