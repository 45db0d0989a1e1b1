/// The operations that kernels are written with: Google Highway, or, if the build does without it
/// (CHRONORMAL_HIGHWAY=OFF, and the two files of tools/two_files.py), the part of it that they use, in plain C++. Both
/// give the same bits.
#ifdef CHRONORMAL_HIGHWAY
// Include highway.h each time, since it is for a different instruction set each time.
#include <hwy/cache_control.h>
#include <hwy/highway.h>
#else
#include "simd/plain_lanes.h"
#endif
