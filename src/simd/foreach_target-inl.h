/// Includes the file that HWY_TARGET_INCLUDE names once for each instruction set, if Highway has several. Each kernel
/// names itself and includes this file.
#ifdef CHRONORMAL_HIGHWAY
#include <hwy/foreach_target.h>
#endif
