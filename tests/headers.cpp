// Compiled once for its precompiled headers, which all tests share.
