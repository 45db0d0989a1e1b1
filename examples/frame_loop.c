/* A frame loop in C: two captured frames of a mesh, and the normals of the frames shown between them. The ranges are
 * what an engine would give to its jobs, which may run at the same time. */
#include <chronormal_c.h>
#include <stdio.h>

enum { kVertices = 4, kFaces = 2, kJobs = 2, kShown = 3 };

int main(void) {
  const uint32_t corners[3 * kFaces] = {0, 1, 2, 0, 2, 3};
  const float captured[2][3 * kVertices] = {{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, {0, 0, 0, 1, 0, 0, 1, 1, 1, 0, 1, 0}};
  const chronormal_mesh mesh = {kVertices, kFaces, corners, NULL};
  const chronormal_vectors from = {captured[0], 0}, to = {captured[1], 0};
  float normals[3 * kVertices];
  chronormal_curves* curves = NULL;
  chronormal_status status = chronormal_curves_create(&mesh, from, to, NULL, &curves);
  for (int frame = 0; frame < kShown && status == CHRONORMAL_DONE; ++frame) {
    const double t = frame / (kShown - 1.0);
    for (size_t job = 0; job < kJobs && status == CHRONORMAL_DONE; ++job) { /* on any threads */
      chronormal_output output;
      chronormal_output_init(&output, normals);
      output.first = kVertices * job / kJobs;
      output.count = kVertices * (job + 1) / kJobs - output.first;
      status = chronormal_curves_write(curves, &t, &output, 1, NULL);
    }
    printf("t = %.1f: the normal of vertex 2 is (%.3f, %.3f, %.3f)\n", t, normals[6], normals[7], normals[8]);
  }
  if (status != CHRONORMAL_DONE) fprintf(stderr, "%s\n", chronormal_last_message());
  chronormal_curves_destroy(curves); /* or chronormal_curves_next(curves, to, following) */
  return status;
}
