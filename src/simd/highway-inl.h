/// What kernels are written with: Google Highway, or where the build does without it (CHRONORMAL_HIGHWAY=OFF, and the two
/// files of tools/two_files.py) the part of it that they use, in plain C++. Both give the same bits.
#ifdef CHRONORMAL_HIGHWAY
// Each time, since highway.h is one of another instruction set then.
#include <hwy/cache_control.h>
#include <hwy/highway.h>
#else
#include "simd/plain_lanes.h"
#endif
