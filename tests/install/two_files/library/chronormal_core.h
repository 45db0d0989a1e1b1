// Stands in for the chronormal_core.h of tools/two_files.py, with the library.
#include "chronormal/chronormal.h"
