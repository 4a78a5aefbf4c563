# What layouts/ adds to the build.
