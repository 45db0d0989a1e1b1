/// The operations with which kernels are written. The operations are those of Google Highway or, if the build does not
/// use Highway, those of plain_lanes.h: the part of Highway that the kernels use, in plain C++. Both variants give the
/// same bits. Builds without Highway are those with CHRONORMAL_HIGHWAY=OFF, and the two files of tools/two_files.py.
#ifdef CHRONORMAL_HIGHWAY
// highway.h is included every time, since each inclusion is for a different instruction set.
#include <hwy/cache_control.h>
#include <hwy/highway.h>
#else
#include "simd/plain_lanes.h"
#endif
