// A shared library that reads a file with chronormal, like a plugin of a game engine. The library exports one C
// function.
#include "chronormal/chronormal_io.h"

extern "C" __attribute__((visibility("default"))) long vertices_of(const char* path) {
  chronormal::InputOptions options;
  options.files = {path};
  options.allow_mesh = true;
  chronormal::Result<chronormal::Input> input = chronormal::open_input(options);
  if (!input) return -1;
  const chronormal::Result<const chronormal::Motion*> motion = input.value().motion();
  return motion ? static_cast<long>(motion.value()->topology.vertex_count()) : -1;
}
