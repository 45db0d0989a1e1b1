// A program that calls only the function of plugin.cpp. The program writes a file with three vertices, and the plugin
// counts them.
#include <cstdio>

extern "C" long vertices_of(const char* path);

int main() {
  const char* path = "engine.obj";
  std::FILE* file = std::fopen(path, "w");
  if (file == nullptr) return 1;
  std::fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", file);
  if (std::fclose(file) != 0) return 1;
  return vertices_of(path) == 3 && vertices_of("nothing.obj") == -1 ? 0 : 1;
}
