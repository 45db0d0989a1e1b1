#!/bin/sed -f
# Gives Doxygen its view of a header: the comment at the top is that of the file, and "/// Errors     text" is an entry
# of a list.
1s,^///,/// \\file\n///,
s,^///\( *\)\([A-Z][A-Za-z ]*[a-z]\)  \+\([^ ]\),///\1- **\2** \3,
