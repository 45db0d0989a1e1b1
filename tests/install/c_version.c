/* Asks the shared library for its version, which is the smallest possible program in C. */
#include <chronormal_c.h>
#include <stdio.h>

int main(void) { return puts(chronormal_version()) < 0; }
