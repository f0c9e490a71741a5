// Asks for what stands at an address before it is needed, where indices of indices lead: a processor foresees steps of
// equal length alone, and waits some hundred cycles for each. A device of many work-items has others to go on with.
#ifndef PVG_SHARED_LOOK_AHEAD_CL
#define PVG_SHARED_LOOK_AHEAD_CL

static inline void look_ahead(global const void* address) {
#ifdef __AVX__  // a CPU, as in shared/lanes.h
  __builtin_prefetch((const void*)(size_t)address);
#endif
}

#endif
