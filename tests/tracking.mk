# tests of tracking
