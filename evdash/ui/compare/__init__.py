"""The Compare page: runs pinned under a name, held against each other."""
