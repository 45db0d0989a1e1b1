#!/bin/sed -f
# Adapts a header for Doxygen: the comment at the top becomes the comment of the file, and "/// Errors     text" becomes
# an entry of a list.
1s,^///,/// \\file\n///,
s,^///\( *\)\([A-Z][A-Za-z ]*[a-z]\)  \+\([^ ]\),///\1- **\2** \3,
