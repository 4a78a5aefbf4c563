# What daemon/ adds to the build.
