/* The smallest possible program in C: asks the shared library for its version. */
#include <chronormal_c.h>
#include <stdio.h>

int main(void) { return puts(chronormal_version()) < 0; }
