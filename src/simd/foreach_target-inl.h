/// Includes the kernel that HWY_TARGET_INCLUDE names once for each instruction set, if Highway has several.
#ifdef CHRONORMAL_HIGHWAY
#include <hwy/foreach_target.h>
#endif
