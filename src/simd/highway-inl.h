/// The operations that kernels are written with: Google Highway, or, if the build does not use Highway
/// (CHRONORMAL_HIGHWAY=OFF, and the two files of tools/two_files.py), the part of Highway that the kernels use, in
/// plain C++. Both give the same bits.
#ifdef CHRONORMAL_HIGHWAY
// highway.h is included every time, since each inclusion is for a different instruction set.
#include <hwy/cache_control.h>
#include <hwy/highway.h>
#else
#include "simd/plain_lanes.h"
#endif
