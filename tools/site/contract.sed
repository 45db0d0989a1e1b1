#!/bin/sed -f
# Doxygen's view of a header: the comment at its top belongs to the file, and "/// Errors     text" is an entry of a list.
1s,^///,/// \\file\n///,
s,^///\( *\)\([A-Z][A-Za-z ]*[a-z]\)  \+\([^ ]\),///\1- **\2** \3,
