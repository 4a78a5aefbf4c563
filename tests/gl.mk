# tests of gl
