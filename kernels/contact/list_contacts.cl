// From candidates to contacts: the active pairs, in order, and their sites. Each work-group has 64 pairs, begins behind the
// contacts of those before it, and does nothing where it has neither a contact nor the first pair of a world. In three
// parts, with a barrier after each of the first two.
#ifndef PVG_CONTACT_LIST_CONTACTS_CL
#define PVG_CONTACT_LIST_CONTACTS_CL
#include "energies/contact/barrier.h"
#include "shared/types.h"
#define ITEMS 64u

static inline bool begins_world(const uint begin, const uint n, global const Barrier* restrict pairs) {
  const uint end = min(n, begin + ITEMS);
  return begin == 0 || end == n || pairs[begin - 1].world != pairs[end - 1].world;
}

static inline bool has_contacts(const uint begin, const uint n, global const Barrier* restrict pairs,
                                global const u32* restrict counts) {
  return counts[begin / ITEMS] > 0 || begins_world(begin, n, pairs);
}

// a work-item's part of the contacts of groups before.  counts: of each 64 pairs, as pair_gaps leaves them
static inline u32 contacts_before(const uint group, global const u32* restrict counts) {
  u32 own = 0;
  for (uint c = get_local_id(0); c < group; c += ITEMS) own += counts[c];
  return own;
}

// offset: [ITEMS + 1] where the contact of each pair goes.  before: [ITEMS] of contacts_before
static inline void find_offsets(const uint begin, const uint n, global const u32* restrict is_active,
                                local const u32* before, local u32* offset) {
  if (get_local_id(0) > 0) return;
  const uint end = min(n, begin + ITEMS);
  u32 sum = 0;
  for (uint k = 0; k < ITEMS; ++k) sum += before[k];
  for (uint k = 0; k < ITEMS; ++k) {
    offset[k] = sum;
    sum += begin + k < end ? is_active[begin + k] : 0;
  }
  offset[ITEMS] = sum;
}

// first_pair, first: [n_worlds + 1] of the worlds' pairs and contacts;  sites: [n x 4] of contacts
// changed: [1] gets `search`, the number of this search, where sites differ from what stood there
static inline void list_contacts(const uint begin, const uint n, const uint n_worlds,
                                 global const Barrier* restrict pairs, global const u32* restrict first_pair,
                                 local const u32* offset, global u32* restrict first, global Barrier* restrict contacts,
                                 global u32* restrict sites, const uint search, global u32* restrict changed) {
  const uint item = get_local_id(0), end = min(n, begin + ITEMS);
  for (uint w = item; begins_world(begin, n, pairs) && w <= n_worlds; w += ITEMS)
    if (first_pair[w] >= begin && (first_pair[w] < end || end == n)) first[w] = offset[first_pair[w] - begin];
  const uint e = begin + item, to = offset[item];
  if (offset[item + 1] == to) return;
  contacts[to] = pairs[e];
  for (uint k = 0; k < 4; ++k)
    if (sites[4 * to + k] != pairs[e].site[k]) {
      sites[4 * to + k] = pairs[e].site[k];
      *changed = search;
    }
}

#endif
