# tests of gi
