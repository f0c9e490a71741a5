// What ends a trial: the energy of each world, as sum_worlds of solve/world_reduce.cl finds it, and the contacts of all
// pairs, in one launch, for neither waits for the other.
#include "contact/list_contacts.cl"
#include "solve/late_sum.cl"

// n: 64 for each world, then the pairs.  The first line's arguments are those of sum_worlds, whose late elements are the
// pairs; the others those of fill_contacts
kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void sum_and_list(
    const uint n, const uint n_worlds, const uint has_partial, global const uint* restrict chunk_first,
    global const Chunk* restrict chunks, global const real* restrict energy, global real* partial, const uint most,
    const uint from, global real* late_partial, global real* restrict world_energy,
    global const Barrier* restrict pairs, global const u32* restrict is_active, global const u32* restrict counts,
    global const u32* restrict first_pair, global u32* restrict first, global Barrier* restrict contacts,
    global u32* restrict sites, const uint search, global u32* restrict changed) {
  local u32 before[ITEMS], offset[ITEMS + 1];
  const uint group = get_group_id(0), item = get_local_id(0), n_pairs = n - n_worlds * ITEMS;
  const bool is_world = group < n_worlds;
  const uint own_group = is_world ? 0 : group - n_worlds, begin = own_group * ITEMS;
  const bool has_any = !is_world && has_contacts(begin, n_pairs, pairs, counts);
  if (is_world)
    start_late_sum(group, has_partial, chunk_first, chunks, energy, partial, 1, most, from, first_pair, late_partial);
  before[item] = has_any ? contacts_before(own_group, counts) : 0;
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  if (is_world && item == 0)
    world_energy[group] = late_sum(group, chunk_first, partial, 1, most, first_pair, late_partial);
  if (has_any) find_offsets(begin, n_pairs, is_active, before, offset);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (has_any) list_contacts(begin, n_pairs, n_worlds, pairs, first_pair, offset, first, contacts, sites, search, changed);
}
