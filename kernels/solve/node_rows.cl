// Which rows of elements each node sums, as lists by node: offset, row, weight. A counting sort whose counts, as lists
// need a fixed order, come from a work-group that has 64 nodes of a world and goes through all rows of that world in their
// order. A row is one of an element's four sites, and belongs to the nodes that carry the site with a weight.
#include "shared/types.h"
#include "solve/site.h"
#define ITEMS 64u
#define SLOTS 4u  // nodes of a site, and sites of an element
#define NO_NODE 0xffffffffu
#define CHUNK_PER_GROUP __attribute__((reqd_work_group_size(ITEMS, 1, 1)))

// For 64 rows the nodes of each, as far as they are in the chunk.  nodes: [ITEMS x SLOTS];  is_used: whether any is
static inline void load_rows(const uint begin, const uint end, const Chunk chunk,
                             global const uint* restrict row_site, global const Site* restrict sites, local uint* nodes,
                             local uint* is_used) {
  const uint item = get_local_id(0), row = begin + item;
  for (uint k = 0; k < SLOTS; ++k) {
    uint node = NO_NODE;
    if (row < end) {
      global const Site* site = sites + row_site[row];
      node = site->weight[k] != 0 ? site->node[k] : NO_NODE;
    }
    const bool is_own = node >= chunk.begin && node < chunk.end;
    nodes[SLOTS * item + k] = is_own ? node : NO_NODE;
    if (is_own) *is_used = 1;
  }
}

// Elements of two kinds, sorted by world each.
// n_items: 64 for each chunk of at most 64 nodes, which follow each other
// n_first, n_second: elements of each kind;  first_of_first, first_of_second: [n_worlds + 1] of each world among them. Of
// the first kind there may be fewer; the last one's sites then stand in what is left, so that worlds ascend. What is more
// is left out.
// first_sites, second_sites: [n_first x 4], [n_second x 4]
// element_sites: [(n_first + n_second) x 4] written besides;  count: [n_nodes] entries of each node;  total: [n_chunks]
kernel CHUNK_PER_GROUP void node_rows_count(const uint n_items, global const Chunk* restrict chunks, const uint n_worlds,
                                            const uint n_first, const uint n_second, global const uint* restrict first_of_first,
                                            global const uint* restrict first_of_second,
                                            global const uint* restrict first_sites,
                                            global const uint* restrict second_sites,
                                            global const Site* restrict sites, global uint* restrict element_sites,
                                            global uint* restrict count, global uint* restrict total) {
  local uint nodes[ITEMS * SLOTS], of_item[ITEMS], is_used;
  const uint item = get_local_id(0), group = get_group_id(0);
  const Chunk chunk = chunks[group];
  const uint own = chunk.begin + item;
  const uint n_found = min(n_first, first_of_first[n_worlds]);
  for (uint i = get_global_id(0); i < SLOTS * (n_first + n_second); i += n_items)
    element_sites[i] = i >= SLOTS * n_first ? second_sites[i - SLOTS * n_first]
                       : n_found == 0       ? 0
                                            : first_sites[SLOTS * min(i / SLOTS, n_found - 1) + i % SLOTS];
  uint n = 0;
  for (uint kind = 0; kind < 2; ++kind) {
    global const uint* first = kind ? first_of_second : first_of_first;
    global const uint* row_site = kind ? second_sites : first_sites;
    const uint most = kind ? first[chunk.world + 1] : n_first, end = SLOTS * min(most, first[chunk.world + 1]);
    for (uint begin = SLOTS * first[chunk.world]; begin < end; begin += ITEMS) {
      if (item == 0) is_used = 0;
      barrier(CLK_LOCAL_MEM_FENCE);
      load_rows(begin, end, chunk, row_site, sites, nodes, &is_used);
      barrier(CLK_LOCAL_MEM_FENCE);
      for (uint k = 0; k < (is_used ? ITEMS * SLOTS : 0); ++k) n += nodes[k] == own;
      barrier(CLK_LOCAL_MEM_FENCE);
    }
  }
  if (own >= chunk.end) n = 0;
  of_item[item] = n;
  if (own < chunk.end) count[own] = n;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item > 0) return;
  for (uint k = 1; k < ITEMS; ++k) n += of_item[k];
  total[group] = n;
}

// first_row: of the first element's first site;  offset: [n_nodes + 1] into row and weight
kernel CHUNK_PER_GROUP void node_rows_fill(const uint n_items, const uint n_chunks, global const Chunk* restrict chunks,
                                           const uint n_first, global const uint* restrict first_of_first,
                                           global const uint* restrict first_of_second,
                                           global const uint* restrict first_sites,
                                           global const uint* restrict second_sites, global const Site* restrict sites,
                                           global const uint* restrict count, global const uint* restrict total,
                                           const uint first_row, global uint* restrict offset, global uint* restrict row,
                                           global double* restrict weight) {
  local uint nodes[ITEMS * SLOTS], before_chunk[ITEMS], of_item[ITEMS], is_used;
  const uint item = get_local_id(0), group = get_group_id(0);
  const Chunk chunk = chunks[group];
  const uint own = chunk.begin + item;
  uint sum = 0;
  for (uint c = item; c < group; c += ITEMS) sum += total[c];
  before_chunk[item] = sum;
  of_item[item] = own < chunk.end ? count[own] : 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  uint at = 0;
  for (uint k = 0; k < ITEMS; ++k) at += before_chunk[k];
  for (uint k = 0; k < item; ++k) at += of_item[k];
  if (own < chunk.end) offset[own] = at;
  if (group + 1 == n_chunks && item == ITEMS - 1) offset[chunk.end] = at + of_item[item];
  for (uint kind = 0; kind < 2; ++kind) {
    global const uint* first = kind ? first_of_second : first_of_first;
    global const uint* row_site = kind ? second_sites : first_sites;
    const uint most = kind ? first[chunk.world + 1] : n_first, end = SLOTS * min(most, first[chunk.world + 1]);
    for (uint begin = SLOTS * first[chunk.world]; begin < end; begin += ITEMS) {
      if (item == 0) is_used = 0;
      barrier(CLK_LOCAL_MEM_FENCE);
      load_rows(begin, end, chunk, row_site, sites, nodes, &is_used);
      barrier(CLK_LOCAL_MEM_FENCE);
      for (uint k = 0; k < (is_used ? ITEMS * SLOTS : 0); ++k)
        if (nodes[k] == own) {
          const uint r = begin + k / SLOTS;
          row[at] = first_row + (kind ? SLOTS * n_first : 0) + r;
          weight[at++] = sites[row_site[r]].weight[k % SLOTS];
        }
      barrier(CLK_LOCAL_MEM_FENCE);
    }
  }
}
