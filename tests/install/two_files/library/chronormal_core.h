// Replaces the chronormal_core.h that tools/two_files.py writes. This file includes the library instead.
#include "chronormal/chronormal.h"
