// Stands in for the chronormal_core.h that tools/two_files.py writes: it includes the library instead.
#include "chronormal/chronormal.h"
