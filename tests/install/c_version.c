/* The least that a program in C can do with the shared library: ask it for its version. */
#include <chronormal_c.h>
#include <stdio.h>

int main(void) { return puts(chronormal_version()) < 0; }
