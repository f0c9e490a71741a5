// The symmetric matrix of an element of n sites, as it is kept: the 3 x 3 blocks on and above its diagonal, row after row
// of blocks, the nine numbers of each row-major and side by side.
#ifndef PVG_ENERGIES_UPPER_BLOCKS_CL
#define PVG_ENERGIES_UPPER_BLOCKS_CL

// where block (i, j), i <= j, begins;  n_upper_numbers(n) of them are all
static inline int upper_block(const int n, const int i, const int j) { return 9 * (i * n - i * (i - 1) / 2 + j - i); }
static inline int n_upper_numbers(const int n) { return 9 * n * (n + 1) / 2; }

#endif
