/* Sliders of a rig in C: a base and two morph targets, and the normals at any weights. */
#include <chronormal_c.h>
#include <stdio.h>

enum { kVertices = 4, kFaces = 2, kTargets = 2 };

int main(void) {
  const uint32_t corners[3 * kFaces] = {0, 1, 2, 0, 2, 3}, lifted[1] = {2};
  const float base[3 * kVertices] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const float lift[3] = {0, 0, 1}, shear[3 * kVertices] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1};
  const chronormal_mesh mesh = {kVertices, kFaces, corners, NULL};
  const chronormal_vectors at_rest = {base, 0};
  const chronormal_target targets[kTargets] = {{1, lifted, {lift, 0}}, {kVertices, NULL, {shear, 0}}};
  const double sliders[3][kTargets] = {{0, 0}, {0.5, 0}, {0.5, 1}};
  float normals[3 * kVertices];
  chronormal_output output;
  chronormal_output_init(&output, normals);
  chronormal_blend* blend = NULL;
  chronormal_status status = chronormal_blend_create(&mesh, at_rest, targets, kTargets, NULL, &blend);
  for (int frame = 0; frame < 3 && status == CHRONORMAL_DONE; ++frame) {
    status = chronormal_blend_set_weights(blend, sliders[frame]);
    if (status == CHRONORMAL_DONE) status = chronormal_blend_write(blend, &output, NULL); /* ranges on any threads */
    printf("at %.1f, %.1f: the normal of vertex 2 is (%.3f, %.3f, %.3f)\n", sliders[frame][0], sliders[frame][1],
           normals[6], normals[7], normals[8]);
  }
  if (status != CHRONORMAL_DONE) fprintf(stderr, "%s\n", chronormal_last_message());
  chronormal_blend_destroy(blend);
  return status;
}
