# What scenes/ adds to the build.
