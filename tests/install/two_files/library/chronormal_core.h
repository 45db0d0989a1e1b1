// Replaces the chronormal_core.h of tools/two_files.py, using the library.
#include "chronormal/chronormal.h"
